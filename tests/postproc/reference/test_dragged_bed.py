"""A bed that friction alone takes along against its equation of motion, in steps."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from bulkwear.postproc.reference.dragged_bed import GRAVITY, largest_dragged_share

STEPS = 200_000
OF_STEPS = 1e-4  # relative, of the sum over so many steps


@pytest.mark.parametrize("friction, length, speed", [(0.38, 0.2, 2.0), (0.38, 0.2, 0.5), (0.05, 1.0, 3.0)])
def test_the_mean_over_the_sample_is_that_of_the_motion(friction, length, speed):
    """Particle by particle from the front edge to the end; at 0.5 m/s the bed comes to the sample's speed on it."""
    end = 2.0 * length / speed + speed / (friction * GRAVITY)  # s, after which all has left or is at rest on it
    time = np.linspace(0.0, end, STEPS)
    velocity = np.minimum(friction * GRAVITY * time, speed)
    place = cumulative_trapezoid(speed - velocity, time, initial=0.0)  # m, behind the front edge
    passed = np.interp(length, place, cumulative_trapezoid(velocity, place, initial=0.0))  # m2/s
    with_sample = max(length - place[-1], 0.0) * speed  # of those that have come to its speed
    found = largest_dragged_share(friction, length, speed)
    assert found == pytest.approx((passed + with_sample) / length / speed, rel=OF_STEPS)


def test_little_friction_gives_half_the_velocity_at_the_end():
    """mu g L / v at the sample's end where that is far below v, and half of it on average."""
    friction = 1e-4
    at_end = friction * GRAVITY * 0.2 / 2.0**2
    assert largest_dragged_share(friction, 0.2, 2.0) == pytest.approx(at_end / 2.0, rel=1e-3)
