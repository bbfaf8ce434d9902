"""What the size of particles lets expect of a convex pattern, and how far a study of it may be coarse-grained."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

import numpy as np
import pandas as pd

from bulkwear.postproc.reference.size_ratios import (
    LARGEST_RATIO,
    PUBLISHED_DIAMETER,
    PUBLISHED_PATTERN,
    equivalent_size_ratio,
    largest_scale,
    published_largest_scale,
    size_ratios,
)


@dataclass(frozen=True)
class Pattern:
    """A pattern of semi-ellipsoids, m: radii, height, free width between neighbours of a row (negative: overlap)."""

    major_radius: float
    minor_radius: float
    height: float
    gap: float

    @property
    def bump(self) -> tuple[float, float, float]:
        """Return a, b, h (m)."""
        return self.major_radius, self.minor_radius, self.height


@dataclass(frozen=True)
class Particles:
    """A size distribution at its real size: median and diameters (m), and their shares of the mass (-)."""

    median_diameter: float
    diameters: Sequence[float]
    mass_fractions: Sequence[float]


def guidance(pattern: Pattern, particles: Particles) -> dict[str, float | bool]:
    """Return what the sizes of real particles and bumps let expect; keys below, all without unit.

    equivalent_radius, projected_area, surface_area, volume: particle over bump (Yan 2022, Eq 4.18 to 4.21)
    helps: whether the pattern is expected to reduce sliding wear: equivalent_radius below 1
    larger_share: of the mass, particles that are larger than the bump by their own equivalent_radius
    gap_over_diameter: free width between neighbouring bumps over the median diameter; below 1 none fits between
    largest_scale: particle scale at which equivalent_radius reaches 1
    published_largest_scale: the one at which it is that of the source's critical scale, 4
    """
    ratios = size_ratios(particles.median_diameter, *pattern.bump)
    own = [equivalent_size_ratio(diameter, *pattern.bump) for diameter in particles.diameters]
    return {
        **asdict(ratios),
        "helps": ratios.equivalent_radius < LARGEST_RATIO,
        "larger_share": float(np.sum(np.asarray(particles.mass_fractions)[np.asarray(own) >= LARGEST_RATIO])),
        "gap_over_diameter": pattern.gap / particles.median_diameter,
        "largest_scale": largest_scale(particles.median_diameter, *pattern.bump),
        "published_largest_scale": published_largest_scale(particles.median_diameter, *pattern.bump),
    }


def published_bias(pattern: Pattern, particles: Particles, scale: float, lines: pd.DataFrame) -> float:
    """Return how many times the convex sample's wear at real size it is at a particle scale, by the published line.

    lines: curve, intercept and slope, as in config/published/particle_size_lines.csv (Yan 2022, Eq 4.15), of the
    source's pattern; it is taken to hold for others at the same alpha_ER. NaN where the line is not above zero, which
    it is only from 0.3 times the source's own particles on.
    """
    line = lines.set_index("curve").loc["convex"]
    unit = equivalent_size_ratio(PUBLISHED_DIAMETER, *PUBLISHED_PATTERN)
    real = equivalent_size_ratio(particles.median_diameter, *pattern.bump) / unit
    at_real, at_scale = (line["intercept"] + line["slope"] * place for place in (real, scale * real))
    return float(at_scale / at_real) if at_real > 0.0 else float("nan")


def guidance_table(
    patterns: Mapping[str, Pattern], particles: Particles | None, scales: Mapping[str, float], lines: pd.DataFrame
) -> pd.DataFrame:
    """Return a row of guidance per pattern, with the particle scale that a study simulates it at.

    patterns, scales: by design row of a sample with bumps. Columns row, major_radius_m, minor_radius_m and height_m of
    the bump, median_diameter_m of real particles, those of `guidance`, particle_scale, within_largest_scale, and
    published_bias of that scale.
    """
    rows = [
        {
            "row": row,
            **dict(zip(("major_radius_m", "minor_radius_m", "height_m"), pattern.bump, strict=True)),
            "median_diameter_m": particles.median_diameter,
            **(told := guidance(pattern, particles)),
            "particle_scale": scales[row],
            "within_largest_scale": scales[row] < told["largest_scale"],
            "published_bias": published_bias(pattern, particles, scales[row], lines),
        }
        for row, pattern in patterns.items()
    ]
    return pd.DataFrame(rows) if rows else pd.DataFrame(columns=["row", "equivalent_radius"])
