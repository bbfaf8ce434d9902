"""The solver's load ledger under many particles: a pile at rest does not slide; a dragged bed agrees with dumps."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from tests.verification.ledger_cases import (
    DUMP_LINES,
    GRAVITY,
    ledger_of_dumps,
    run_case,
    table_of_solver,
    total,
)

pytestmark = pytest.mark.solver

PARTICLES, BALL_RADIUS, BALL_DENSITY = 150, 1.325e-3, 2460.0  # -, m, kg/m3
BALL_MASS = 4.0 / 3.0 * np.pi * BALL_RADIUS**3 * BALL_DENSITY  # kg
SETTLING = 15000  # steps in which the pile falls and comes to rest
TIME_STEP = 2e-5  # s
SOFT = 5e6  # Pa; few steps per collision, so the pile settles in seconds
BOX = {
    "domain": "-0.04 0.04 -0.015 0.015 -0.005 0.025",
    "settling": SETTLING,
    "time_step": TIME_STEP,
    "modulus": SOFT,
    "friction": 0.5,
    "restitution": 0.3,
}
POURED = [
    "fix ball all particletemplate/sphere 15485863 atom_type 1 "
    f"density constant {BALL_DENSITY} radius constant {BALL_RADIUS}",
    "fix mixture all particledistribution/discrete 32452843 1 ball 1.0",
    "region source block -0.0095 0.0095 -0.0095 0.0095 0.0015 0.021 units box",
    "fix fill all insert/pack seed 49979687 distributiontemplate mixture vel constant 0.0 0.0 -0.2 insert_every once "
    f"overlapcheck yes all_in yes particles_in_region {PARTICLES} region source",
]
SIDE_WALLS = [
    f"fix {axis}_{side} all wall/gran model hertz tangential history primitive type 2 {axis}plane {place}"
    for axis in "xy"
    for side, place in (("low", -0.01), ("high", 0.01))
]
LOOSE = [*SIDE_WALLS, f"fix gravity all gravity {GRAVITY} vector 0.0 0.0 -1.0", "fix integrate all nve/sphere"]

WALLS_CARRY = 0.1  # of the weight, at most, by friction on the side walls. Measured: 0.03
CREEP = 1e-3  # m/s; a pile whose mean sliding speed may be larger is not at rest
SPEED, BLOCKS, BLOCK_STEPS = 0.4, 5, 500  # m/s, -, steps: 4 mm of travel, three particle radii, per block
# Of the total. The dump's damping forces come from velocities of the step's end, the solver's from those of its middle:
# in a hit the dump misses c dt / (2 m) of the impulse, a few % at 40 steps per hit. Measured: 0.004 and 0.0075
PRODUCERS_TOLERANCE = 0.015
# Of the total, sum of the differences of all triangles; a ball on a flat plate has a single contact, and the dump the
# force of the step. Measured: 1e-5; 12 without that force
FRICTION_TOLERANCE = 1e-4
CONFIDENCE = 3.0  # standard deviations by which chaotic runs of the same bed may differ


def test_pile_at_rest_does_not_slide(tmp_path):
    """Sliding work of a pile at rest is bounded by what kinetic energy is left.

    For each contact |v_t| <= |v| + R |omega|, and with E_i = m v^2/2 + m R^2 omega^2/5 of its particle
    (|v| + R |omega|)^2 <= 2 (v^2 + R^2 omega^2) <= 10 E_i / m. By Cauchy and Schwarz, with one contact per particle on
    a flat plate, sum F |v_t| <= (sum F) sqrt(10 E / m), so the work is at most the impulse times sqrt(10 E_max / m).
    """
    outputs = [
        "compute moving all ke",
        "compute turning all erotate/sphere",
        "variable energy equal c_moving+c_turning",
        'fix trace all print 1 "${energy}" file energy.txt screen no',
    ]
    steps = 2000
    ledger = run_case(tmp_path, flat_plate(0.03, 0.03, 2e-3), POURED, LOOSE, outputs=outputs, steps=steps, **BOX)
    energy = np.loadtxt(tmp_path / "energy.txt").max()
    impulse = total(ledger, "normal_impulse_N_s")
    weight = PARTICLES * BALL_MASS * GRAVITY
    assert impulse == pytest.approx(weight * steps * TIME_STEP, rel=WALLS_CARRY)
    bound = impulse * np.sqrt(10 * energy / BALL_MASS)
    assert bound < impulse * CREEP * 100, "the pile is not at rest: the bound says nothing"
    assert total(ledger, "sliding_work_J") <= bound
    assert total(ledger, "sliding_work_J") < impulse * CREEP
    assert total(ledger, "impact_energy_J") <= energy


def pulled(step):
    """Pose of the plate: at rest until the pile has settled."""
    return np.eye(3), np.array([SPEED * TIME_STEP * (step - SETTLING), 0.0, 0.0])


def dragged_bed(folder, mesh, ranks=1, dumps=()):
    """Ledger, and sliding work (J) of all blocks but the first, of a bed whose plate is pulled away under it."""
    outputs = [
        "fix pull all move/mesh mesh sample linear " + f"{SPEED} 0.0 0.0",
        "variable work equal f_load_ledger",
        f'fix trace all print {BLOCK_STEPS} "${{work}}" file work.txt screen no',
        *dumps,
    ]
    case = {"outputs": outputs, "steps": BLOCKS * BLOCK_STEPS, "processors": f"1 {ranks} 1", **BOX}
    ledger = run_case(folder, mesh, POURED, LOOSE, ranks, **case)
    return ledger, np.diff(np.loadtxt(folder / "work.txt"))


def plate():
    """A plate that still covers the box when it has been pulled 20 mm along x."""
    mesh = flat_plate(0.05, 0.022, 1e-3)
    mesh.points[:, 0] -= 0.01
    return mesh


@pytest.mark.verify
def test_dragged_bed_agrees_with_dumps_of_every_step(tmp_path):
    """Totals of both producers agree within the deviation between blocks of travel: they saw one trajectory."""
    mesh = plate()
    ledger, blocks = dragged_bed(tmp_path, mesh, dumps=DUMP_LINES)
    table = ledger_of_dumps(tmp_path, mesh, TIME_STEP, SETTLING, SOFT, BALL_DENSITY, touching=[], pose=pulled)
    work = total(ledger, "sliding_work_J")
    assert blocks.min() > 0
    difference = abs(table["sliding_work_J"].sum() - work)
    assert difference < blocks.std(ddof=1) * np.sqrt(BLOCKS)
    for name in ("sliding_work_J", "rolling_work_J", "normal_impulse_N_s"):
        assert table[name].sum() == pytest.approx(total(ledger, name), rel=PRODUCERS_TOLERANCE), name
    assert ledger.columns["contact_time_s"] == pytest.approx(table["contact_time_s"], rel=1e-9)
    exact = table_of_solver(ledger, mesh)
    for name in ("tangential_work_J", "drive_work_J", "impulse_x_N_s"):
        assert np.abs(exact[name] - table[name]).sum() <= FRICTION_TOLERANCE * np.abs(exact[name]).sum(), name


@pytest.mark.verify
def test_dragged_bed_on_two_processes(tmp_path):
    """One and two processes part ways in a chaotic bed; their totals agree within the deviation between blocks."""
    (one, blocks), (two, others) = (dragged_bed(tmp_path / str(ranks), plate(), ranks) for ranks in (1, 2))
    deviation = np.hypot(blocks.std(ddof=1), others.std(ddof=1)) * np.sqrt(BLOCKS)
    difference = abs(total(one, "sliding_work_J") - total(two, "sliding_work_J"))
    assert difference < CONFIDENCE * deviation
    assert two.header["ranks"] == 2
