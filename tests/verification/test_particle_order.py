"""The order of particles in memory: along a curve through space, every particle with all that it has."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.workflows.engine.solver import solver_environment
from tests.verification.ledger_cases import command, write_case
from tests.verification.test_solver_ledger_beds import BOX, LOOSE, POURED

pytestmark = pytest.mark.solver

ORDERS = ("ours", "stock")
PLATE = flat_plate(0.026, 0.026, 1e-3)
CORNER, UPPER, SKIN = np.array([-0.04, -0.03, -0.02]), np.array([0.04, 0.03, 0.03]), 1e-3  # m
FALLEN = {**BOX, "domain": "-0.04 0.04 -0.03 0.03 -0.02 0.03", "skin": SKIN, "settling": 2500, "steps": 500}
BITS = 7  # of a cell's number along an axis here
STATE = [
    "dump state all custom 500 *.state id x y z vx vy vz omegax omegay omegaz radius mass",
    'dump_modify state format "%d' + 11 * " %.17g" + '"',
]


def states(folder: Path, order: str, ranks: int = 1, **variables) -> list[np.ndarray]:
    """Rows of the particles as they lie in memory, (n, 12), at the first and at the last step of a run by an order."""
    words = [*command(ranks, **variables), "-order", order]
    done = subprocess.run(words, cwd=folder, env=solver_environment(ranks), capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    files = sorted(folder.glob("*.state"), key=lambda path: int(path.stem))
    return [np.loadtxt(path, skiprows=9) for path in (files[0], files[-1])]


def along_curve(places: np.ndarray, cell: float) -> np.ndarray:
    """Morton's number of the cells that hold the places: bits of z, y and x in turn."""
    number = ((places - CORNER) / cell).astype(np.int64)
    bits = (number[:, :, None] >> np.arange(BITS)) & 1
    return (bits << (3 * np.arange(BITS) + np.arange(3)[:, None])).sum(axis=(1, 2))


@pytest.fixture(scope="module")
def fallen(tmp_path_factory) -> Path:
    """Folder with a fallen bed, half.restart, of particles that were shuffled on their way."""
    folder = tmp_path_factory.mktemp("order")
    write_case(folder, PLATE, POURED, LOOSE, outputs=["restart 500 half.restart half.restart"], **FALLEN)
    words = [*command(), "-order", "stock"]
    subprocess.run(words, cwd=folder, env=solver_environment(), capture_output=True, check=True)
    return folder


def resumed(folder: Path, fallen: Path, order: str, ranks: int = 1) -> list[np.ndarray]:
    """`states` of a run that goes on from the fallen bed."""
    write_case(folder, PLATE, POURED, LOOSE, outputs=STATE, **FALLEN)
    (folder / "half.restart").write_bytes((fallen / "half.restart").read_bytes())
    words = {"resumed": 1, "restart_file": "half.restart", "particles": "nothing", "settling": 0, "steps": 4000}
    return states(folder, order, ranks, **words)


def test_particles_lie_along_the_curve(tmp_path, fallen):
    """Cells of half the reach of the lists; in the library's order they do not. Each particle is there with its
    velocities, size and mass, to the last bit."""
    found = {order: resumed(tmp_path / order, fallen, order)[0] for order in ORDERS}
    cell = 0.5 * (2.0 * found["ours"][:, 10].max() + SKIN)
    assert ((UPPER - CORNER) / cell < 1 << BITS).all()
    turned_back = {
        order: np.count_nonzero(np.diff(along_curve(rows[:, 1:4], cell)) < 0) for order, rows in found.items()
    }
    assert turned_back["ours"] == 0 < turned_back["stock"]
    ours, stock = (rows[np.argsort(rows[:, 0])] for rows in found.values())
    np.testing.assert_array_equal(ours, stock)


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.verify)])
def test_the_same_bed(tmp_path, fallen, ranks):
    """A bed at rest stays where it is by either order, but for rounding; so no contact's history is another's."""
    found = {order: resumed(tmp_path / order, fallen, order, ranks)[1] for order in ORDERS}
    ours, stock = (rows[np.argsort(rows[:, 0])] for rows in found.values())
    np.testing.assert_array_equal(ours[:, 0], stock[:, 0])
    np.testing.assert_allclose(ours[:, 1:4], stock[:, 1:4], atol=1e-9)


def test_another_word_is_refused():
    """One sentence, before a deck is read."""
    done = subprocess.run([*command(), "-order", "fast"], env=solver_environment(), capture_output=True, text=True)
    assert done.returncode == 1
    assert done.stderr == "-order: found fast, allowed are ours and stock.\n"
