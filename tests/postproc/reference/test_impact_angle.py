"""Angles of impact: laws against integrals, limits and their own kernels."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from bulkwear.postproc.reference.impact_angle import (
    EFFECT_OF_SPIN,
    angle_of_largest_wear,
    finnie,
    impact_energy,
    oka,
    sliding_work,
)
from bulkwear.postproc.wear.kernels import impact_above_threshold, oka_energy

FRICTION, RESTITUTION = 0.38, 0.6  # of steel under ore
OKA = {"angle_exponent": 0.744, "hardness_exponent": 1.749, "hardness_pa": 1.4e9}
STEPS = 20_000  # of the impulse
OF_STEPS = 2.0 / STEPS  # relative; a sum for an integral, by its end points
GRID = np.radians(0.05)  # rad, of the angles that are looked at
DEGREES = np.radians([5.0, 15.0, 30.0, 60.0, 85.0])


@pytest.mark.parametrize("angle", DEGREES)
@pytest.mark.parametrize("friction", [0.1, FRICTION, 1.0])
def test_sliding_work_is_the_integral_over_the_normal_impulse(angle, friction):
    """Of |v_t| at the contact point, which friction takes away step by step, until it sticks."""
    impulse = np.linspace(0.0, (1.0 + RESTITUTION) * np.sin(angle), STEPS + 1)
    slip = np.maximum(np.cos(angle) - EFFECT_OF_SPIN * friction * impulse, 0.0)
    found = sliding_work(np.array([angle]), friction, RESTITUTION)[0]
    assert found == pytest.approx(np.trapezoid(slip, impulse), rel=OF_STEPS)


def test_friction_takes_no_more_than_it_can():
    """Sticking spheres have lost 2/7 of their tangential energy; neither square nor grazing impacts slide."""
    sticking = np.radians(80.0)
    lost = FRICTION * sliding_work(np.array([sticking]), FRICTION, RESTITUTION)[0]
    assert lost == pytest.approx(2.0 / 7.0 * 0.5 * np.cos(sticking) ** 2, rel=1e-12)
    assert sliding_work(np.array([0.0, np.pi / 2.0]), FRICTION, RESTITUTION) == pytest.approx([0.0, 0.0], abs=1e-30)


def test_angles_of_largest_wear_are_the_roots_of_the_derivatives():
    """tan 2a = 1 / (1.75 mu (1 + e)) of Archard, 2/3 of Finnie; sin a = n1 (1 + H) / (H (n1 + n2)) of Oka."""
    n1, n2, hardness = OKA["angle_exponent"], OKA["hardness_exponent"], 1e-9 * OKA["hardness_pa"]
    expected = {
        0.5 * np.arctan(1.0 / (1.75 * FRICTION * (1.0 + RESTITUTION))): lambda a: sliding_work(
            a, FRICTION, RESTITUTION
        ),
        0.5 * np.arctan(2.0 / 3.0): finnie,
        np.arcsin(n1 * (1.0 + hardness) / (hardness * (n1 + n2))): partial(oka, **OKA),
        np.pi / 2.0: impact_energy,
    }
    for angle, law in expected.items():
        assert angle_of_largest_wear(law) == pytest.approx(angle, abs=GRID)


def test_laws_of_impacts_are_those_of_the_kernels():
    """Oka's and Bitter's functions of the angle are what the ledger sums per impact, over m V^2."""
    speed, mass = 8.0, 2e-3
    across = np.stack([np.cos(DEGREES), np.zeros_like(DEGREES), -np.sin(DEGREES)], axis=1) * speed
    motion = SimpleNamespace(
        mass=np.full(len(DEGREES), mass),
        approach_speed=speed * np.sin(DEGREES),
        relative_velocity=across,
        normal=np.tile([0.0, 0.0, 1.0], (len(DEGREES), 1)),
    )
    energy = oka_energy(None, motion, motion.normal, **OKA, velocity_exponent=2.0, reference_velocity_m_per_s=1.0)
    np.testing.assert_allclose(energy / (0.5 * mass * speed**2), oka(DEGREES, **OKA), rtol=1e-12)
    above = impact_above_threshold(None, motion, motion.normal, 0.25 * speed)
    np.testing.assert_allclose(above / (mass * speed**2), impact_energy(DEGREES, 0.25), rtol=1e-12)


def test_finnie_is_even_where_its_branches_meet():
    """At tan a = 1/3 both are 0.3; a square impact wears nothing."""
    meet = np.arctan(1.0 / 3.0)
    assert finnie(np.array([meet - 1e-9, meet + 1e-9])) == pytest.approx([0.3, 0.3], abs=1e-8)
    assert finnie(np.array([np.pi / 2.0]))[0] == pytest.approx(0.0, abs=1e-30)
