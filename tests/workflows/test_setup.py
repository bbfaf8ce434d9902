"""Set-up clears no environment that is not this folder's own."""

import shutil
import subprocess

import pytest

from tests import REPOSITORY

SCRIPT = "workflows/environment/setup.sh"
LISTS = ("apt-packages.txt", "requirements.txt", "requirements-bootstrap.txt", "pyproject.toml")


@pytest.fixture
def folder(tmp_path):
    """A folder with the script and empty lists: nothing is to be installed but the environment itself."""
    there = tmp_path / "clone"
    (there / SCRIPT).parent.mkdir(parents=True)
    shutil.copy(REPOSITORY / SCRIPT, there / SCRIPT)
    for name in LISTS:
        (there / name).write_text("")
    return there


def set_up(folder):
    """What the script says of faults, and its exit status."""
    done = subprocess.run(["bash", SCRIPT], cwd=folder, capture_output=True, text=True)
    return done.returncode, [line for line in done.stderr.splitlines() if line.startswith("setup: ")]


def test_an_environment_that_is_a_link_is_not_cleared(folder, tmp_path):
    """It may be another folder's: set-up stops with one sentence, and what the link leads to stays."""
    other = tmp_path / "other"
    (other / "bin").mkdir(parents=True)
    (other / "precious").write_text("kept")
    (folder / ".venv").symlink_to(other)
    status, said = set_up(folder)
    assert status == 1 and len(said) == 1
    assert f".venv is a symbolic link to {other}, allowed is a folder of its own: rm .venv" in said[0]
    assert (other / "precious").read_text() == "kept" and (folder / ".venv").is_symlink()
