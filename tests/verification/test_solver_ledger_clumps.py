"""The solver's load ledger under a bed of clumps that are poured as decks pour them."""

import shutil
import subprocess

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.readers.contacts import read_contact_batches
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.workflows.config.clumps import find_clump
from bulkwear.workflows.engine.decks import primes, size_distribution
from bulkwear.workflows.engine.grains import grain_words, with_clump
from bulkwear.workflows.engine.solver import solver_environment
from bulkwear.workflows.engine.templates import render
from tests.verification.ledger_cases import DUMP_LINES, GRAVITY, command, run_case, total

pytestmark = pytest.mark.solver

CLUMPS, DENSITY, DIAMETERS = 60, 2460.0, [3e-3, 4e-3]  # -, kg/m3, m
SHARES = [0.4, 0.6]  # -, of the mass
SETTLING, TIME_STEP, STEPS = 9000, 2e-5, 1500  # steps, s, steps
SPEED = 0.2  # m/s, of the plate that is pulled away under the bed
HALF = 0.01  # m, half the side of the box
FRICTION = 0.5  # -
# Of the weight, at most: the drag, FRICTION of it, presses the bed on a side wall, whose friction holds down what
# rises there. Measured: 0.13
WALLS_CARRY = FRICTION**2
ROUNDING = 1e-9  # relative; the dump has twelve digits
# Of the total: the force of a sphere over an edge is shared, the dump knows it as a whole. Measured 2e-5
SHARED = 2e-4


def poured():
    """Deck lines of a bed of clumps, as the template has them."""
    name, sizes = "tetrahedron", {"diameters_m": DIAMETERS, "density_kg_per_m3": DENSITY}
    particle = with_clump(sizes, name, find_clump(name))
    words = {"size_distribution": size_distribution(SHARES), "size_count": 2, "seeds": primes(15485863, 3)}
    source = " ".join(f"{-HALF + 2.5e-3} {HALF - 2.5e-3}" for _ in "xy")
    return [
        f"variable density equal {DENSITY}",
        *render("_shared/particles", {"grains": "clump", **words, **grain_words(particle)}).splitlines(),
        "fix motion all multisphere allow_group_and_set yes",
        f"region source block {source} 0.003 0.035 units box",
        "fix fill all insert/pack seed 49979687 distributiontemplate sizes vel constant 0.0 0.0 -0.2 insert_every once "
        f"overlapcheck yes all_in no particles_in_region {CLUMPS} region source",
    ]


def loose():
    """Deck lines of side walls and gravity."""
    walls = [
        f"fix {axis}_{side} all wall/gran model hertz tangential history primitive type 2 {axis}plane {place}"
        for axis in "xy"
        for side, place in (("low", -HALF), ("high", HALF))
    ]
    return [*walls, f"fix gravity all gravity {GRAVITY} vector 0.0 0.0 -1.0"]


@pytest.fixture(scope="module")
def dragged(tmp_path_factory):
    """Folder, ledger and plate of a bed of clumps whose plate is pulled away under it."""
    folder, plate = tmp_path_factory.mktemp("clumps"), flat_plate(0.05, 0.022, 1e-3)
    plate.points[:, 0] -= 0.01
    outputs = [
        f"fix pull all move/mesh mesh sample linear {SPEED} 0.0 0.0",
        "variable mass equal mass(all)",
        'fix weighed all print 500 "${mass}" file mass.txt screen no',
        *DUMP_LINES,
    ]
    box = {"domain": "-0.04 0.04 -0.015 0.015 -0.005 0.04", "settling": SETTLING, "time_step": TIME_STEP}
    rest = {"modulus": 5e6, "friction": FRICTION, "restitution": 0.3, "steps": STEPS}
    return folder, run_case(folder, plate, poured(), loose(), outputs=outputs, **box, **rest), plate


def test_bed_weighs_what_its_clumps_do(dragged):
    """Each body counts once, not with each of its spheres: CLUMPS bodies of the mean mass of the sizes by number."""
    masses = DENSITY * np.pi / 6.0 * np.array(DIAMETERS) ** 3
    mean = 1.0 / (np.array(SHARES) / masses).sum()
    found = float((dragged[0] / "mass.txt").read_text().split()[-1])
    assert found == pytest.approx(CLUMPS * mean, abs=float(np.ptp(masses)))  # the number of each size is rounded


def test_plate_carries_the_bed(dragged):
    """Normal impulse of the ledger: weight times time, but for friction on the side walls."""
    folder, ledger, _ = dragged
    weight = float((folder / "mass.txt").read_text().split()[-1]) * GRAVITY
    assert total(ledger, "normal_impulse_N_s") == pytest.approx(weight * STEPS * TIME_STEP, rel=WALLS_CARRY)


def test_ledger_is_the_sum_of_the_contacts(dragged):
    """Sums of F_n |v_t| dt, F_n dt and dt over the contacts of all steps; v_t: of the body, where its sphere touches.

    Triangle by triangle for the time of contact, in total for what hangs on velocities.
    """
    folder, ledger, plate = dragged
    work = impulse = 0.0
    time = np.zeros(len(plate.triangles))
    for batch in read_contact_batches(folder / "contacts.dump", folder / "spins.dump", after_step=SETTLING):
        force = np.maximum(batch.wall_force[:, 2], 0.0)  # the plate is flat: a sphere touches one triangle of it
        distance = np.linalg.norm(batch.contact_point - batch.centre, axis=1)
        lever = np.zeros_like(batch.centre)
        lever[:, 2] = -0.5 * (batch.radius + distance)
        velocity = batch.particle_velocity - batch.wall_velocity + np.cross(batch.angular_velocity, lever)
        work += (force * np.hypot(*velocity[:, :2].T)).sum() * TIME_STEP
        impulse += force.sum() * TIME_STEP
        np.add.at(time, batch.triangle, np.where(batch.force.any(axis=1), TIME_STEP, 0.0))
    assert total(ledger, "sliding_work_J") == pytest.approx(work, rel=SHARED)
    assert total(ledger, "normal_impulse_N_s") == pytest.approx(impulse, rel=SHARED)
    assert ledger.columns["contact_time_s"] == pytest.approx(time, rel=ROUNDING)
    assert np.count_nonzero(time) > CLUMPS


@pytest.mark.verify
def test_both_searches_find_the_same_contacts(dragged, tmp_path):
    """The wall search of this program and the solver's own: every column of the ledger, to the last bit."""
    folder, ledger, plate = dragged
    for path in folder.glob("*.in"):
        shutil.copy(path, tmp_path)
    shutil.copy(folder / "sample.stl", tmp_path)
    words = [*command(), "-search", "stock"]
    done = subprocess.run(words, cwd=tmp_path, env=solver_environment(), capture_output=True)
    assert done.returncode == 0 and b"stock, as asked" in done.stdout
    stock = read_load_ledger(tmp_path / "load_ledger.bin", "sample", len(plate.triangles))
    for name, found in stock.columns.items():
        np.testing.assert_array_equal(found, ledger.columns[name], err_msg=name)  # NaN where nothing touched
