"""Contact kernels against closed forms."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from bulkwear.postproc.wear.kernels import (
    KERNELS,
    finnie_work,
    impact_above_threshold,
    kernel_column,
    kernel_value,
    oka_energy,
)
from bulkwear.postproc.wear.ledger import LedgerBuilder, contact_kinematics
from tests import REPOSITORY
from tests.support.law_cases import long_slip_registered

ROUND_OFF = 1e-12  # a few products in float64
CONTINUITY = 1e-4  # relative; 0.33333 of the solver is not 1/3
UP = np.array([[0.0, 0.0, 1.0]])
KINK = np.arctan(1.0 / 3.0)  # angle of impact at which the two branches meet
FORCE = np.array([[3.0, 0.0, 4.0]])


def contact(centre=(0.0, 0.0, 1e-3), force=FORCE):
    """One contact at the origin."""
    return SimpleNamespace(contact_point=np.zeros((1, 3)), centre=np.array([centre]), force=np.asarray(force))


def moving(velocity):
    return SimpleNamespace(relative_velocity=np.asarray(velocity, np.float64).reshape(-1, 3))


def at_angle(angle, speed=2.0):
    """Velocity that meets the triangle under an angle (rad)."""
    return moving([speed * np.cos(angle), 0.0, -speed * np.sin(angle)])


def test_a_shallow_impact_cuts():
    """Below the kink: 2 (sin 2 gamma - 3 sin^2 gamma) v F (Finnie 1960), with the whole force, friction included."""
    angle = 0.2
    expected = 2.0 * (np.sin(2.0 * angle) - 3.0 * np.sin(angle) ** 2) * 2.0 * 5.0
    assert finnie_work(contact(), at_angle(angle), UP)[0] == pytest.approx(expected, rel=ROUND_OFF)


def test_a_steep_impact_takes_a_third_of_cos_squared():
    """Above the kink: 2 0.33333 cos^2 gamma v F."""
    angle = 0.9
    expected = 2.0 * 0.33333 * np.cos(angle) ** 2 * 2.0 * 5.0
    assert finnie_work(contact(), at_angle(angle), UP)[0] == pytest.approx(expected, rel=ROUND_OFF)


def test_both_branches_meet_at_the_kink():
    """tan gamma = 1/3: the function is continuous but for the digits of 0.33333."""
    below, above = (finnie_work(contact(), at_angle(KINK * (1.0 + sign * 1e-9)), UP)[0] for sign in (-1.0, 1.0))
    assert below == pytest.approx(above, rel=CONTINUITY)


@pytest.mark.parametrize("angle", [0.0, np.pi / 2.0])
def test_grazing_and_normal_impacts_take_nothing(angle):
    """sin 2 gamma vanishes at 0, cos gamma at 90 degrees."""
    assert finnie_work(contact(), at_angle(angle), UP)[0] == pytest.approx(0.0, abs=ROUND_OFF)


def test_only_approaching_contacts_count():
    """A particle that leaves, or hardly moves, takes nothing; sliding along the surface still counts as approach."""
    assert finnie_work(contact(), moving([1.0, 0.0, 0.3]), UP)[0] == 0.0
    assert finnie_work(contact(), moving([0.5e-7, 0.0, -0.5e-7]), UP)[0] == 0.0
    assert finnie_work(contact(), moving([1.0, 0.0, -0.1]), UP)[0] > 0.0


def test_neither_the_sign_nor_the_length_of_the_normal_matters():
    """Facets may be wound either way; twice the area is as good as one."""
    expected = finnie_work(contact(), at_angle(0.2), UP)
    for factor in (-1.0, 7.0, -1e-8):
        np.testing.assert_allclose(finnie_work(contact(), at_angle(0.2), factor * UP), expected, rtol=ROUND_OFF)


def test_the_triangle_decides_the_angle_not_the_contact():
    """At an edge the direction to the centre differs from the triangle's normal; gamma is against the triangle."""
    leaning = contact(centre=(6e-4, 0.0, 8e-4))
    expected = finnie_work(contact(), moving([-1.0, 0.0, -0.2]), UP)
    np.testing.assert_allclose(finnie_work(leaning, moving([-1.0, 0.0, -0.2]), UP), expected, rtol=ROUND_OFF)


def test_an_impact_above_the_threshold_brings_what_is_above():
    """m (v - K)^2 / 2, nothing at K and below, m v^2 / 2 with K = 0 (Bitter 1963)."""
    motion = SimpleNamespace(mass=np.array([2.0, 2.0, 3.0]), approach_speed=np.array([5.0, 0.5, 1.0]))
    np.testing.assert_allclose(impact_above_threshold(None, motion, None, 1.0), [16.0, 0.0, 0.0], rtol=ROUND_OFF)
    np.testing.assert_allclose(impact_above_threshold(None, motion, None, 0.0), [25.0, 0.25, 1.5], rtol=ROUND_OFF)


OKA = {"angle_exponent": 0.7, "hardness_exponent": 2.0, "hardness_pa": 1.5e9}
SPEEDS = {"velocity_exponent": 2.3, "reference_velocity_m_per_s": 4.0}


def oka_of(angle, speed=4.0, mass=2.0):
    """Energy of an impact at an angle (rad) in the law of Oka, J."""
    motion = at_angle(angle, speed)
    motion.normal, motion.mass, motion.approach_speed = UP, np.array([mass]), np.array([speed * np.sin(angle)])
    return oka_energy(None, motion, None, **OKA, **SPEEDS)[0]


def test_a_square_impact_is_the_reference_of_oka():
    """At 90 degrees and V it is m V^2 / 2, grazing nothing; with the speed it grows by (v / V)^k2 (Oka et al. 2005)."""
    assert oka_of(np.pi / 2.0) == pytest.approx(0.5 * 2.0 * 4.0**2, rel=ROUND_OFF)
    assert oka_of(0.0) == 0.0
    assert oka_of(0.6, speed=6.0) == pytest.approx(1.5**2.3 * oka_of(0.6), rel=ROUND_OFF)


def test_oka_is_worst_where_its_closed_form_says():
    """d ln g / d sin a = n1 / sin a - n2 H / (1 + H (1 - sin a)) = 0: sin a = n1 (1 + H) / (H (n1 + n2))."""
    n1, n2, hardness = OKA["angle_exponent"], OKA["hardness_exponent"], 1e-9 * OKA["hardness_pa"]
    worst = np.arcsin(n1 * (1.0 + hardness) / (hardness * (n1 + n2)))
    angle_function = np.sin(worst) ** n1 * (1.0 + hardness * (1.0 - np.sin(worst))) ** n2
    assert oka_of(worst) == pytest.approx(16.0 * angle_function, rel=ROUND_OFF)
    assert max(oka_of(worst - 0.05), oka_of(worst + 0.05), oka_of(np.pi / 2.0)) < oka_of(worst)


def test_units_are_neutral():
    """Speed times force: mm, ms and kN give the same power in their unit."""
    small = finnie_work(contact(), at_angle(0.2, 2.0), UP)
    large = finnie_work(contact(force=FORCE * 1e-3), at_angle(0.2, 2.0 * 1e3), UP)
    np.testing.assert_allclose(small, large, rtol=ROUND_OFF)


def test_every_kernel_has_a_column_and_takes_no_contacts():
    """Names carry the unit; an empty sample gives an empty array."""
    vectors = ("contact_point", "centre", "force", "particle_velocity", "wall_velocity", "angular_velocity")
    nothing = SimpleNamespace(radius=np.zeros(0), **{name: np.zeros((0, 3)) for name in vectors})
    for name, kernel in KERNELS.items():
        assert kernel_column(name) == f"{name}_{kernel.unit}"
        value = kernel_value(name, dict.fromkeys(kernel.parameters, 1.0))
        motion = SimpleNamespace(**vars(contact_kinematics(nothing)), mass=np.zeros(0))
        assert value(nothing, motion, np.zeros((0, 3))).shape == (0,)


def test_the_solver_has_the_same_kernels():
    """Names, columns and parameters of solver/kernels.h are those of the registry: either producer serves a law."""
    source = (REPOSITORY / "solver" / "kernels.h").read_text()
    listed = re.search(r"KERNELS\[\] = \{(.*?)^\};", source, re.DOTALL | re.MULTILINE)[1]
    found = {
        name: (column, tuple(re.findall(r'"(\w+)"', parameters)))
        for name, column, parameters in re.findall(r'\{"(\w+)",\s*"(\w+)",\s*\w+,\s*\{(.*?)\}', listed, re.DOTALL)
    }
    assert found == {name: (kernel_column(name), kernel.parameters) for name, kernel in KERNELS.items()}


def test_an_unknown_kernel_is_named():
    """With those that there are."""
    with pytest.raises(ValueError, match=r"contact kernel 'oka_work' is unknown, allowed are: finnie_work"):
        LedgerBuilder(4, 0, 2e8, 2500.0, kernels={"oka_work": {}}, corners=np.zeros((4, 3, 3)))


@pytest.mark.parametrize(
    ("name", "given", "found", "allowed"),
    [
        ("finnie_work", {"exponent": 2.0}, "exponent", "nothing"),
        ("long_slip", {}, "nothing", "exponent, length_m"),
        ("long_slip", {"exponent": 2.0, "length_mm": 2.0}, "exponent, length_mm", "exponent, length_m"),
    ],
)
def test_a_kernel_takes_exactly_its_parameters(name, given, found, allowed):
    """One that is missing and one that it does not know are refused with those that it takes."""
    sentence = f"parameters of the contact kernel '{name}' are {found}, allowed are: {allowed}$"
    with long_slip_registered(), pytest.raises(ValueError, match=sentence):
        LedgerBuilder(4, 0, 2e8, 2500.0, kernels={name: given}, corners=np.zeros((4, 3, 3)))


@pytest.mark.parametrize("corners", [None, np.zeros((3, 3, 3))])
def test_kernels_without_facets_are_refused(corners):
    """The corners of every triangle, or the angle of impact is unknown."""
    with pytest.raises(ValueError, match=r"corners of the facets have the shape .*, allowed is \(4, 3, 3\)"):
        LedgerBuilder(4, 0, 2e8, 2500.0, kernels={"finnie_work": {}}, corners=corners)
