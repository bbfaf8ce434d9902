"""A cache for compiled functions that always works."""

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from bulkwear.compiled import CALLERS, SHARED, VARIABLE, choose_cache, forget_older
from tests import REPOSITORY

NOBODY = 65534


def test_numba_keeps_its_own_folders_where_they_can_be_written(tmp_path, monkeypatch):
    """Beside the modules, or in the user's cache; a folder that is named already stays."""
    monkeypatch.delenv(VARIABLE, raising=False)
    choose_cache(tmp_path)
    assert VARIABLE not in os.environ
    monkeypatch.setenv(VARIABLE, "/named")
    choose_cache(Path("/proc"))
    assert os.environ[VARIABLE] == "/named"


def test_without_any_there_is_one_of_this_user_alone(tmp_path, monkeypatch):
    """What is in it is run, so nobody else may write to it."""
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr("bulkwear.compiled._writable", lambda folder: False)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    choose_cache(Path("/proc"))
    folder = Path(os.environ.pop(VARIABLE))
    assert folder.parent == tmp_path and stat.S_IMODE(folder.stat().st_mode) == 0o700
    folder.chmod(0o777)  # as somebody else may have made it
    choose_cache(Path("/proc"))
    assert Path(os.environ.pop(VARIABLE)) != folder


def test_compiled_code_older_than_the_arithmetic_it_copied_is_forgotten(tmp_path):
    """An index that is older goes, a newer one and that of another module stay; every caller is known."""
    (tmp_path / SHARED).write_text("")
    os.utime(tmp_path / SHARED, (1000.0, 1000.0))
    made = {"mesh_cuts.cut-12.py311.nbi": 999.0, "mesh_cuts.side-30.py311.nbi": 1001.0, "other.cut-1.py311.nbi": 999.0}
    (tmp_path / "__pycache__").mkdir()
    for name, when in made.items():
        (tmp_path / "__pycache__" / name).write_bytes(b"")
        os.utime(tmp_path / "__pycache__" / name, (when, when))
    forget_older(tmp_path)
    assert sorted(path.name for path in (tmp_path / "__pycache__").iterdir()) == sorted(made)[1:]
    package = REPOSITORY / "postproc"
    asks = f"from bulkwear.postproc.{Path(SHARED).stem} import"
    callers = {
        path.relative_to(package).as_posix() for path in package.rglob("*.py") if asks in path.read_text("utf-8")
    }
    assert callers == set(CALLERS)


@pytest.mark.skipif(os.getuid() != 0, reason="only root can become another user")
def test_a_user_without_a_home_compiles_from_an_installation_that_is_read_only():
    """The package as root installed it, and a home that is none."""
    program, *folders = (Path(sys.executable).resolve(), *Path(sys.executable).resolve().parents, *REPOSITORY.parents)
    if not all(folder.stat().st_mode & stat.S_IXOTH for folder in (program, REPOSITORY, *folders)):
        pytest.skip("another user cannot enter this clone, or run its Python")
    code = "from bulkwear.postproc.mesh_checks import njit; from bulkwear.postproc.readers import dump_text"
    found = subprocess.run(
        [sys.executable, "-c", code],
        user=NOBODY,
        group=NOBODY,
        extra_groups=[],
        cwd="/",
        env={"HOME": "/nonexistent", "PATH": os.environ["PATH"], "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
    )
    assert found.returncode == 0, found.stderr
