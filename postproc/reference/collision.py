"""Normal collision of two spheres, or of a sphere and a wall: Hertz' spring with the solver's viscoelastic damping.

m* x'' = -4/3 E* sqrt(R*) x^(3/2) - 2 sqrt(5/6) beta sqrt(S m*) x', S = 2 E* sqrt(R* x), beta = -ln e / sqrt(ln^2 e +
pi^2). With this damping the ratio of the velocities after and before is e whatever the speed (Antypov and Elliott, EPL
94 (2011) 50004), and in x/R, t sqrt(E*/rho)/R the equation knows no size (Yan 2022, Eq 4.6 and 4.7).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

EXACT = 1e-10  # relative, of the integration
DURATION = 2.943  # -, of an undamped collision over largest overlap / speed (Hertz 1882)
LONGEST = 4.0  # -, times that; a collision of e = 0.05 lasts 1.7 times as long as an undamped one


@dataclass(frozen=True)
class Collision:
    """A collision from first touch to separation: arrays (k,) of time (s), overlap (m), approach (m/s), force (N).

    The force repels; just before separation the damping outweighs the spring and it is negative.
    """

    time: np.ndarray
    overlap: np.ndarray
    approach: np.ndarray
    force: np.ndarray

    @property
    def restitution(self) -> float:
        """Return velocity after over velocity before (-)."""
        return float(-self.approach[-1] / self.approach[0])


def reduced(first: float, second: float) -> float:
    """Return first second / (first + second), of radii or masses (Yan 2022, Eq 4.4 and 4.5); a wall's is infinite."""
    return first if math.isinf(second) else first * second / (first + second)


def damping_ratio(restitution: float) -> float:
    """Return beta (-) of a coefficient of restitution: 0 for 1, positive below."""
    logarithm = -math.log(restitution)
    return logarithm / math.hypot(logarithm, math.pi)


def largest_overlap(speed: float, radius: float, mass: float, modulus: float) -> float:
    """Return the largest overlap (m) without damping: all of m* v^2 / 2 is in the spring (Hertz 1882)."""
    return (15.0 * mass * speed**2 / (16.0 * modulus * math.sqrt(radius))) ** 0.4


def collision(
    speed: float, radius: float, mass: float, modulus: float, restitution: float, points: int = 400
) -> Collision:
    """Return the collision at a speed (m/s) of bodies with reduced radius (m) and mass (kg), E* (Pa) and e (-)."""
    from scipy.integrate import solve_ivp  # slow to import, and every start of Snakemake reads pages that draw this

    overlap = largest_overlap(speed, radius, mass, modulus)
    time = overlap / speed  # with these units of length and time the equation has one parameter, beta
    # S = 1.5 F/x, and F is 5/4 in these units at x = 1
    damping = 2.0 * math.sqrt(5.0 / 6.0) * damping_ratio(restitution) * math.sqrt(1.875)

    def force(state: np.ndarray) -> np.ndarray:
        place = np.maximum(state[0], 0.0)
        return 1.25 * place**1.5 + damping * place**0.25 * state[1]

    def separated(_: float, state: np.ndarray) -> float:
        return state[0]

    separated.terminal, separated.direction = True, -1.0
    solved = solve_ivp(
        lambda _, state: np.array([state[1], -force(state)]),
        (0.0, LONGEST * DURATION),
        [0.0, 1.0],
        method="DOP853",
        events=separated,
        dense_output=True,
        rtol=EXACT,
        atol=EXACT,
    )
    when = np.linspace(0.0, solved.t[-1], points)
    states = solved.sol(when)
    return Collision(when * time, states[0] * overlap, states[1] * speed, force(states) * mass * speed / time)
