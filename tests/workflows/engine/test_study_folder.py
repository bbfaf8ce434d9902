"""The folder of a study: one Snakemake at a time, told where it cannot be written, nothing of the future in it."""

import errno
import fcntl
import os
import time

import pytest

from bulkwear.workflows.engine.state import only_driver
from bulkwear.workflows.engine.study_folder import AHEAD_S, StudyFolderError, date_back, take

DAY = 86400.0  # s


def test_a_second_snakemake_is_refused_until_the_first_ends(tmp_path):
    """The sentence names the folder and the process that is at work."""
    folder = tmp_path / "results" / "demo"
    first = take(folder)
    with pytest.raises(StudyFolderError, match=rf"demo: another Snakemake \(process {os.getpid()}\) is at work"):
        take(folder)
    first.close()
    take(folder).close()


@pytest.mark.parametrize("code", [errno.ENOSYS, errno.ENOLCK])
def test_a_file_system_without_locks_is_told_as_such(tmp_path, monkeypatch, code):
    """Of a study and of a simulation: no other process is blamed, and nothing waits for ever."""

    def flock(file, operation):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(fcntl, "flock", flock)
    words = (
        r"results: its file system cannot lock files .*; allowed is one that can, Lustre with the mount option flock"
    )
    with pytest.raises(StudyFolderError, match=words):
        take(tmp_path / "results")
    with pytest.raises(OSError, match=words), only_driver(tmp_path / "results", pytest.fail):
        pass


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    """Here something else stands in its place; a disk without write says so with its own words."""
    (tmp_path / "demo").write_text("a file")
    with pytest.raises(StudyFolderError, match="demo: File exists; a study needs a folder that it can write to"):
        take(tmp_path / "demo")


def test_files_of_the_future_are_dated_now(tmp_path):
    """And no other file."""
    (tmp_path / "R9").mkdir()
    now = time.time()
    ages = {"old": -DAY, "server": 0.5 * AHEAD_S, "ahead": DAY, "R9/far": 3650 * DAY}
    for name, age in ages.items():
        (tmp_path / name).write_text(name)
        os.utime(tmp_path / name, (now + age, now + age))
    assert date_back(tmp_path) == 2
    dated = {name: (tmp_path / name).stat().st_mtime - now for name in ages}
    assert dated["old"] == pytest.approx(-DAY, abs=1.0)
    assert dated["server"] == pytest.approx(0.5 * AHEAD_S, abs=1e-3)
    assert 0.0 <= dated["ahead"] < DAY / 2 and 0.0 <= dated["R9/far"] < DAY / 2
    assert date_back(tmp_path) == 0
