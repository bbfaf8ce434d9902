"""How wear laws depend on the angle at which single particles hit a plane wall, in closed form.

A sphere without spin hits a rigid, plane wall at the angle a between its path and the wall, with the speed V; m is its
mass, e the normal coefficient of restitution, mu the coefficient of friction. Volumes are per impact and coefficient.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

EFFECT_OF_SPIN = 3.5  # -, 1 + m R2 / I of a solid sphere: friction slows the contact point so much more than the centre
ANGLES = np.radians(np.linspace(0.05, 90.0, 1800))  # rad, among which the angle of largest wear is looked for


def sliding_work(angle: np.ndarray, friction: float, restitution: float) -> np.ndarray:
    """Return Archard's work, the integral of F_n |v_t| dt, of an impact over m V^2 (-).

    With the normal impulse J = m V (1 + e) sin a the contact point slides until J mu 3.5 / m has taken V cos a; then it
    sticks. So the work is (1 + e) sin a (cos a - 1.75 mu (1 + e) sin a), and where it comes to stick, cos^2 a / (7 mu).
    The work of friction is mu times this. Source: W. Goldsmith, Impact (1960), chapter 2; rigid bodies, Coulomb.

    angle: rad
    """
    sine, cosine = np.sin(angle), np.cos(angle)
    normal = (1.0 + restitution) * sine
    sticks = EFFECT_OF_SPIN * friction * normal > cosine
    slid = normal * (cosine - 0.5 * EFFECT_OF_SPIN * friction * normal)
    return np.where(sticks, cosine**2 / (2.0 * EFFECT_OF_SPIN * friction), slid)


def impact_energy(angle: np.ndarray, threshold: float = 0.0) -> np.ndarray:
    """Return Bitter's (sin a - K / V)^2 / 2, 0 below the threshold, over m V^2 (-). threshold: K / V (-)

    Source: J. G. A. Bitter, Wear 6 (1963) 5.
    """
    return 0.5 * np.maximum(np.sin(angle) - threshold, 0.0) ** 2


def finnie(angle: np.ndarray) -> np.ndarray:
    """Return Finnie's E(a) = sin 2a - 3 sin^2 a, cos^2 a / 3 where tan a is above 1/3 (-): of the angle of incidence.

    Source: I. Finnie, Wear 3 (1960) 87. The solver's measure goes by the angle at every instant of the contact instead.
    """
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.where(3.0 * sine > cosine, cosine**2 / 3.0, 2.0 * sine * cosine - 3.0 * sine**2)


def oka(angle: np.ndarray, angle_exponent: float, hardness_exponent: float, hardness_pa: float) -> np.ndarray:
    """Return Oka's g(a) = sin^n1 a (1 + H (1 - sin a))^n2 (-), 1 at 90 degrees. hardness_pa: H, Pa, taken in GPa

    Source: Y. I. Oka, K. Okamura, T. Yoshida, Wear 259 (2005) 95.
    """
    sine = np.sin(angle)
    return sine**angle_exponent * (1.0 + 1e-9 * hardness_pa * (1.0 - sine)) ** hardness_exponent


def angle_of_largest_wear(law: Callable[[np.ndarray], np.ndarray]) -> float:
    """Return the angle (rad) at which a law of the angle wears most, to a twentieth of a degree."""
    return float(ANGLES[np.argmax(law(ANGLES))])
