"""The solver's load ledger of a body of two spheres: one impact per body, sliding with the body's motion."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from tests.verification.ledger_cases import DENSITY, LOAD, MASS, RADIUS, hertz_overlap, run_case, total

pytestmark = pytest.mark.solver

ARM = 0.004  # m, from the middle of the body to the centre of each sphere; the spheres do not touch each other
SPEED = 0.4  # m/s
BODY_MASS = 2 * MASS  # kg
ACROSS = 0.8 * MASS * RADIUS**2 + BODY_MASS * ARM**2  # kg m2, inertia about x and z; without the arm that about y
ALONG = 0.8 * MASS * RADIUS**2
LAW_TOLERANCE = 1e-4  # relative; the lever arm varies with the overlap, which oscillates a little. Measured: 1.2e-6
ENERGY_TOLERANCE = 1e-9  # relative; the mass goes through the deck as text
RANK_TOLERANCE = 1e-6  # relative; each run places the body at random within SMALL of its overlap of 1e-4 m
SMALL = 1e-9  # m, size of the region that the body's middle is placed in
THRESHOLD = 0.1  # m/s
ABOVE_LINE = (
    "fix above all load/ledger mesh sample file above.bin kernels impact_above_threshold "
    f"threshold_velocity_m_per_s {THRESHOLD}"
)
LEVEL, TILTED = 0.0, 0.01  # rad, about x


def body(height, velocity="0.0 0.0 0.0", spin="0.0 0.0 0.0", tilt=LEVEL):
    """Deck lines of a body whose spheres lie along y, its middle at a height (m)."""
    place = " ".join(f"{low:.12g} {low + SMALL:.12g}" for low in (1.3e-4, 0.7e-4, height))
    turned = f"{np.cos(tilt / 2):.17g} {np.sin(tilt / 2):.17g} 0.0 0.0"
    return [
        f"fix pair all particletemplate/multisphere 15485863 atom_type 1 density constant {DENSITY} nspheres 2 "
        f"ntry 1000 spheres file pair.txt scale 1.0 type 1 mass {BODY_MASS:.17g} "
        f"inertia_tensor {ACROSS:.17g} 0.0 0.0 {ALONG:.17g} 0.0 {ACROSS:.17g} use_density",
        "fix mixture all particledistribution/discrete 32452843 1 pair 1.0",
        f"region source block {place} units box volume_limit 1e-30",
        "fix body all multisphere",
        "fix fill all insert/pack seed 49979687 distributiontemplate mixture "
        f"vel constant {velocity} omega constant {spin} orientation constant {turned} "
        "insert_every once overlapcheck no all_in no particles_in_region 1 region source",
    ]


def run_body(folder, particles, gravity, ranks=1, **rest):
    """Ledger of a body on a plate; the border between two processes lies between its spheres."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "pair.txt").write_text("".join(f"0.0 {y} 0.0 {RADIUS}\n" for y in (-ARM, ARM)))
    motion = [f"fix gravity all gravity {gravity} vector 0.0 0.0 -1.0"]
    outputs = ["dump spheres all custom 1 spheres.dump id fz", ABOVE_LINE]
    box = {"domain": "-0.02 0.02 -0.02 0.02 -0.01 0.02", "processors": f"1 {ranks} 1", "friction": 0.0}
    return run_case(folder, flat_plate(0.02, 0.02, 1e-3), particles, motion, ranks, outputs=outputs, **box, **rest)


def lifting_forces(folder):
    """Force that lifts each sphere at each step, (steps, 2) N."""
    lines = (line.split() for line in (folder / "spheres.dump").read_text().splitlines())
    rows = np.array([words for words in lines if len(words) == 2 and words[0] in ("1", "2")], np.float64)
    rows = rows[np.lexsort((rows[:, 0], np.arange(len(rows)) // 2))]
    return rows[:, 1].reshape(-1, 2)


@pytest.mark.parametrize("tilt", [LEVEL, TILTED], ids=["level", "tilted"])
def test_body_brings_its_energy_once(tmp_path, tilt):
    """A body that falls on both spheres, at once or one after the other: M v^2/2 once, on one process and on two; the
    kernel of impacts, M (v - K)^2/2, once too.
    """
    found = {}
    for ranks in (1, 2):
        folder = tmp_path / str(ranks)
        falling = body(RADIUS + 1e-4, velocity=f"0.0 0.0 {-SPEED}", tilt=tilt)
        case = {"steps": 300, "time_step": 1e-5, "modulus": 5e6, "restitution": 0.8}
        ledger = found[ranks] = run_body(folder, falling, 0.0, ranks, **case)
        lifting = lifting_forces(folder)
        assert total(ledger, "impact_energy_J") == pytest.approx(0.5 * BODY_MASS * SPEED**2, rel=ENERGY_TOLERANCE)
        assert np.count_nonzero(ledger.columns["impact_energy_J"]) == 1
        above = read_load_ledger(folder / "above.bin", "sample").columns["impact_above_threshold_J"].sum()
        assert above == pytest.approx(0.5 * BODY_MASS * (SPEED - THRESHOLD) ** 2, rel=ENERGY_TOLERANCE)
        first = (lifting > 0).argmax(axis=0)
        assert (lifting > 0).any(axis=0).all(), "a sphere never touched"
        assert abs(first[1] - first[0]) > 5 if tilt else abs(first[1] - first[0]) <= 1
        assert (lifting[max(first)] > 0).all(), "the first sphere has left before the second came"
    for name in ("impact_energy_J", "normal_impulse_N_s"):
        largest = found[1].columns[name].max()
        assert found[2].columns[name] == pytest.approx(found[1].columns[name], abs=RANK_TOLERANCE * largest), name


@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.verify)])
@pytest.mark.parametrize(("axis", "sliding_arm", "rolling_arm"), [("z", ARM, 0.0), ("y", RADIUS, RADIUS)])
def test_spinning_body_slides_with_its_own_motion(tmp_path, ranks, axis, sliding_arm, rolling_arm):
    """A body pressed on a smooth plate: sliding work F omega t times the arm of the contact points.

    Turning about the normal the spheres' centres go round at omega ARM, nothing rolls. Turning about its own long axis
    each sphere slides at omega (R - overlap/2), and rolls with omega R.
    """
    spin_rate, steps, time_step = 100.0, 2000, 2e-6
    spin = " ".join(str(spin_rate if each == axis else 0.0) for each in "xyz")
    pressed = body(RADIUS - hertz_overlap(), spin=spin)
    ledger = run_body(tmp_path, pressed, LOAD / MASS, ranks, settling=3000, steps=steps, time_step=time_step)
    impulse = total(ledger, "normal_impulse_N_s")
    # the solver starts a run of bodies with half a kick in which the wall does not push yet; the wall makes up for it
    assert impulse == pytest.approx(2 * LOAD * steps * time_step, rel=0.51 / steps)
    arm = sliding_arm if axis == "z" else sliding_arm - hertz_overlap() / 2
    reference = impulse * spin_rate * RADIUS
    assert total(ledger, "sliding_work_J") == pytest.approx(impulse * spin_rate * arm, rel=LAW_TOLERANCE)
    rolling = impulse * spin_rate * rolling_arm
    assert total(ledger, "rolling_work_J") == pytest.approx(rolling, abs=LAW_TOLERANCE * reference)
