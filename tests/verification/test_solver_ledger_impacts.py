"""Impact energy in the solver's load ledger: m v_n^2/2 once per bounce, wherever the contact wanders."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from tests.verification.ledger_cases import MASS, RADIUS, pin, run_case, total

pytestmark = pytest.mark.solver

RESTITUTION = 0.8  # -, of the bouncing cases
TIME_STEP = 1e-5  # s
ROUNDING = 1e-12  # relative; one product of numbers that the test knows exactly
PRINTED = 1e-9  # relative; the solver prints 15 digits, and a step more or less at the ends is none of the force
RESTITUTION_TOLERANCE = 0.02  # relative; the sphere's weight takes a little in slow bounces. Measured: 0.004 to 0.011
RANK_TOLERANCE = 1e-12  # relative; the same trajectory, summed in another order
BOUNCING = [
    "variable step equal step",
    "variable x equal xcm(all,x)",
    "variable z equal xcm(all,z)",
    "variable vz equal vcm(all,z)",
    "variable impact equal f_load_ledger[4]",
    "variable touching equal f_load_ledger[5]",
    'fix trace all print 1 "${step} ${x} ${z} ${vz} ${impact} ${touching}" file trace.txt screen no',
]


def bounces(folder, gravity):
    """What the trace says of each bounce.

    Returns arrays of one entry per bounce: energy (J) that the ledger gained, speed (m/s) at which the sphere reaches
    the plate (free flight conserves v^2 + 2 g z), travel (m) in contact, and whether x = 0 was passed meanwhile.
    """
    _, x, z, vz, impact, _ = np.loadtxt(folder / "trace.txt").T
    begins = np.flatnonzero(np.diff((z < RADIUS).astype(int)) == 1)
    ends = np.flatnonzero(np.diff((z < RADIUS).astype(int)) == -1)
    assert len(begins) == len(ends), "the run must end in flight"
    gained = impact[ends + 1] - impact[begins]
    speed = np.sqrt(vz[begins] ** 2 + 2 * gravity * (z[begins] - RADIUS))
    return gained, speed, x[ends] - x[begins], (x[begins] < 0) & (x[ends] > 0)


def drop(folder, mesh, place, speeds, gravity, steps, ranks=1, **rest):
    """Drop a sphere from a height of 0.5 mm and return the ledger."""
    vx, vz = speeds
    particles = [*pin(*place, RADIUS + 0.5e-3), f"velocity all set {vx} 0.0 {vz} units box"]
    motion = [f"fix gravity all gravity {gravity} vector 0.0 0.0 -1.0", "fix integrate all nve/sphere"]
    case = {"time_step": TIME_STEP, "restitution": RESTITUTION, "steps": steps, "outputs": BOUNCING, **rest}
    return run_case(folder, mesh, particles, motion, ranks, **case)


def test_one_hit_without_gravity(tmp_path):
    """A sphere that flies straight at a plate: exactly m v^2/2, on one triangle; the impulse is m v (1 + e)."""
    speed = 0.4
    ledger = drop(tmp_path, flat_plate(0.004, 0.004, 1e-3), (1.2e-4, 0.7e-4), (0.0, -speed), 0.0, 400, modulus=5e6)
    assert total(ledger, "impact_energy_J") == pytest.approx(0.5 * MASS * speed**2, rel=ROUNDING)
    assert np.count_nonzero(ledger.columns["impact_energy_J"]) == 1
    impulse = MASS * speed * (1 + RESTITUTION)
    assert total(ledger, "normal_impulse_N_s") == pytest.approx(impulse, rel=RESTITUTION_TOLERANCE)


def test_pulling_forces_do_not_count(tmp_path):
    """The damped contact pulls before the sphere leaves; the impulse is the sum of the pushing forces alone."""
    force = ["variable force equal fcm(all,z)", 'fix forces all print 1 "${force}" file forces.txt screen no']
    mesh, place = flat_plate(0.004, 0.004, 1e-3), (1.2e-4, 0.7e-4)
    case = {"modulus": 5e6, "restitution": 0.3, "outputs": force}
    ledger = drop(tmp_path, mesh, place, (0.0, -0.4), 0.0, 400, **case)
    forces = np.loadtxt(tmp_path / "forces.txt")
    assert forces.min() < -0.01 * forces.max()
    pushing = np.maximum(forces, 0.0).sum() * TIME_STEP
    assert total(ledger, "normal_impulse_N_s") == pytest.approx(pushing, rel=PRINTED)


def test_every_bounce_counts_once(tmp_path):
    """Bounces under gravity: m v_n^2/2 each, and v_n falls by the coefficient of restitution from bounce to bounce."""
    gravity = 9.81
    ledger = drop(tmp_path, flat_plate(0.004, 0.004, 1e-3), (1.2e-4, 0.7e-4), (0.0, -0.1), gravity, 7500, modulus=5e7)
    gained, speed, _, _ = bounces(tmp_path, gravity)
    assert len(gained) >= 3
    # the speed at the first touch is known to a step's fall
    assert gained == pytest.approx(0.5 * MASS * speed**2, rel=3 * gravity * TIME_STEP / speed.min())
    assert speed[1:] / speed[:-1] == pytest.approx(RESTITUTION, rel=RESTITUTION_TOLERANCE)
    assert total(ledger, "impact_energy_J") == pytest.approx(gained.sum(), rel=ROUNDING)


def test_a_bounce_that_rolls_over_many_triangles_counts_once(tmp_path):
    """Crossing to the next triangle, or to another process, while touching is no impact: still m v_n^2/2 per bounce."""
    gravity, mesh = 50.0, flat_plate(0.04, 0.002, 0.25e-3)
    ledgers = []
    for ranks in (1, 2):
        folder = tmp_path / f"ranks_{ranks}"
        # lists built anew every 0.05 mm: particles change process only then
        place, where = (
            (-0.0123, 0.7e-4),
            {"skin": 1e-4, "processors": f"{ranks} 1 1", "domain": "-0.021 0.021 -0.01 0.01 -0.01 0.02"},
        )
        ledgers.append(drop(folder, mesh, place, (1.0, -0.3), gravity, 2400, ranks, modulus=5e6, friction=0.3, **where))
        gained, speed, travel, passed = bounces(folder, gravity)
        assert len(gained) >= 2
        assert gained == pytest.approx(0.5 * MASS * speed**2, rel=3 * gravity * TIME_STEP / speed.min())
        assert travel.max() > 3 * 0.25e-3
        assert passed.any(), "no contact lies across the border between the two processes"
        assert np.count_nonzero(ledgers[-1].columns["impact_energy_J"]) == len(gained)
    one, two = ledgers
    assert two.columns["impact_energy_J"] == pytest.approx(one.columns["impact_energy_J"], rel=RANK_TOLERANCE)
    assert two.header["ranks"] == 2
