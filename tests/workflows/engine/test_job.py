"""How a job ends: in one sentence, whatever struck it."""

import errno
import os
import subprocess
import sys

import pyarrow
import pytest

from bulkwear.workflows.engine.job import (
    INTERRUPTED,
    STOPPED,
    let_jobs_import,
    processor_seconds_of,
    project_job,
)
from tests import REPOSITORY

FAULTS = {
    "memory": (MemoryError(), 1, "The memory is exhausted"),
    "memory of a thread": (RuntimeError("Resource temporarily unavailable"), 1, "The memory is exhausted"),
    "memory of a fork": (OSError(errno.ENOMEM, "Cannot allocate memory"), 1, "The memory is exhausted"),
    "memory of tables": (pyarrow.lib.ArrowMemoryError("malloc of size 64 failed"), 1, "The memory is exhausted"),
    "a full disk": (OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "ledger.parquet"), 1, "the disk is full"),
    "a quota": (OSError(errno.EDQUOT, os.strerror(errno.EDQUOT)), 1, "a quota is used up"),
    "a sentence of ours": (ValueError("a.stl: it is empty."), 1, "a.stl: it is empty."),
}


@pytest.mark.parametrize("what", FAULTS)
def test_a_job_ends_in_one_sentence(tmp_path, monkeypatch, capsys, what):
    """No traceback on the screen."""
    fault, code, said = FAULTS[what]
    monkeypatch.chdir(REPOSITORY)
    with pytest.raises(SystemExit) as end, project_job(tmp_path / "job.log"):
        raise fault
    lines = capsys.readouterr().err.strip().splitlines()
    assert end.value.code == code
    assert len(lines) == 1 and said in lines[0]


def test_ctrl_c_stands_in_the_log_alone(tmp_path, monkeypatch, capsys):
    """On the terminal it is said once for all jobs."""
    monkeypatch.chdir(REPOSITORY)
    with pytest.raises(SystemExit) as end, project_job(tmp_path / "job.log"):
        raise KeyboardInterrupt
    assert end.value.code == INTERRUPTED and capsys.readouterr().err == ""
    assert STOPPED in (tmp_path / "job.log").read_text()


@pytest.mark.parametrize(("fault", "shown"), [("KeyboardInterrupt", False), ("KeyError", True)])
def test_ctrl_c_before_a_job_has_begun_is_silent(monkeypatch, fault, shown):
    """While it imports: nothing on the screen, and no exit code of a job that is done."""
    monkeypatch.setenv("PYTHONPATH", "")
    let_jobs_import()
    ended = subprocess.run([sys.executable, "-c", f"raise {fault}"], capture_output=True, text=True, check=False)
    assert ended.returncode != 0 and bool(ended.stderr) == shown


def test_a_fault_of_the_program_shows_where_it_is(tmp_path, monkeypatch):
    """What is no fault of the user's or the machine's keeps its traceback."""
    monkeypatch.chdir(REPOSITORY)
    with pytest.raises(KeyError), project_job(tmp_path / "job.log"):
        raise KeyError("worn_um")
    assert "Traceback" in (tmp_path / "job.log").read_text()


JOB = """
import subprocess, sys, time
from bulkwear.workflows.engine.job import project_job

BURN = "import time; all(iter(lambda: time.process_time() < {}, False))"
with project_job(sys.argv[1]):
    subprocess.run([sys.executable, "-c", BURN.format(0.5)], check=True)
    begin = time.process_time()
    while time.process_time() < begin + 0.2: pass
    if len(sys.argv) > 2: raise ValueError("it went wrong")
"""


def test_a_job_that_went_well_tells_its_processor_time(tmp_path):
    """Its own, imports included, and that of programs it ran; starts add up, one that failed tells nothing."""
    log = tmp_path / "job.log"
    words = [sys.executable, "-c", JOB, str(log)]
    subprocess.run(words, cwd=REPOSITORY, check=True)
    own, programs = processor_seconds_of(log)
    assert own >= 0.2 and programs >= 0.5
    subprocess.run(words, cwd=REPOSITORY, check=True)
    more_own, more_programs = processor_seconds_of(log)
    assert more_own >= own + 0.2 and more_programs >= programs + 0.5
    failed = tmp_path / "failed.log"
    subprocess.run([*words[:-1], str(failed), "fails"], cwd=REPOSITORY, check=False)
    assert "it went wrong" in failed.read_text() and processor_seconds_of(failed) is None
