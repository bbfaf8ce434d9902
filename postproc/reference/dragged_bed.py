"""A bed that nothing but friction takes along: what a plain sample that passes under it can do at most.

Over a sample of length L that moves with v, every particle is pushed by mu g from the front edge on, as long as it is
slower than the sample. At the distance x from that edge it moves with u = v - sqrt(v^2 - 2 mu g x); the mean over the
sample is v - (v^3 - (v^2 - 2 mu g L)^(3/2)) / (3 mu g L). Newton's and Coulomb's laws; what lies before and beside the
sample only holds back.
"""

from __future__ import annotations

GRAVITY = 9.81  # m/s2


def largest_dragged_share(friction: float, length_m: float, speed_m_per_s: float) -> float:
    """Return the mean velocity of the bed over the sample, over the sample's (-).

    friction: -, of sample and particles, with the bed's weight on it and no more
    length_m: of the sample along its travel, m
    """
    push = 2.0 * friction * GRAVITY * length_m / speed_m_per_s**2  # -, over the square of the speed
    left = max(1.0 - push, 0.0)  # of the sample's speed squared, at its end; none where the bed has come to its speed
    return 1.0 - (1.0 - left**1.5) / (1.5 * push)
