"""What the size of particles lets expect of a convex pattern, and how far a study of it may be coarse-grained."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.reference.size_ratios import (
    LARGEST_RATIO,
    PUBLISHED_DIAMETER,
    PUBLISHED_PATTERN,
    equivalent_size_ratio,
    largest_scale,
    published_largest_scale,
    size_ratios,
)
from bulkwear.postproc.statistics.crossing import FEWEST_PLACES, REJECTED, lack_of_fit
from bulkwear.postproc.statistics.intervals import CONFIDENCE, Estimate, difference, estimate, students_t
from bulkwear.workflows.report.published import GIVEN

PUBLISHED_SCALES = np.arange(1.0, 9.0)  # of the source's lines (Yan 2022, Table 4.1 and Fig 4.14)
ROUNDING = 1e-9  # relative


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


def simulated(
    rows: Mapping[str, Mapping[str, Any]],
) -> tuple[dict[str, Pattern], Particles | None, dict[str, float]]:
    """Return patterns, real particles and particle scales of design rows, as from `study.bumps_and_particles`."""
    patterns = {row: Pattern(**given["pattern"]) for row, given in rows.items()}
    real = next((Particles(**given["particles"]) for given in rows.values()), None)
    return patterns, real, {row: given["scale"] for row, given in rows.items()}


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


@dataclass(frozen=True)
class Line:
    """A straight line of wear against particle scale: intercept and slope, their covariance (2, 2), its degrees of
    freedom, and the scales (least, largest) that it is of.
    """

    coefficients: np.ndarray
    covariance: np.ndarray
    freedom: int
    scales: tuple[float, float]


def published_line(lines: pd.DataFrame) -> Line:
    """Return the source's line of the convex sample, Eq 4.15; its scatter is what the printed R2 leaves at its scales.

    lines: curve, intercept, slope and r_squared, as in config/published/particle_size_lines.csv
    """
    line = lines.set_index("curve").loc["convex"]
    matrix = np.column_stack([np.ones(len(PUBLISHED_SCALES)), PUBLISHED_SCALES])
    explained = line["slope"] ** 2 * ((PUBLISHED_SCALES - PUBLISHED_SCALES.mean()) ** 2).sum()
    freedom = len(PUBLISHED_SCALES) - 2
    variance = explained * (1.0 / line["r_squared"] - 1.0) / freedom
    coefficients = line[["intercept", "slope"]].to_numpy(dtype=float)
    covariance = variance * np.linalg.inv(matrix.T @ matrix)
    return Line(coefficients, covariance, freedom, (PUBLISHED_SCALES.min(), PUBLISHED_SCALES.max()))


def published_at_scales(wear: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Return the source's lines at the least and the largest of our scales that they are of, beside our means there.
    The finest plain sample, over which all wear is told, is given.

    wear: as from `wear_by_scale`; published: as for `published_line`. Columns as `report.published` reads values.
    Intervals hold the scatter of the finest plain sample too, see `_over_finest_plain`.
    """
    ours = wear[wear["particle_scale"].between(PUBLISHED_SCALES.min(), PUBLISHED_SCALES.max())]
    of_itself, rows = (PLAIN, wear["particle_scale"].min()), []  # 1 whatever was found
    for line in published.to_dict("records"):
        of_curve = ours[ours["curve"] == line["curve"]]
        for scale in np.unique(of_curve["particle_scale"].agg(["min", "max"]).dropna()):
            found = _over_finest_plain(wear, of_curve[of_curve["particle_scale"] == scale])
            low, high = found.interval()
            rows.append(
                {
                    "quantity": "wear over that of the finest plain sample",
                    "setting": f"{line['curve']} at scale {scale:g}",
                    "unit": "-",
                    "published_value": line["intercept"] + line["slope"] * scale,
                    **{"computed_value": found.value, "computed_low": low, "computed_high": high},
                    **{"packings": found.packings, "source": line["source"]},
                    **{GIVEN: "yes" if (line["curve"], scale) == of_itself else ""},
                }
            )
    return pd.DataFrame(rows)


def _over_finest_plain(wear: pd.DataFrame, own: pd.DataFrame) -> Estimate:
    """Return the wear of a curve at one scale over that of the finest plain sample, both over packings.

    At the scale of that sample a packing is one bed of both, and ratios are taken bed by bed; at others beds share
    nothing. wear: as from `wear_by_scale`; own: rows of it
    """
    plain = wear[wear["curve"] == PLAIN]
    finest = plain[plain["particle_scale"] == plain["particle_scale"].min()].set_index("row")["relative_wear"]
    worn = own.set_index("row")["relative_wear"]
    if set(worn.index) <= set(finest.index):
        return estimate((worn / finest.reindex(worn.index)).to_numpy(), log=True)
    return difference(estimate(worn.to_numpy(), log=True), estimate(finest.to_numpy(), log=True))


def own_line(scale: np.ndarray, wear: np.ndarray) -> Line | None:
    """Return the least-squares line of a study's patterned samples, (k,) of each run.

    None of fewer than 3 scales, and where the scatter of packings rejects a line: carried on to another scale it would
    then tell nothing.
    """
    places = np.unique(scale)
    if len(places) < FEWEST_PLACES:
        return None
    matrix = np.column_stack([np.ones(len(scale)), scale])
    coefficients, *_ = np.linalg.lstsq(matrix, wear, rcond=None)
    if lack_of_fit(scale, wear, matrix @ coefficients, 2)["p_value"] < REJECTED:
        return None
    freedom = len(scale) - 2
    variance = ((wear - matrix @ coefficients) ** 2).sum() / freedom
    return Line(coefficients, variance * np.linalg.inv(matrix.T @ matrix), freedom, (places[0], places[-1]))


def line_ratio(line: Line, place: float, reference: float) -> tuple[float, float, float]:
    """Return a line's value at one scale over that at another, with its 95 % interval (Fieller 1954).

    NaN where the line is not above zero at the reference; ends are NaN where it cannot be told from zero there.
    """
    over = np.array([[1.0, place], [1.0, reference]])
    (top, bottom), spread = over @ line.coefficients, over @ line.covariance @ over.T
    if bottom <= 0.0:
        return np.nan, np.nan, np.nan
    if place == reference:
        return 1.0, 1.0, 1.0
    spread = spread * students_t(0.5 + 0.5 * CONFIDENCE, line.freedom) ** 2
    square, middle = bottom**2 - spread[1, 1], top * bottom - spread[0, 1]
    root = middle**2 - square * (top**2 - spread[0, 0])
    if square <= 0.0:
        return top / bottom, np.nan, np.nan
    low, high = ((middle + sign * np.sqrt(root)) / square for sign in (-1.0, 1.0))
    return float(top / bottom), float(low), float(high)


def published_bias(
    pattern: Pattern, particles: Particles, scale: float, lines: pd.DataFrame
) -> tuple[float, float, float]:
    """Return how many times the convex sample's wear at real size it is at a particle scale, by the source's line.

    With its 95 % interval, which is wide: the line is small at real size, and that is what everything is divided by.
    It tells of the source's simulations, not of these, whose own line differs. It is taken to hold for other patterns
    at the same alpha_ER, and is not extended: NaN outside its scales. lines: as for `published_line`
    """
    unit = equivalent_size_ratio(PUBLISHED_DIAMETER, *PUBLISHED_PATTERN)
    real = equivalent_size_ratio(particles.median_diameter, *pattern.bump) / unit
    line = published_line(lines)
    least, largest = line.scales
    if real < least * (1.0 - ROUNDING) or scale * real > largest * (1.0 + ROUNDING):
        return np.nan, np.nan, np.nan
    return line_ratio(line, scale * real, real)


def guidance_table(
    patterns: Mapping[str, Pattern],
    particles: Particles | None,
    scales: Mapping[str, float],
    lines: pd.DataFrame,
    wear: pd.DataFrame,
) -> pd.DataFrame:
    """Return a row of guidance per pattern, with the particle scale that a study simulates it at.

    patterns, scales: by design row of a sample with bumps; lines: as for `published_line`; wear: particle_scale and
    relative_wear of every patterned run of the study
    Columns row, major_radius_m, minor_radius_m and height_m of the bump, median_diameter_m of real particles, those of
    `guidance`, particle_scale, within_largest_scale, and two ratios with 95 % intervals: own_bias, own_bias_low and
    own_bias_high, wear at that scale over that at own_line_from_scale, the study's smallest, by its own line, which is
    not extended; published_bias, published_bias_low and published_bias_high, over that at real size, by the source's.
    """
    own = own_line(wear["particle_scale"].to_numpy(dtype=float), wear["relative_wear"].to_numpy(dtype=float))
    rows = [
        {
            "row": row,
            **dict(zip(("major_radius_m", "minor_radius_m", "height_m"), pattern.bump, strict=True)),
            "median_diameter_m": particles.median_diameter,
            **(told := guidance(pattern, particles)),
            "particle_scale": scales[row],
            "within_largest_scale": scales[row] < told["largest_scale"],
            **_named("own_bias", line_ratio(own, scales[row], own.scales[0]) if own else (np.nan,) * 3),
            "own_line_from_scale": own.scales[0] if own else np.nan,
            **_named("published_bias", published_bias(pattern, particles, scales[row], lines)),
        }
        for row, pattern in patterns.items()
    ]
    return pd.DataFrame(rows) if rows else pd.DataFrame(columns=["row", "equivalent_radius"])


def _named(name: str, told: tuple[float, float, float]) -> dict[str, float]:
    return dict(zip((name, f"{name}_low", f"{name}_high"), told, strict=True))
