"""The wheel in a bare environment: the public names, the notebook of the docs, the workflow's own files."""

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import bulkwear
from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import areas, write_surface
from tests import REPOSITORY
from tests.support.compiled import share_compiled
from tests.test_house import name_of, tracked

UV = Path(sys.executable).with_name("uv")
SHIPPED = ("bulkwear", "postproc", "meshes", "workflows", "templates", "config", "solver")
WORK = 5.0e3  # J/m2, over the plate; a thousand times what the demo does in a cycle
NAMES = "import bulkwear; print(*(getattr(bulkwear, name).__class__.__name__ for name in bulkwear.__all__))"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel as its build backend makes it."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", str(folder)]
    subprocess.run(command, cwd=REPOSITORY, check=True, capture_output=True)
    (path,) = folder.glob("bulkwear-*.whl")
    return path


@pytest.fixture(scope="module")
def python(wheel, tmp_path_factory):
    """An environment with the wheel and what it asks for, nothing else."""
    folder = tmp_path_factory.mktemp("bare") / "venv"
    environment = {**os.environ, **package_index()}
    subprocess.run([UV, "venv", "--quiet", "--python", sys.executable, folder], check=True, env=environment)
    python = folder / "bin" / "python"
    install = [UV, "pip", "install", "--quiet", "--python", python, wheel, "--constraint", "requirements.txt"]
    subprocess.run(install, cwd=REPOSITORY, check=True, env=environment)
    (package,) = folder.glob("lib/*/site-packages/bulkwear")
    for name in ("bulkwear", "postproc", "meshes"):
        share_compiled(package / name.removeprefix("bulkwear"), REPOSITORY / name)
    return python


def package_index() -> dict[str, str]:
    """The machine's own package index, which uv does not look up where pip has it (as in setup.sh)."""
    ask = [Path(sys.executable).with_name("pip"), "config", "get", "global.index-url"]
    told = subprocess.run(ask, capture_output=True, text=True).stdout.strip() if ask[0].exists() else ""
    found = os.environ.get("UV_DEFAULT_INDEX") or os.environ.get("PIP_INDEX_URL") or told
    return {"UV_SYSTEM_CERTS": "1"} | ({"UV_DEFAULT_INDEX": found} if found else {})


def run(python: Path, code: str, folder: Path) -> str:
    """What a program prints that runs in the bare environment, far from the repository."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run([python, "-c", code], cwd=folder, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_wheel_holds_the_whole_package(wheel):
    """Every tracked file of its folders, at its place in the package, and no other; no file beside the package."""
    with zipfile.ZipFile(wheel) as opened:
        names = {name for name in opened.namelist() if ".dist-info/" not in name}
    wanted = {name_of(path) for path in tracked() if name_of(path).split("/")[0] in SHIPPED}
    placed = {name if name.startswith("bulkwear/") else f"bulkwear/{name}" for name in wanted}
    profiles = {f"bulkwear/profiles/{name}/config.yaml" for name in ("default", "slurm")}
    told = {f"bulkwear/docs/{name}.md" for name in ("project", "tutorial_chute", "equipment")}
    assert names == placed | profiles | told | {"bulkwear/Snakefile"}


def test_eleven_names_are_public(python, tmp_path):
    """All of them can be had, from the installed package; another name is an error that lists them."""
    assert len(bulkwear.__all__) == 11
    assert len(run(python, NAMES, tmp_path).split()) == 11
    where = run(python, "import bulkwear.postproc.wear.laws as laws; print(laws.__file__)", tmp_path)
    assert "site-packages/bulkwear/postproc" in where
    with pytest.raises(AttributeError, match="bulkwear has no 'read_legder', its public names are SurfaceMesh, "):
        bulkwear.read_legder  # noqa: B018


def test_an_editable_install_is_the_repository(tmp_path):
    """What it puts on the path is the folder from which `bulkwear.postproc` is `postproc` here."""
    build = f"from hatchling.build import build_editable; print(build_editable({str(tmp_path)!r}))"
    done = subprocess.run([sys.executable, "-c", build], cwd=REPOSITORY, capture_output=True, text=True, check=True)
    with zipfile.ZipFile(tmp_path / done.stdout.split()[-1]) as opened:
        (name,) = (name for name in opened.namelist() if name.endswith(".pth"))
        path = opened.read(name).decode().strip()
    said = subprocess.run(
        [sys.executable, "-c", "import bulkwear.postproc as library; print(library.__file__)"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=True,
    )
    assert said.stdout.strip() == str(REPOSITORY / "postproc/__init__.py")


def test_importing_costs_nothing(python, tmp_path):
    """Nothing that is slow to import comes with it."""
    said = run(python, "import sys, bulkwear; print('numpy' in sys.modules, 'pandas' in sys.modules)", tmp_path)
    assert said.split() == ["False", "False"]


@pytest.mark.verify
def test_the_notebook_of_the_docs_runs(python, tmp_path):
    """A ledger read, a surface worn and drawn; on a uniformly loaded plate the depth is the law's."""
    run_folder = tmp_path / "results/demo/R5_convex"
    cycle = run_folder / "cycle_001"
    cycle.mkdir(parents=True)
    plate = flat_plate(0.02, 0.02, 0.001)
    write_surface(run_folder / "surface.vtu", plate)
    work = WORK * areas(plate.points, plate.triangles)
    pd.DataFrame({"triangle": np.arange(len(work)), "sliding_work_J": work}).to_parquet(cycle / "ledger.parquet")
    page = (REPOSITORY / "docs" / "notebook.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    coefficient, repeated = (
        float(found) for found in re.search(r"_per_pa\": (\S+)}.*?, (\S+) \*", code, re.S).groups()
    )
    said = re.fullmatch(r"(\S+) mm³, at most (\S+) µm deep\n", run(python, code, tmp_path))
    depth = coefficient * repeated * WORK
    assert float(said[2]) == pytest.approx(1e6 * depth, rel=5e-3)  # three digits are printed
    assert float(said[1]) == pytest.approx(1e9 * depth * 0.02**2, rel=5e-3)
    assert (tmp_path / "worn.png").stat().st_size > 10_000


def test_a_ledger_that_is_not_there_is_one_sentence(tmp_path):
    """It names the file and what is in its folder."""
    (tmp_path / "wear.csv").touch()
    with pytest.raises(
        ValueError, match=r"ledger\.parquet: no ledger can be read .* found in that folder: wear\.csv\."
    ):
        bulkwear.read_ledger(tmp_path)
