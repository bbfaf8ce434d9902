"""The solver's load ledger of one sphere that slides, rolls, spins or twists on a mesh, against closed forms."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import SurfaceMesh, stl_corners
from tests.verification.ledger_cases import (
    LOAD,
    PIN_MOTION,
    RADIUS,
    effective_modulus,
    hertz_overlap,
    pin,
    ring,
    run_case,
    total,
)

pytestmark = pytest.mark.solver

SPEED = 1.0  # m/s
SPIN = 300.0  # rad/s
DURATION = 4000 * 2e-6  # s, of the frame deck
LEVER = RADIUS - hertz_overlap() / 2  # m, the solver's own lever arm of the spin
TRACK_RADIUS = 0.022  # m (Yan 2022, chapter 5)
# A start that no node and no edge of the meshes is hit exactly: such a hit is two contacts for a step.
START = (0.000131234567, -0.0040007123456)  # m

SLIDING_TOLERANCE = 1e-6  # relative; what is asked of the ledger. Measured: 5e-16, the load stays at its equilibrium
PRINTED = 1e-9  # relative; the solver prints forces with 15 digits
ROUNDING = 1e-12  # relative; a closed form in steady motion, thousands of terms
NO_SLIDING = 1e-3  # of F L; what is asked of pure rolling. Measured: 2e-16
ROCKING_TOLERANCE = 1e-4  # of F R omega t; the plate tilts by 8 mrad meanwhile, 1 - cos(0.008) = 3e-5


def plate():
    """A plate of 0.5 mm elements, long enough for the tracks below."""
    return flat_plate(0.006, 0.012, 0.5e-3)


@pytest.mark.parametrize("element_size", [1e-3, 0.5e-3, pytest.param(0.25e-3, marks=pytest.mark.verify)])
def test_straight_drag_is_load_times_distance(tmp_path, element_size):
    """Sliding work of a pin that is dragged without turning: F L, whatever the mesh; it rolls nowhere, hits nothing."""
    mesh = flat_plate(0.006, 0.012, element_size)
    ledger = run_case(tmp_path, mesh, [*pin(*START), f"velocity all set 0.0 {SPEED} 0.0 units box"], PIN_MOTION)
    expected = LOAD * SPEED * DURATION
    assert total(ledger, "sliding_work_J") == pytest.approx(expected, rel=SLIDING_TOLERANCE)
    assert total(ledger, "normal_impulse_N_s") == pytest.approx(LOAD * DURATION, rel=SLIDING_TOLERANCE)
    assert total(ledger, "contact_time_s") == pytest.approx(DURATION, rel=ROUNDING)
    assert total(ledger, "rolling_work_J") == 0.0
    assert total(ledger, "impact_energy_J") == 0.0
    assert ledger.steps == 4000
    assert np.count_nonzero(ledger.columns["sliding_work_J"]) >= SPEED * DURATION / element_size


def test_oscillating_load_is_followed_step_by_step(tmp_path):
    """A pin that falls in and oscillates: the work is speed times the sum of the solver's own forces."""
    force = [f"variable push equal fcm(all,z)+{LOAD}", 'fix forces all print 1 "${push}" file forces.txt screen no']
    dropped = [*pin(*START, RADIUS - 0.5 * hertz_overlap()), f"velocity all set 0.0 {SPEED} 0.0 units box"]
    ledger = run_case(tmp_path, plate(), dropped, PIN_MOTION, outputs=force)
    forces = np.loadtxt(tmp_path / "forces.txt")[-ledger.steps :]
    assert np.ptp(forces) > LOAD / 2
    expected = SPEED * forces.sum() * DURATION / ledger.steps
    assert total(ledger, "sliding_work_J") == pytest.approx(expected, rel=PRINTED)


def test_outputs_of_contacts_do_not_count(tmp_path):
    """A deck that has contacts evaluated for an average in every step gets the ledger of one that does not."""
    averaged = ["compute push all reduce sum c_wall_contact[18]", "fix watch all ave/time 1 1 1 c_push"]
    dragged = [*pin(*START), f"velocity all set 0.0 {SPEED} 0.0 units box"]
    ledger = run_case(tmp_path, plate(), dragged, [*PIN_MOTION, *averaged])
    assert ledger.header["contacts"] == ledger.steps
    assert total(ledger, "contact_time_s") == pytest.approx(DURATION, rel=ROUNDING)
    assert total(ledger, "sliding_work_J") == pytest.approx(LOAD * SPEED * DURATION, rel=SLIDING_TOLERANCE)


def test_groove_of_two_faces(tmp_path):
    """A pin in a V of 90 degrees: each face carries F / sqrt(2), so the work is sqrt(2) F L.

    The contact radius is that of the pin's total force, the vector sum F, on both faces.
    """
    half = flat_plate(0.008, 0.012, 0.5e-3)
    across = np.abs(half.points[:, 0])
    folded = SurfaceMesh(half.points + across[:, None] * [0.0, 0.0, 1.0], half.triangles)
    each = LOAD / np.sqrt(2.0)
    height = np.sqrt(2.0) * (RADIUS - hertz_overlap(each))
    sliding = [*pin(0.0, START[1], height), f"velocity all set 0.0 {SPEED} 0.0 units box"]
    ledger = run_case(tmp_path, folded, sliding, PIN_MOTION, friction=0.0)
    expected = np.sqrt(2.0) * LOAD * SPEED * DURATION
    assert ledger.header["contacts"] == 2 * ledger.steps
    assert total(ledger, "sliding_work_J") == pytest.approx(expected, rel=SLIDING_TOLERANCE)
    radius = np.cbrt(0.75 * LOAD * RADIUS / effective_modulus())
    touched = ledger.columns["contact_time_s"] > 0
    assert ledger.columns["contact_radius_m"][touched] == pytest.approx(radius, rel=SLIDING_TOLERANCE)


@pytest.mark.parametrize("element_size", [1e-3, 0.5e-3, pytest.param(0.25e-3, marks=pytest.mark.verify)])
def test_revolution_of_a_disc_under_a_pin(tmp_path, element_size):
    """Sliding work of a whole turn of a disc under a pin at rest: F 2 pi r; turning about the normal is no rolling."""
    period, time_step = 0.025, 5e-6
    # 0.6 mm to each side of the track: the overlap of 40 um reaches 0.5 mm from the centre
    mesh = ring(TRACK_RADIUS - 0.6e-3, TRACK_RADIUS + 0.6e-3, element_size)
    place = (TRACK_RADIUS, 3.1234e-5)
    turn = f"fix turn all move/mesh mesh sample rotate origin 0.0 0.0 0.0 axis 0.0 0.0 1.0 period {period}"
    box = {"domain": "-0.03 0.03 -0.03 0.03 -0.01 0.02", "time_step": time_step, "steps": round(period / time_step)}
    ledger = run_case(tmp_path, mesh, pin(*place), PIN_MOTION, mesh_lines=[turn], **box)
    expected = LOAD * 2 * np.pi * np.hypot(*place)
    assert total(ledger, "sliding_work_J") == pytest.approx(expected, rel=SLIDING_TOLERANCE)
    assert total(ledger, "rolling_work_J") <= ROUNDING * expected
    assert total(ledger, "impact_energy_J") == 0.0
    touched = ledger.columns["contact_time_s"] > 0
    assert np.count_nonzero(touched) >= 2 * np.pi * TRACK_RADIUS / element_size
    _assert_on_track(ledger, mesh, touched, np.hypot(*place), element_size)


def _assert_on_track(ledger, mesh, touched, radius, element_size):
    """The mean contact point of each triangle, taken along with the turning mesh, lies on the track.

    Inside a triangle the track is an arc; the mean of an arc lies at most its sagitta, e^2/(8 r) for a chord e, inside.
    """
    weights = np.column_stack([ledger.columns[f"contact_weight_{k}"] for k in (1, 2, 3)])[touched]
    position = np.einsum("ik,ikj->ij", weights, stl_corners(mesh.points, mesh.triangles)[touched])
    longest = np.sqrt(2.0) * element_size  # m, diagonal of a quad
    inward = radius - np.linalg.norm(position[:, :2], axis=1)
    assert inward.min() > -1e-9
    assert inward.max() < longest**2 / (8 * radius) + 1e-9


def test_rolling_without_slip(tmp_path):
    """Pure rolling: no sliding at the contact point; rolling work F L R / (R - overlap/2), F L when stiff."""
    rolling = [
        *pin(*START),
        f"velocity all set 0.0 {SPEED} 0.0 units box",
        f"set group all omegax {-SPEED / LEVER:.17g}",
    ]
    ledger = run_case(tmp_path, plate(), rolling, [PIN_MOTION[0], "fix integrate all nve/sphere"])
    load_times_distance = LOAD * SPEED * DURATION
    assert total(ledger, "sliding_work_J") < NO_SLIDING * load_times_distance
    assert total(ledger, "rolling_work_J") == pytest.approx(load_times_distance * RADIUS / LEVER, rel=SLIDING_TOLERANCE)
    assert total(ledger, "rolling_work_J") == pytest.approx(load_times_distance, rel=hertz_overlap() / RADIUS)


def test_twisting_neither_slides_nor_rolls(tmp_path):
    """Spin about the contact normal: no velocity at the contact point, and no rolling."""
    twisting = [*pin(*START), f"set group all omegaz {SPIN}"]
    ledger = run_case(tmp_path, plate(), twisting, [PIN_MOTION[0], "fix integrate all nve/sphere"])
    reference = LOAD * SPIN * RADIUS * DURATION
    assert total(ledger, "normal_impulse_N_s") == pytest.approx(LOAD * DURATION, rel=SLIDING_TOLERANCE)
    assert total(ledger, "sliding_work_J") <= ROUNDING * reference
    assert total(ledger, "rolling_work_J") <= ROUNDING * reference


@pytest.mark.parametrize("axis", ["x", "y"])
def test_spinning_on_the_spot(tmp_path, axis):
    """Spin about an axis in the surface, the centre held: sliding F omega (R - overlap/2) t, rolling F omega R t."""
    ledger = run_case(tmp_path, plate(), [*pin(*START), f"set group all omega{axis} {SPIN}"], PIN_MOTION)
    assert total(ledger, "sliding_work_J") == pytest.approx(LOAD * SPIN * LEVER * DURATION, rel=SLIDING_TOLERANCE)
    assert total(ledger, "rolling_work_J") == pytest.approx(LOAD * SPIN * RADIUS * DURATION, rel=SLIDING_TOLERANCE)


def test_spin_with_sliding_adds_as_vectors(tmp_path):
    """A pin moving along y that spins about y: two velocities at a right angle, |v_t|^2 = v^2 + (omega l)^2."""
    moving = [*pin(*START), f"velocity all set 0.0 {SPEED} 0.0 units box", f"set group all omegay {SPIN}"]
    ledger = run_case(tmp_path, plate(), moving, PIN_MOTION)
    expected = LOAD * np.hypot(SPEED, SPIN * LEVER) * DURATION
    assert total(ledger, "sliding_work_J") == pytest.approx(expected, rel=SLIDING_TOLERANCE)


@pytest.mark.parametrize(("sphere_turns", "share"), [(0.0, 1.0), (1.0, 0.0), (-1.0, 2.0)])
def test_rolling_counts_the_turn_of_the_wall(tmp_path, sphere_turns, share):
    """A plate that rocks about the contact point at 1 rad/s: rolling work F R |omega - omega_wall| t.

    Without friction, which would carry part of the load on the tilted plate.
    """
    about = f"origin {START[0]} {START[1]} 0.0 axis 1.0 0.0 0.0 period {2 * np.pi}"
    rocking = f"fix rock all move/mesh mesh sample rotate {about}"
    spinning = [*pin(*START), f"set group all omegax {sphere_turns}"]
    ledger = run_case(tmp_path, plate(), spinning, PIN_MOTION, mesh_lines=[rocking], friction=0.0)
    once = LOAD * RADIUS * DURATION
    assert total(ledger, "rolling_work_J") == pytest.approx(share * once, abs=ROCKING_TOLERANCE * once)
