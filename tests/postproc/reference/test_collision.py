"""Closed form of a collision: energy, restitution at any speed, no size, and the equation itself."""

import math

import numpy as np
import pytest

from bulkwear.postproc.reference.collision import DURATION, collision, damping_ratio, largest_overlap, reduced

BODIES = {"radius": 6e-4, "mass": 1.2e-5, "modulus": 9e7}  # m, kg, Pa: grains of gravel
EXACT = 1e-8  # relative, of the integration
SAMPLED = 1e-4  # relative: a largest value among 400 points
DIFFERENCE = 1e-4  # relative, of central differences on these points


def test_reduced_of_a_wall_is_the_sphere():
    """Two equal spheres have half of one; against a wall it is the sphere's own."""
    assert reduced(2.0, 2.0) == 1.0
    assert reduced(2.0, math.inf) == 2.0


def test_without_damping_energy_is_kept():
    """e = 1: the spring takes m v^2 / 2 at the largest overlap, and the collision lasts 2.943 overlap / speed."""
    overlap = largest_overlap(1.0, **BODIES)
    stored = 8.0 / 15.0 * BODIES["modulus"] * math.sqrt(BODIES["radius"]) * overlap**2.5
    assert stored == pytest.approx(0.5 * BODIES["mass"], rel=EXACT)
    elastic = collision(1.0, **BODIES, restitution=1.0)
    assert elastic.restitution == pytest.approx(1.0, rel=EXACT)
    assert elastic.overlap.max() == pytest.approx(overlap, rel=SAMPLED)
    assert elastic.time[-1] == pytest.approx(DURATION * overlap, rel=1e-3)


@pytest.mark.parametrize("restitution", [0.1, 0.45, 0.9])
@pytest.mark.parametrize("speed", [0.01, 1.0])
def test_restitution_is_that_asked_for_at_any_speed(restitution, speed):
    """What the viscoelastic law was made for."""
    assert collision(speed, **BODIES, restitution=restitution).restitution == pytest.approx(restitution, rel=EXACT)


def test_the_force_is_the_law_and_moves_the_mass():
    """Force: spring and damping as the solver writes them; its impulse turns the velocity."""
    found = collision(1.0, **BODIES, restitution=0.45, points=4000)
    place = found.overlap.clip(0.0)
    stiffness = 2.0 * BODIES["modulus"] * np.sqrt(BODIES["radius"] * place)
    spring = 2.0 / 3.0 * stiffness * place
    damper = 2.0 * math.sqrt(5.0 / 6.0) * damping_ratio(0.45) * np.sqrt(stiffness * BODIES["mass"]) * found.approach
    assert np.abs(spring + damper - found.force).max() < EXACT * found.force.max()
    slowing = -np.gradient(found.approach, found.time)[5:-5] * BODIES["mass"]  # the damping starts with infinite slope
    assert np.abs(slowing - found.force[5:-5]).max() < 10.0 * DIFFERENCE * found.force.max()


def test_size_drops_out():
    """Radius times s and mass times s^3 at the same speed and modulus: overlap and time times s, force times s^2."""
    one = collision(1.0, 6e-4, 1.2e-5, 9e7, 0.45)
    eight = collision(1.0, 8 * 6e-4, 8**3 * 1.2e-5, 9e7, 0.45)
    for name, power in (("time", 1), ("overlap", 1), ("approach", 0), ("force", 2)):
        assert np.allclose(getattr(eight, name), 8.0**power * getattr(one, name), rtol=EXACT, atol=1e-30), name
