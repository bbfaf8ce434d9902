"""The worked changes of docs/extend.md: each patch fits, touches as few files as told, and its tests pass in a copy."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests import REPOSITORY
from tests.support.compiled import take_compiled
from tests.test_house import name_of, tracked

PATCHES = sorted((REPOSITORY / "docs" / "extend").glob("*.patch"))
MOST_FILES = {"wear_law": 5, "figure": 2, "pattern": 4, "solver_option": 4}  # of the product, tests not counted
GENERATED = "config/README.md"  # by a command, from what the other files say: in a patch it would seldom fit
COMPILED = ("bulkwear", "workflows", "meshes", "postproc", "tests")  # folders of modules
PROGRAM = "solver/build/liggghts-ledger"


def files_of(patch: Path) -> list[str]:
    """Paths that a patch changes or makes."""
    return re.findall(r"^\+\+\+ b/(.+)$", patch.read_text(encoding="utf-8"), re.MULTILINE)


def copy_of_the_repository(folder: Path) -> Path:
    """Copy all files that git knows, and the solver's program as it is built."""
    for path in tracked():
        target = folder / name_of(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(path, target)
    shutil.copytree(REPOSITORY / "solver" / "build", folder / "solver" / "build")
    for name in COMPILED:
        take_compiled(folder / name, REPOSITORY / name)
    return folder


def test_every_change_has_its_patch_and_is_told():
    """The patches are those whose number of files is bounded; the page names each."""
    page = (REPOSITORY / "docs" / "extend.md").read_text(encoding="utf-8")
    assert {patch.stem for patch in PATCHES} == set(MOST_FILES)
    assert [patch.name for patch in PATCHES if f"extend/{patch.name}" not in page] == []


@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.stem)
def test_a_change_touches_few_files(patch):
    """Files of the product are no more than its bound, the page that is generated is none; there is a test."""
    changed = files_of(patch)
    product = [name for name in changed if not name.startswith("tests/")]
    assert len(product) <= MOST_FILES[patch.stem], product
    assert len(changed) > len(product) and GENERATED not in changed


@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.stem)
def test_a_change_fits(patch, tmp_path):
    """Its places are there, so that it can be applied."""
    for name in files_of(patch):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        if (there := REPOSITORY / name).exists():
            shutil.copy2(there, tmp_path / name)
    done = subprocess.run(["git", "apply", "--check", str(patch)], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.verify
@pytest.mark.solver
@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.stem)
def test_a_change_works_in_a_copy(patch, tmp_path):
    """Applied to a copy, with the solver's program built again where it is concerned, its own tests pass."""
    copy = copy_of_the_repository(tmp_path)
    subprocess.run(["git", "init", "--quiet"], cwd=copy, check=True)
    subprocess.run(["git", "apply", str(patch)], cwd=copy, check=True)
    if any(name.startswith("solver/") for name in files_of(patch)):
        subprocess.run(["make", "-s", "-C", "solver"], cwd=copy, check=True, capture_output=True)
        assert (copy / PROGRAM).stat().st_mtime > (REPOSITORY / PROGRAM).stat().st_mtime
    generate = [sys.executable, "-m", "bulkwear.workflows.config.readme"]
    subprocess.run(generate, cwd=copy, check=True, capture_output=True)
    tests = [name for name in files_of(patch) if name.startswith("tests/") and Path(name).name.startswith("test_")]
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *tests]
    done = subprocess.run(command, cwd=copy, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-4000:]
    assert re.search(r"\d+ passed", done.stdout)
