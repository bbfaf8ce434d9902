"""Every wear law on both ledgers, the solver's and that of dumps: spheres that slide, roll and hit, in closed form."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.readers.load_ledger import read_load_ledger
from bulkwear.postproc.wear.laws import worn_volume
from tests.support.law_cases import OKA
from tests.verification.ledger_cases import (
    DUMP_LINES,
    MASS,
    PIN_MOTION,
    RADIUS,
    hertz_force,
    hertz_overlap,
    ledger_of_dumps,
    pin,
    run_case,
    table_of_solver,
)

pytestmark = pytest.mark.solver

COEFFICIENT, FRICTION, SPEED, TIME_STEP = 1e-11, 0.4, 1.0, 2e-6  # 1/Pa, -, m/s, s
START = (1.31234567e-4, -0.0020007123456)  # m, no node and no edge below it, nor within AMPLITUDE
FORCE = hertz_force(hertz_overlap())  # N
EXACT = 1e-6  # relative; the nine digits of the STL move the overlap (test_solver_ledger_vectors.py)
STEPPED = 1e-4  # relative; a path of 500 steps per period. Measured: 1e-5
STUCK = 0.01  # of friction times sliding work; what steps leave of a spring's work. Measured: 0.002
AMPLITUDE, PERIOD = 5e-6, 500  # m, a fifth of the spring's length at which the contact slides; steps
DUMPED = 0.01  # relative; the dump's velocity is half a step later than its force
THIRD = 2e-5  # relative; 0.33333 of the solver is not 1/3
PARAMETER = "threshold_velocity_m_per_s"
SLOW_OKA = {**OKA, "reference_velocity_m_per_s": 1.0}
HELD = "fix carry all move linear 0.0 0.0 0.0 units box"
PLATE = flat_plate(0.006, 0.012, 1e-3)


def volume(law, table, **parameters):
    """Worn volume of each triangle, m3."""
    return worn_volume(law, table, {"wear_coefficient_per_pa": COEFFICIENT, **parameters})


def words_of(given):
    """Parameters of a kernel as a deck has them."""
    return " ".join(f"{name} {value}" for name, value in given.items())


def above_line(threshold):
    """Deck line of a ledger with impacts above a threshold (m/s)."""
    words = words_of(above_kernel(threshold)["impact_above_threshold"])
    return f"fix above all load/ledger mesh sample file above.bin kernels impact_above_threshold {words}"


def above_kernel(threshold):
    return {"impact_above_threshold": {PARAMETER: threshold}}


def rubbed(folder, settling, steps):
    """Ledger of a held sphere on a plate that goes to and fro by less than the contact's spring gives, undamped."""
    moving = f"fix rub all move/mesh mesh sample wiggle amplitude 0.0 {AMPLITUDE} 0.0 period {PERIOD * TIME_STEP}"
    case = {"mesh_lines": [moving], "settling": settling, "steps": steps, "friction": FRICTION, "restitution": 1.0}
    return table_of_solver(run_case(folder, PLATE, pin(*START), [HELD], time_step=TIME_STEP, **case), PLATE)


def test_shear_work_of_a_sliding_contact_is_friction_times_archard(tmp_path):
    """k mu F L; with k = alpha / mu it is Archard's, alpha F L, on every triangle; both from dumps too."""
    dragged = [*pin(*START), f"velocity all set 0.0 {SPEED} 0.0 units box"]
    case = {"friction": FRICTION, "settling": 300, "steps": 2000, "time_step": TIME_STEP}  # it slides after some 10
    ledger = run_case(tmp_path, PLATE, dragged, PIN_MOTION, outputs=DUMP_LINES, **case)
    table, sampled = table_of_solver(ledger, PLATE), ledger_of_dumps(tmp_path, PLATE, TIME_STEP, 300)
    by_hand = COEFFICIENT * FORCE * SPEED * 2000 * TIME_STEP
    archard, shear = volume("archard", table), volume("tangential_work", table)
    assert shear.sum() == pytest.approx(FRICTION * by_hand, rel=EXACT)
    np.testing.assert_allclose(shear / FRICTION, archard, rtol=EXACT)
    assert volume("archard", sampled).sum() == pytest.approx(by_hand, rel=DUMPED)
    assert volume("tangential_work", sampled).sum() == pytest.approx(FRICTION * by_hand, rel=DUMPED)


@pytest.mark.parametrize("angle", [0.2, 0.9], ids=["shallow", "steep"])
def test_a_sphere_led_into_the_plate_wears_by_the_law_of_finnie(tmp_path, angle):
    """k 2 E(gamma) v sum(F dt) at a given velocity and angle (rad), F that of Hertz at every step; E of both branches.

    Shallow: sin 2 gamma - 3 sin^2 gamma, steep: cos^2 gamma / 3.
    """
    led = f"fix carry all move linear 0.0 {SPEED * np.cos(angle):.17g} -{SPEED * np.sin(angle):.17g} units box"
    steps = 200
    case = {"friction": 0.0, "restitution": 1.0, "steps": steps, "time_step": TIME_STEP}
    ledger = run_case(tmp_path, PLATE, pin(*START), [led], outputs=DUMP_LINES, **case)
    sampled = ledger_of_dumps(tmp_path, PLATE, TIME_STEP, 0, kernels={"finnie_work": {}})
    deeper = SPEED * np.sin(angle) * TIME_STEP * np.arange(1, steps + 1)
    shares = {0.2: np.sin(2.0 * angle) - 3.0 * np.sin(angle) ** 2, 0.9: np.cos(angle) ** 2 / 3.0}
    impulse = hertz_force(hertz_overlap() + deeper).sum() * TIME_STEP
    expected = COEFFICIENT * 2.0 * shares[angle] * SPEED * impulse
    assert volume("finnie", ledger.columns).sum() == pytest.approx(expected, rel=THIRD)
    assert volume("finnie", sampled).sum() == pytest.approx(expected, rel=DUMPED)


def test_a_pin_that_slides_level_wears_by_sliding_alone(tmp_path):
    """Where laws disagree most: alpha F L by Archard, nothing by Finnie, by impacts and by Oka."""
    along = f"fix carry all move linear 0.0 {SPEED} 0.0 units box"
    kernels = f"finnie_work impact_above_threshold {PARAMETER} 0.0 oka_energy {words_of(SLOW_OKA)}"
    asked = f"fix every all load/ledger mesh sample file every.bin kernels {kernels}"
    case = {"friction": FRICTION, "steps": 1000, "time_step": TIME_STEP, "outputs": [asked]}
    run_case(tmp_path, PLATE, pin(*START), [along], **case)
    table = read_load_ledger(tmp_path / "every.bin", "sample").columns
    archard = volume("archard", table).sum()
    assert archard == pytest.approx(COEFFICIENT * FORCE * SPEED * 1000 * TIME_STEP, rel=EXACT)
    for law in ("finnie", "impact_threshold", "oka"):
        assert volume(law, table).sum() <= EXACT * archard


def test_a_contact_that_sticks_does_no_shear_work(tmp_path):
    """Two periods: Archard counts alpha F 8 A, the spring gives back what it took."""
    table = rubbed(tmp_path, settling=0, steps=2 * PERIOD)
    archard = volume("archard", table).sum()
    assert archard == pytest.approx(COEFFICIENT * FORCE * 8 * AMPLITUDE, rel=STEPPED)
    assert volume("tangential_work", table).sum() < STUCK * FRICTION * archard


def test_a_triangle_that_gives_back_more_than_it_took_wears_nothing(tmp_path):
    """A ledger that begins where the spring is longest: negative work, no volume, and no growth."""
    table = rubbed(tmp_path, settling=PERIOD // 4, steps=PERIOD // 4)
    assert table["tangential_work_J"].min() < -0.01 * FRICTION * table["sliding_work_J"].sum()
    assert not volume("tangential_work", table).any()


def test_combined_wears_by_rolling(tmp_path):
    """A pin that rolls without slip: k r F R omega T, with its lever of R less half the overlap it slides nowhere; from
    dumps too.
    """
    spin, steps, ratio = 300.0, 1000, 0.2  # rad/s, -, -
    rolling = f"velocity all set 0.0 -{spin * (RADIUS - hertz_overlap() / 2):.17g} 0.0 units box"
    particles = [*pin(*START), f"set group all omegax {spin}", rolling]
    case = {"friction": FRICTION, "steps": steps, "time_step": TIME_STEP, "outputs": [above_line(0.0), *DUMP_LINES]}
    run_case(tmp_path, PLATE, particles, PIN_MOTION, **case)
    exact = read_load_ledger(tmp_path / "above.bin", "sample").columns
    sampled = ledger_of_dumps(tmp_path, PLATE, TIME_STEP, 0, kernels=above_kernel(0.0))
    expected = COEFFICIENT * ratio * FORCE * RADIUS * spin * steps * TIME_STEP
    for table, tolerance in ((exact, EXACT), (sampled, DUMPED)):
        found = volume("combined", table, rolling_ratio=ratio, impact_ratio=0.5).sum()
        assert found == pytest.approx(expected, rel=tolerance)


def thrown(folder, speed, along=0.0, **rest):
    """Ledger of a sphere that hits the plate once, at that speed (m/s) and one along the plate, and leaves it."""
    particles = [*pin(*START, RADIUS + 1e-4), f"velocity all set 0.0 {along} -{speed} units box"]
    case = {"modulus": 5e6, "time_step": 1e-5, "steps": 400, **rest}
    return table_of_solver(run_case(folder, PLATE, particles, ["fix integrate all nve/sphere"], **case), PLATE)


def hit(folder, threshold, speed=0.4, along=0.0):
    """Ledgers of one hit, the solver's and that of dumps, with impacts above a threshold (m/s)."""
    thrown(folder, speed, along, outputs=[above_line(threshold), *DUMP_LINES], restitution=1.0)
    exact = read_load_ledger(folder / "above.bin", "sample").columns
    return exact, ledger_of_dumps(folder, PLATE, 1e-5, 0, modulus=5e6, kernels=above_kernel(threshold), touching=[])


@pytest.mark.parametrize("threshold", [0.0, 0.1, 0.5])
def test_combined_wears_by_impact(tmp_path, threshold):
    """Where nothing slides or rolls: k q m (v - K)^2 / 2, in the solver and from dumps."""
    speed, ratio = 0.4, 0.3  # m/s, -
    expected = COEFFICIENT * ratio * 0.5 * MASS * max(speed - threshold, 0.0) ** 2
    for table, tolerance in zip(hit(tmp_path, threshold), (EXACT, DUMPED), strict=True):
        found = volume("combined", table, rolling_ratio=0.5, impact_ratio=ratio).sum()
        assert found == pytest.approx(expected, rel=tolerance)


def test_combined_has_a_share_of_each(tmp_path):
    """A smooth sphere that hits at an angle without spin: k (J v_along + q m (v - K)^2 / 2), J = 2 m v its impulse."""
    speed, along, threshold, ratio = 0.4, 0.3, 0.1, 0.3  # m/s, m/s, m/s, -
    particles = [*pin(*START, RADIUS + 1e-4), f"velocity all set 0.0 {along} -{speed} units box"]
    case = {"modulus": 5e6, "time_step": 1e-6, "steps": 4000, "restitution": 1.0, "friction": 0.0}
    run_case(tmp_path, PLATE, particles, ["fix integrate all nve/sphere"], outputs=[above_line(threshold)], **case)
    table = read_load_ledger(tmp_path / "above.bin", "sample").columns
    shares = [2.0 * MASS * speed * along, ratio * 0.5 * MASS * (speed - threshold) ** 2]
    found = volume("combined", table, rolling_ratio=0.5, impact_ratio=ratio).sum()
    assert found == pytest.approx(COEFFICIENT * sum(shares), rel=STEPPED)
    assert volume("archard", table).sum() == pytest.approx(COEFFICIENT * shares[0], rel=STEPPED)


@pytest.mark.parametrize("threshold", [0.0, 0.1, 0.5])
def test_impacts_wear_by_what_is_above_the_threshold(tmp_path, threshold):
    """k m (v - K)^2 / 2 of one hit, in the solver and from dumps; nothing where v is below K; all with K = 0."""
    speed, (exact, sampled) = 0.4, hit(tmp_path, threshold)  # m/s
    expected = COEFFICIENT * 0.5 * MASS * max(speed - threshold, 0.0) ** 2
    assert volume("impact_threshold", exact).sum() == pytest.approx(expected, rel=EXACT)
    assert volume("impact_threshold", sampled).sum() == pytest.approx(expected, rel=DUMPED)


def test_oblique_impacts_wear_by_the_law_of_oka(tmp_path):
    """k m V^2 / 2 (v / V)^k2 g(a) of one hit at 53 degrees, in the solver and from dumps."""
    square, along, (n1, n2, hardness, k2, reference) = 0.4, 0.3, SLOW_OKA.values()  # m/s
    asked = f"fix angle all load/ledger mesh sample file angle.bin kernels oka_energy {words_of(SLOW_OKA)}"
    thrown(tmp_path, square, along, outputs=[asked, *DUMP_LINES], restitution=1.0, friction=0.0)
    exact = read_load_ledger(tmp_path / "angle.bin", "sample").columns
    sampled = ledger_of_dumps(tmp_path, PLATE, 1e-5, 0, modulus=5e6, kernels={"oka_energy": SLOW_OKA}, touching=[])
    speed = np.hypot(square, along)
    sine = square / speed
    expected = COEFFICIENT * 0.5 * MASS * reference**2 * (speed / reference) ** k2
    expected *= sine**n1 * (1.0 + 1e-9 * hardness * (1.0 - sine)) ** n2
    assert volume("oka", exact).sum() == pytest.approx(expected, rel=EXACT)
    assert volume("oka", sampled).sum() == pytest.approx(expected, rel=DUMPED)
