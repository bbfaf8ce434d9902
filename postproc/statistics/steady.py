"""Where a run is steady: from which place of the travel on its measures only fluctuate."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

FEWEST_VALUES = 6  # in a series: fewer show neither a transient nor a fluctuation
LARGEST_START = 0.5  # -, of the series: what is cut off as transient
LARGEST_DRIFT = 0.05  # -, of the mean: what a steady window may rise or fall from its start to its end
SURE = 2.0  # standard errors: a drift below is not told from fluctuation


@dataclass(frozen=True)
class Window:
    """A window of travel and what a measure does in it.

    start, end: of the travel; mean, deviation: of the measure, in its unit
    drift: -, rise of its straight line from start to end over the mean
    values: how many there are; steady: whether the criterion holds
    """

    start: float
    end: float
    mean: float
    deviation: float
    drift: float
    values: int
    steady: bool


def steady_window(travel: np.ndarray, measure: np.ndarray) -> Window:
    """Return the steady window of a series, from where its transient has passed to its end.

    The start is the one that makes the mean of the rest surest: the least of the variance of the rest over its number,
    among the first half of the series (marginal standard error rule, K. P. White, Simulation 69, 1997). The window is
    steady if its straight line drifts by at most LARGEST_DRIFT of the mean, or by less than SURE standard errors.

    travel: (k,) increasing, at even distances; measure: (k,). NaN values are left out.
    Raises ValueError for fewer than FEWEST_VALUES values.
    """
    travel, measure = np.asarray(travel, dtype=float), np.asarray(measure, dtype=float)
    there = np.isfinite(measure)
    travel, measure = travel[there], measure[there]
    count = len(measure)
    if count < FEWEST_VALUES:
        raise ValueError(f"found {count} values along the travel, allowed are {FEWEST_VALUES} or more")
    left = count - np.arange(int(LARGEST_START * count) + 1)
    shifted = measure - measure[-1]  # so that squares of a large mean do not swamp the variance
    sums = np.cumsum(shifted[::-1])[left - 1]
    squares = np.cumsum(shifted[::-1] ** 2)[left - 1]
    start = int(np.argmin((squares - sums**2 / left) / left**2))
    return _window(travel[start:], measure[start:])


def window_between(travel: np.ndarray, measure: np.ndarray, start: float, end: float) -> Window | None:
    """Return a given window, such as the 1.0 to 1.7 m of Yan 2022; None if the series does not fill it.

    Arguments as for `steady_window`. The series fills a window if three values are inside and the last value
    of all is within one distance of its end.
    """
    travel, measure = np.asarray(travel, dtype=float), np.asarray(measure, dtype=float)
    inside = (travel >= start) & (travel <= end) & np.isfinite(measure)
    distance = np.diff(travel).max(initial=0.0)
    if inside.sum() < 3 or travel[-1] + distance < end:
        return None
    return _window(travel[inside], measure[inside])


def common_start(windows: Iterable[Window]) -> float:
    """Return where all measures are steady: the latest start; NaN when one of them is not, or there is none."""
    found = list(windows)
    if not found or not all(window.steady for window in found):
        return float("nan")
    return max(window.start for window in found)


def _window(travel: np.ndarray, measure: np.ndarray) -> Window:
    mean, count = float(measure.mean()), len(measure)
    away = travel - travel.mean()
    spread = float(away @ away)
    slope = float(away @ (measure - mean)) / spread
    rest = measure - mean - slope * away
    error = np.sqrt(float(rest @ rest) / max(count - 2, 1) / spread)
    rise = slope * (travel[-1] - travel[0])
    steady = abs(rise) <= LARGEST_DRIFT * abs(mean) or abs(slope) <= SURE * error
    return Window(
        start=float(travel[0]),
        end=float(travel[-1]),
        mean=mean,
        deviation=float(measure.std(ddof=1)),
        drift=rise / mean if mean else float("nan"),
        values=count,
        steady=bool(steady),
    )
