"""What the solver's load ledger refuses: every case stops, with one sentence that says what is wrong."""

import re
import shutil
import subprocess

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import write_stl
from bulkwear.workflows.engine.solver import solver_environment
from tests.support.patience import LONGEST_S
from tests.verification.ledger_cases import (
    LEDGER_LINE,
    MESH_LINE,
    PIN_MOTION,
    REPOSITORY,
    SOLVER,
    build,
    command,
    pin,
    run,
    said_when_refused,
    write_case,
)

pytestmark = pytest.mark.solver


def test_the_plain_solver_does_not_know_the_ledger(tmp_path):
    """LIGGGHTS itself stops at the line, so no run goes on without a ledger that the deck asks for."""
    assert "Invalid fix style" in said_when_refused(tmp_path, solver=shutil.which("liggghts"))


@pytest.mark.parametrize("solver", ["liggghts", str(SOLVER)])
def test_the_installed_liggghts_has_no_superquadrics(tmp_path, solver):
    """It is compiled without them, so that grains are spheres or clumps (docs/grain_shape.md)."""
    (tmp_path / "deck.in").write_text("atom_style superquadric\n")
    words = command(solver=solver)
    done = subprocess.run(words, cwd=tmp_path, env=solver_environment(), capture_output=True, timeout=LONGEST_S)
    assert done.returncode != 0 and b"Invalid atom style" in done.stdout + done.stderr


@pytest.mark.parametrize(
    ("ledger", "sentence"),
    [
        (LEDGER_LINE.replace("mesh sample", "mesh other"), r"found no mesh/surface fix with the id 'other'"),
        (LEDGER_LINE.replace("mesh sample", "mesh wall"), r"found no mesh/surface fix with the id 'wall'"),
        (LEDGER_LINE + " oka", r"found kernel 'oka', allowed are .*finnie_work"),
        ("fix load_ledger all load/ledger mesh sample", r"it needs mesh MESH_ID and file FILE"),
        ("fix load_ledger all load/ledger file load_ledger.bin", r"it needs mesh MESH_ID and file FILE"),
        (
            LEDGER_LINE.replace("file ", "path "),
            r"found 'path', allowed are mesh MESH_ID, file FILE, history STEPS and",
        ),
        (
            LEDGER_LINE.replace(" kernels", " history 0 kernels"),
            r"found history '0', allowed is a whole number of steps",
        ),
        (LEDGER_LINE.replace(" kernels", " history 2e3 kernels"), r"found history '2e3', allowed is a whole number"),
    ],
)
def test_a_wrong_word_in_the_deck(tmp_path, ledger, sentence):
    """Unknown mesh, a fix that is no mesh, unknown kernel, missing and unknown keywords: each is named."""
    assert re.search(sentence, said_when_refused(tmp_path, ledger=ledger))


def test_a_mesh_that_no_wall_uses(tmp_path):
    """A mesh without wall/gran can touch nothing: its ledger would stay empty without anyone noticing."""
    said = said_when_refused(tmp_path, without=("fix wall ", "compute wall_contact "))
    assert re.search(r"no wall/gran fix before it uses the mesh 'sample'", said)


def test_two_ledgers_in_one_file(tmp_path):
    """Two ledgers that write the same file would overwrite one another: the second is refused."""
    ledger = f"{LEDGER_LINE}\n{LEDGER_LINE.replace('fix load_ledger', 'fix second')}"
    assert "writes to load_ledger.bin as well" in said_when_refused(tmp_path, ledger=ledger)


def test_a_mesh_defined_again_under_its_ledger(tmp_path):
    """Sums of two surfaces never mix: a mesh that is replaced while its ledger lives stops the next run."""
    again = [
        "run 10",
        "uncompute wall_contact",
        "unfix wall",
        "unfix sample",
        MESH_LINE,
        "fix wall all wall/gran model hertz tangential history mesh n_meshes 1 meshes sample store_force yes",
    ]
    write_case(tmp_path, flat_plate(0.004, 0.004, 1e-3), pin(1.3e-4, 0.7e-4), PIN_MOTION, outputs=again, steps=50)
    with pytest.raises(RuntimeError, match="the mesh 'sample' was defined again"):
        run(tmp_path)


def test_a_contact_with_another_mesh_proves_nothing(tmp_path):
    """Each ledger vouches for its own mesh: one that nothing touches says so, however busy its neighbour is."""
    far = flat_plate(0.004, 0.004, 1e-3)
    write_stl(tmp_path / "far.stl", far.points + np.array([0.0, 0.0, 0.015]), far.triangles)
    mesh_lines = [MESH_LINE.replace("fix sample", "fix far").replace("sample.stl", "far.stl")]
    outputs = ["fix far_ledger all load/ledger mesh far file far.bin"]
    settings = {"meshes": "2 meshes sample far", "steps": 50}
    plate = flat_plate(0.004, 0.004, 1e-3)
    write_case(tmp_path, plate, pin(1.3e-4, 0.7e-4), PIN_MOTION, mesh_lines=mesh_lines, outputs=outputs, **settings)
    said = run(tmp_path)
    assert re.search(r"Load ledger far_ledger: .* no contact yet", said)
    assert re.search(r"Load ledger load_ledger: .* every contact is reported to it", said)


def test_a_file_that_cannot_be_written(tmp_path):
    """A ledger that cannot be written stops the run, naming the file."""
    ledger = LEDGER_LINE.replace("load_ledger.bin", "missing/load_ledger.bin")
    assert "cannot write missing/load_ledger.bin" in said_when_refused(tmp_path, ledger=ledger)


@pytest.mark.verify
def test_built_for_another_version(tmp_path):
    """An executable built for another version of LIGGGHTS than the library that it finds stops and names both."""
    solver = build(tmp_path, LIGGGHTS_VERSION="9.9")
    said = said_when_refused(tmp_path / "run", solver=solver)
    assert re.search(r"was built for (LIGGGHTS )?9\.9 and runs with 'Version LIGGGHTS-PUBLIC 3\.8\.0", said)


@pytest.mark.verify
def test_a_solver_that_does_not_report_its_contacts(tmp_path):
    """An executable without the override that the library calls stops instead of counting nothing."""
    text = (REPOSITORY / "solver" / "contact_hook.cpp").read_text()
    override = text[text.index("void FixMeshSurface::add_particle_contribution(") :]
    override = override[: override.index("\n}\n") + 3]
    solver = build(tmp_path, edit=("contact_hook.cpp", override, ""))
    said = said_when_refused(tmp_path / "run", solver=solver)
    assert re.search(r"the solver sees contacts|uses its own FixMeshSurface::add_particle_contribution", said)
