"""Straight lines through few points: their errors, and where two of them cross, with a confidence interval."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

CONFIDENCE = 0.95  # -, of intervals
FEWEST_POINTS = 3  # two leave no degree of freedom to the error


@dataclass(frozen=True)
class Line:
    """A least-squares line y = intercept + slope x and its scatter.

    center: mean of x; spread: sum of (x - center)^2; deviation: standard deviation of y about the line; points: number;
    r_squared: -, NaN where y does not vary
    """

    intercept: float
    slope: float
    deviation: float
    center: float
    spread: float
    points: int
    r_squared: float

    @property
    def freedom(self) -> int:
        """Return the degrees of freedom of the error."""
        return self.points - 2

    @property
    def slope_error(self) -> float:
        """Return the standard error of the slope."""
        return self.deviation / math.sqrt(self.spread)

    @property
    def intercept_error(self) -> float:
        """Return the standard error of the intercept."""
        return self.deviation * math.sqrt(1.0 / self.points + self.center**2 / self.spread)

    def at(self, x: np.ndarray | float) -> np.ndarray | float:
        """Return the line's value."""
        return self.intercept + self.slope * x

    def error_at(self, x: np.ndarray | float) -> np.ndarray | float:
        """Return the standard error of the line's value."""
        return self.deviation * np.sqrt(1.0 / self.points + (x - self.center) ** 2 / self.spread)


@dataclass(frozen=True)
class Crossing:
    """Where a line is zero, and its confidence interval, an end of which is infinite where the data exclude nothing.

    bounded: whether the slope differs from zero at all; without that there is no interval, but everything
    """

    value: float
    low: float
    high: float
    bounded: bool


def fitted_line(x: np.ndarray, y: np.ndarray) -> Line:
    """Return the least-squares line. Raises ValueError for fewer than three points or equal x."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if len(x) < FEWEST_POINTS or np.ptp(x) == 0.0:
        raise ValueError(
            f"a line needs {FEWEST_POINTS} points at places that differ, found {len(x)} at {len(np.unique(x))} places."
        )
    center, spread = x.mean(), ((x - x.mean()) ** 2).sum()
    slope = ((x - center) * (y - y.mean())).sum() / spread
    intercept = y.mean() - slope * center
    left = ((y - intercept - slope * x) ** 2).sum()
    whole = ((y - y.mean()) ** 2).sum()
    return Line(
        intercept=float(intercept),
        slope=float(slope),
        deviation=math.sqrt(left / (len(x) - 2)),
        center=float(center),
        spread=float(spread),
        points=len(x),
        r_squared=float(1.0 - left / whole) if whole > 0.0 else math.nan,
    )


def zero_of(line: Line, confidence: float = CONFIDENCE) -> Crossing:
    """Return where a line is zero with Fieller's interval: all x at which zero is within the error of the line.

    (E. C. Fieller, Journal of the Royal Statistical Society B 16 (1954) 175-185.) Exact for normal errors, unlike the
    delta method, which is symmetric and too short where the slope is poorly known. Where the slope may be zero the
    interval is the whole axis, or all of it but a gap, and counts as unbounded.
    """
    value = -line.intercept / line.slope if line.slope else math.nan
    allowed = float(stats.t.ppf(0.5 + 0.5 * confidence, line.freedom)) * line.deviation
    # (y0 + b u)^2 <= allowed^2 (1/n + u^2/S), u = x - center
    height = line.at(line.center)
    square = line.slope**2 - allowed**2 / line.spread
    if square <= 0.0:
        return Crossing(value, -math.inf, math.inf, False)
    half = line.slope * height / square
    root = math.sqrt(max(half**2 - (height**2 - allowed**2 / line.points) / square, 0.0))
    return Crossing(value, line.center - half - root, line.center - half + root, True)


def crossing(x: np.ndarray, first: np.ndarray, second: np.ndarray, confidence: float = CONFIDENCE) -> Crossing:
    """Return where the lines through two series over the same x cross, from the line through their differences.

    Pairs that share what scatters (a packing) have less scatter in their difference; nothing else is assumed of it.
    """
    return zero_of(fitted_line(x, np.asarray(first, dtype=float) - np.asarray(second, dtype=float)), confidence)
