"""The search for contacts with meshes: ours finds what the solver's library finds, to the last bit."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from bulkwear.meshes.plate import closed_box, flat_plate
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.workflows.engine.own_machine import write_update
from bulkwear.workflows.engine.solver import solver_environment
from tests import REPOSITORY
from tests.verification.ledger_cases import PIN_MOTION, SOLVER, build, command, pin, write_case
from tests.verification.machines.four import MACHINES
from tests.verification.test_solver_ledger_beds import BOX, LOOSE, POURED

pytestmark = pytest.mark.solver

SEARCHES = ("ours", "stock")
PLATE = flat_plate(0.026, 0.026, 1e-3)
STEPS, DRAGGED = 1000, 0.05  # -, m/s
FALLEN = {**BOX, "domain": "-0.04 0.04 -0.03 0.03 -0.02 0.03", "settling": 2500, "steps": STEPS}
SOON, BRIEF = 700, 300  # steps, until particles lie on the mesh, and with them
SWING = "fix swing all move/mesh mesh sample wiggle amplitude 0.001 0.0005 0.0005 period 0.007"
TURN = "fix turn all move/mesh mesh sample rotate origin 0. 0. 0. axis 0. 0.2 1. period 0.5"
DRAG = f"fix drag all move/mesh mesh sample linear -{DRAGGED} 0. 0."
STATE = [
    "dump state all custom 500 *.state id x y z vx vy vz omegax omegay omegaz fx fy fz",
    'dump_modify state sort id format "%d' + 12 * " %.17g" + '"',
]
# Contacts at a distance: liquid bridges reach 1.1 times as far as the surfaces.
DRY, WET = "model hertz tangential history", "model hertz tangential history cohesion washino/capillary/viscous"
LIQUID = """
fix liquid all property/global surfaceLiquidContentInitial scalar 0.01
fix tension all property/global surfaceTension scalar 0.07
fix viscosity all property/global fluidViscosity scalar 0.001
fix least_separation all property/global minSeparationDistanceRatio scalar 1.01
fix most_separation all property/global maxSeparationDistanceRatio scalar 1.1
fix angle all property/global contactAngle peratomtype 40 40
"""
RESTARTED = ["restart 500 a.restart b.restart"]
RESUMED = FALLEN["settling"] + 2 * STEPS  # steps
SEARCH_SOURCE = "search/wall_search.cpp"


def searched(folder: Path, search: str, ranks: int = 1, **variables) -> str:
    """Run the deck of a folder by a search; what it said."""
    words = [*command(ranks, **variables), "-search", search]
    done = subprocess.run(words, cwd=folder, env=solver_environment(ranks), capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    assert f"Wall search of wall: {search}, " in done.stdout
    return done.stdout


def written(folder: Path, *patterns: str) -> dict[str, bytes]:
    """{name: content} of what a run wrote."""
    found = sorted(path for pattern in patterns for path in folder.glob(pattern))
    return {path.name: path.read_bytes() for path in found}


def wavy(mesh: SurfaceMesh) -> SurfaceMesh:
    """The plate in waves, its facets' longest edges anywhere: edges in and out, obtuse corners."""
    points = mesh.points.copy()
    points[:, 2] += 4e-4 * np.sin(points[:, 0] / 1.1e-3) * np.cos(points[:, 1] / 0.7e-3)
    points[:, 0] += 3e-4 * np.sin(points[:, 1] / 0.5e-3)
    return SurfaceMesh(points, mesh.triangles)


@pytest.mark.parametrize(
    ("mesh", "lines", "ranks"),
    [
        (PLATE, (), 1),
        (wavy(PLATE), (SWING,), 1),
        pytest.param(wavy(PLATE), (DRAG,), 1, marks=pytest.mark.verify),
        pytest.param(closed_box(0.02, 0.02, 0.004, 1.5e-3), (TURN,), 1, marks=pytest.mark.verify),
        pytest.param(wavy(PLATE), (SWING,), 2, marks=pytest.mark.verify),
        pytest.param(wavy(PLATE), (TURN,), 2, marks=pytest.mark.verify),
        pytest.param(wavy(PLATE), (TURN,), 4, marks=pytest.mark.verify),
    ],
)
def test_same_to_the_last_bit(tmp_path, mesh, lines, ranks):
    """Ledger, motion of every particle and its force, of a bed that falls on a mesh and is moved by it."""
    found, work = by_both(tmp_path, mesh, lines, ranks, FALLEN)
    assert len(found["ours"]) > STEPS // 500
    assert found["ours"] == found["stock"]
    assert work > 0.0


@pytest.mark.verify
def test_same_to_the_last_bit_on_two_ranks(tmp_path):
    """The same of a bed that is poured just above the mesh, over fewer steps: where cores are few, ranks wait."""
    found, work = by_both(tmp_path, wavy(PLATE), (TURN,), 2, {**FALLEN, "settling": SOON, "steps": BRIEF})
    assert found["ours"] == found["stock"]
    assert work > 0.0


def by_both(
    folder: Path, mesh: SurfaceMesh, lines: tuple[str, ...], ranks: int, deck: dict
) -> tuple[dict[str, dict[str, bytes]], float]:
    """What a bed on a mesh leaves by either search, {search: {file: content}}, and its sliding work (J) by ours."""
    found = {}
    for search in SEARCHES:
        write_case(folder / search, mesh, POURED, LOOSE, mesh_lines=lines, outputs=STATE, **deck)
        searched(folder / search, search, ranks)
        found[search] = written(folder / search, "load_ledger.bin", "*.state")
    ledger = read_load_ledger(folder / "ours" / "load_ledger.bin", "sample", len(mesh.triangles))
    return found, float(ledger.columns["sliding_work_J"].sum())


@pytest.mark.verify
def test_same_with_liquid_bridges(tmp_path):
    """The same where particles are held by a mesh that they do not touch."""
    found = {}
    for search in SEARCHES:
        folder = tmp_path / search
        write_case(folder, wavy(PLATE), POURED, LOOSE, mesh_lines=(SWING,), outputs=STATE, **FALLEN)
        for deck in (folder / "ledger_case.in", folder / "motion.in"):
            deck.write_text(deck.read_text().replace(DRY, WET).replace("pair_style", f"{LIQUID}pair_style"))
        searched(folder, search)
        found[search] = written(folder, "load_ledger.bin", "*.state")
    assert found["ours"] == found["stock"]


def test_same_after_a_restart(tmp_path):
    """A run that goes on from a restart file, by either search from either's file."""
    found = {}
    for search in SEARCHES:
        folder = tmp_path / search
        write_case(folder, wavy(PLATE), POURED, LOOSE, outputs=RESTARTED, **FALLEN)
        searched(folder, search)
        max(folder.glob("?.restart"), key=lambda path: path.stat().st_mtime).rename(folder / "half.restart")
        for by in SEARCHES:
            searched(folder, by, resumed=1, restart_file="half.restart", particles="nothing", settling=0, steps=RESUMED)
            found[search, by] = (folder / "load_ledger.bin").read_bytes()
    assert len(set(found.values())) == 1


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.verify) for name in MACHINES])
def test_same_on_machines(tmp_path, name):
    """Chute with obtuse facets, case with shelves, moving bucket and conveyor, over their first cycles."""
    machine = MACHINES[name]()
    found = {}
    for search in SEARCHES:
        folder = tmp_path / search
        write_update(folder, machine.deck, machine.parts, 0, 0.0, 3 * machine.cycle_steps)
        searched_machine(folder, search, machine.time_step_s)
        found[search] = written(folder, *(f"{part.name}.bin" for part in machine.parts))
    assert len(found["ours"]) == len(machine.parts)
    assert found["ours"] == found["stock"]


def searched_machine(folder: Path, search: str, time_step: float) -> None:
    """Run the first update of a machine by a search."""
    variables = {"update": 0, "before": "none", "time_step": time_step}
    done = subprocess.run(
        [*command(**variables), "-search", search], cwd=folder, env=solver_environment(), capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]


def alone(folder: Path, solver: Path) -> subprocess.CompletedProcess[str]:
    """Run a pin that falls on a plate, without a ledger, by a solver."""
    write_case(folder, PLATE, pin(1.3e-4, 0.7e-4, 0.0031), PIN_MOTION, steps=200)
    (folder / "ledger.in").write_text("")
    words, told = command(solver=solver), {"capture_output": True, "text": True, "errors": "replace"}  # stray bytes
    return subprocess.run(words, cwd=folder, env=solver_environment(), **told)


@pytest.mark.verify
def test_a_library_of_another_version_searches_itself(tmp_path):
    """The log says why, once for all walls and at each; the run goes on."""
    done = alone(tmp_path / "run", build(tmp_path, LIGGGHTS_VERSION="9.9"))
    assert done.returncode == 0, done.stdout[-2000:]
    why = "stock, this program was built for 9.9."
    assert f"Wall search: {why}" in done.stdout and f"Wall search of wall: {why}" in done.stdout


@pytest.mark.verify
def test_a_library_that_does_not_call_ours_is_told(tmp_path):
    """As one whose own function comes first: ours is taken out."""
    text = (REPOSITORY / "solver" / SEARCH_SOURCE).read_text()
    ours = text[text.index("void FixNeighlistMesh::pre_force(") : text.index("void FixWallGran::post_force_mesh(")]
    done = alone(tmp_path / "run", build(tmp_path, edit=(SEARCH_SOURCE, ours, "")))
    assert done.returncode == 0, done.stdout[-2000:]
    assert "Wall search: stock, the library calls functions of its own." in done.stdout
    assert "Wall search of wall: ours" not in done.stdout


@pytest.mark.verify
def test_a_contact_before_it_was_due_stops_the_run(tmp_path):
    """Pairs that wait a fifth of the radius too long are found by the look at all of them, here at every step."""
    text = (REPOSITORY / "solver" / SEARCH_SOURCE).read_text()
    rules = text[text.index("constexpr double MARGIN") : text.index("std::string left;")]
    late = "constexpr double MARGIN = -0.2;\nconstexpr int PROOF_INTERVAL = 1;\n"
    done = alone(tmp_path / "run", build(tmp_path, edit=(SEARCH_SOURCE, rules, late)))
    assert done.returncode != 0
    assert "found a contact before it was due" in done.stdout + done.stderr


def test_another_word_is_refused():
    """One sentence, before a deck is read."""
    done = subprocess.run([SOLVER, "-search", "fast"], env=solver_environment(), capture_output=True, text=True)
    assert done.returncode == 1
    assert done.stderr == "-search: found fast, allowed are ours and stock.\n"
