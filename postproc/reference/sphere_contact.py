"""A loaded sphere on a mesh: overlap, reach, and the time step at which several contacts at once stay stable.

Contact law as in the solver: Hertz, F = 4/3 E* sqrt(R) overlap^(3/2), with the damping force 2 sqrt(5/6) beta
sqrt(S m) v, S = 2 E* sqrt(R overlap) the tangent stiffness, beta = -ln e / sqrt(ln^2 e + pi^2) (Antypov and Elliott,
EPL 94 (2011) 50004). A triangle knows nothing of its neighbours: a sphere in a groove of its own shape has dozens of
full contacts that share the load.
"""

from __future__ import annotations

import math

SAFE_FRACTION = 0.7  # -, of the stable step: room for half as many contacts again; at most 1.7 times the mean were seen


def effective_modulus(modulus: float, poissons_ratio: float, other_modulus: float, other_ratio: float) -> float:
    """E* (Pa) of two bodies, 1/E* = sum of (1 - nu^2) / E (Hertz 1882); Young's moduli in Pa."""
    return 1.0 / ((1.0 - poissons_ratio**2) / modulus + (1.0 - other_ratio**2) / other_modulus)


def hertz_overlap(load: float, radius: float, modulus: float) -> float:
    """Overlap (m) at which one contact with a flat carries `load` (N); radius (m), modulus E* (Pa) (Hertz 1882)."""
    return (0.75 * load / (modulus * math.sqrt(radius))) ** (2.0 / 3.0)


def touching_reach(radius: float, depth: float) -> float:
    """How far (m) from its axis, in plan, a sphere can touch what lies at most `depth` (m) above its lowest point.

    Half the chord of a segment of that height: sqrt(h (2 R - h)), R at most. The lowest point of a pin in a groove lies
    an overlap below the groove's deepest point.
    """
    height = min(depth, radius)
    return math.sqrt(height * (2.0 * radius - height))


def stable_time_step(
    load: float, radius: float, modulus: float, mass: float, restitution: float, contacts: float = 1.0
) -> float:
    """Time step (s) above which a sphere that rests on `contacts` contacts at once starts to swing by itself.

    load : N, that they share evenly; radius : m; modulus : E*, Pa; mass : kg, of the sphere
    restitution : -, between 0 and 1; contacts : >= 1, a mean number

    n contacts share the load at overlaps n^(-2/3) times that of one. Together they are n^(2/3) times as stiff, and each
    adds its damping, so the damping ratio is n^(1/2) times that of one, z = sqrt(5 n / 6) beta. The solver's damping
    sees velocities of half a step before; central differences with such a damping are stable below
    2 (sqrt(1 + z^2) - z) / w, w^2 the stiffness of all over m (Belytschko et al., Nonlinear Finite Elements, ch. 6).
    Raises ValueError for arguments outside these ranges.
    """
    for name, value in (("load", load), ("radius", radius), ("modulus", modulus), ("mass", mass)):
        if not value > 0.0:
            raise ValueError(f"{name} of a contact must be greater than 0, found {value}")
    if not (0.0 < restitution <= 1.0 and contacts >= 1.0):
        raise ValueError(f"a contact needs 0 < restitution <= 1 and contacts >= 1, found {restitution} and {contacts}")
    stiffness = 1.5 * load / hertz_overlap(load, radius, modulus) * contacts ** (2.0 / 3.0)
    logarithm = -math.log(restitution)
    damping_ratio = math.sqrt(5.0 / 6.0 * contacts) * logarithm / math.hypot(logarithm, math.pi)
    return 2.0 * math.sqrt(mass / stiffness) * (math.hypot(1.0, damping_ratio) - damping_ratio)


def safe_time_step(
    largest: float, contacts: float, load: float, radius: float, modulus: float, mass: float, restitution: float
) -> float:
    """Time step (s) for a loaded sphere: `largest` (s), or SAFE_FRACTION of what that many contacts allow, if less.

    contacts : mean number of contacts at once so far (total contact time over duration); below 1 counts as 1
    The rest as in `stable_time_step`.
    """
    stable = stable_time_step(load, radius, modulus, mass, restitution, max(contacts, 1.0))
    return min(largest, SAFE_FRACTION * stable)
