"""Particles against the bumps of a convex pattern: four ratios of size, and how far particles may be coarse-grained.

A bump is a semi-ellipsoid with radii a, b and height h, volume 2/3 pi a b h (Yan 2022, section 4.5.2). Lengths in m.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

# -, alpha_ER above which the pattern no longer reduces wear (Yan 2022, section 4.5.2 and Fig 4.17)
LARGEST_RATIO = 1.0
# -, particle scale at which convex and plain samples wear alike, of the pattern below (Yan 2022, section 4.5.2)
PUBLISHED_CRITICAL_SCALE = 4.0
PUBLISHED_PATTERN = (4e-3, 8e-3, 6e-3)  # m, a, b, h of run R5 (Yan 2022, Table 3.8)
PUBLISHED_DIAMETER = 2.65e-3  # m, d50 at scale 1


@dataclass(frozen=True)
class SizeRatios:
    """Particle over bump (-): radius of the sphere of the bump's volume, projected area, surface, volume."""

    equivalent_radius: float
    projected_area: float
    surface_area: float
    volume: float


def equivalent_size_ratio(median_diameter: float, major_radius: float, minor_radius: float, height: float) -> float:
    """Return alpha_ER = R50 / cbrt(a b h / 2), lengths in m: particle over the sphere of the bump's volume.

    Below 1 the pattern helps (Yan 2022, Eq 4.18 and Fig 4.17).
    """
    return 0.5 * median_diameter / math.cbrt(0.5 * major_radius * minor_radius * height)


def size_ratios(median_diameter: float, major_radius: float, minor_radius: float, height: float) -> SizeRatios:
    """Return all four ratios (Yan 2022, Eq 4.18 to 4.21), of the particle of median diameter.

    The bump's surface is taken as 2/3 pi (a b + a h + b h), which is exact for a hemisphere.
    """
    radius, (a, b, h) = 0.5 * median_diameter, (major_radius, minor_radius, height)
    return SizeRatios(
        equivalent_radius=equivalent_size_ratio(median_diameter, a, b, h),
        projected_area=radius**2 / (a * b),
        surface_area=6.0 * radius**2 / (a * b + a * h + b * h),
        volume=2.0 * radius**3 / (a * b * h),
    )


def largest_scale(real_diameter: float, major_radius: float, minor_radius: float, height: float) -> float:
    """Return the particle scale (-) from which on alpha_ER is above its limit; below 1 where it is for real particles.

    real_diameter: m, median of the particles at scale 1. A study with larger particles than that asks about another
    effect than the one it means to simulate: they ride over bumps that real ones flow between.
    """
    return LARGEST_RATIO / equivalent_size_ratio(real_diameter, major_radius, minor_radius, height)


def published_largest_scale(real_diameter: float, major_radius: float, minor_radius: float, height: float) -> float:
    """Return the scale (-) whose alpha_ER is that of the published critical scale, for any pattern and particle.

    Assumes that alpha_ER alone decides (Yan 2022, section 4.5.2). It is 1.16 times `largest_scale`: the source's
    critical scale of 4 is not where its ratio is 1, which is 3.5.
    """
    critical = PUBLISHED_CRITICAL_SCALE * equivalent_size_ratio(PUBLISHED_DIAMETER, *PUBLISHED_PATTERN)
    return critical / equivalent_size_ratio(real_diameter, major_radius, minor_radius, height)
