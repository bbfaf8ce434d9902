"""Where a run is steady: from which place of the travel on its measures only fluctuate."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from bulkwear.postproc.statistics.correlated import correlated_fit
from bulkwear.postproc.statistics.intervals import Estimate

FEWEST_VALUES = 6  # in a series: fewer show neither a transient nor a fluctuation
LARGEST_START = 0.5  # -, of the series: what is cut off as transient
LARGEST_DRIFT = 0.05  # -, of the mean: what a steady window may rise or fall from its start to its end
ERROR_RATE = 0.05  # -, of windows that drift by more and are called steady, and of those by less called drifting
STEADY, DRIFTING, UNSAID = "steady", "drifting", "cannot be said"
BELOW, ABOVE = "below", "above"


@dataclass(frozen=True)
class Window:
    """A window of travel and what a measure does in it.

    start, end: of the travel; mean, deviation: of the measure, in its unit; values: how many there are
    drift, drift_low, drift_high: -, rise of its straight line from start to end over the mean, and its interval
    variation_low, variation_high: -, interval of the deviation over the mean
    answer: STEADY, DRIFTING or UNSAID
    Intervals are at 95 %, for values that are correlated with their neighbours, see `correlated`.
    """

    start: float
    end: float
    mean: float
    deviation: float
    drift: float
    drift_low: float
    drift_high: float
    variation_low: float
    variation_high: float
    values: int
    answer: str

    @property
    def steady(self) -> bool:
        """Return whether the window is shown to be steady."""
        return self.answer == STEADY

    def fluctuates(self, limit: float) -> str:
        """Return whether the deviation over the mean is BELOW or ABOVE a limit (-) with all of its interval."""
        if self.variation_high < limit:
            return BELOW
        return ABOVE if self.variation_low > limit else UNSAID


def steady_window(travel: np.ndarray, measure: np.ndarray) -> Window:
    """Return the steady window of a series, from where its transient has passed to its end.

    The start is the one that makes the mean of the rest surest: the least of the variance of the rest over its number,
    among the first half of the series (marginal standard error rule, K. P. White, Simulation 69, 1997). The window is
    steady if its drift lies within LARGEST_DRIFT to both sides for sure (two one-sided tests at ERROR_RATE), drifting
    if it lies beyond for sure, and nothing can be said else: of a long window with little scatter there is an answer.

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
    """Return where all measures are steady: the latest start; NaN where one is not shown to be, or there is none."""
    found = list(windows)
    if not found or not all(window.steady for window in found):
        return float("nan")
    return max(window.start for window in found)


def _window(travel: np.ndarray, measure: np.ndarray) -> Window:
    mean = float(measure.mean())
    drift = relative_drift(travel, measure)
    level = correlated_fit(travel, measure, np.ones((len(travel), 1)))
    deviation = (math.nan, math.nan) if level is None or not mean else level.deviation()
    low, high = drift.interval()
    return Window(
        start=float(travel[0]),
        end=float(travel[-1]),
        mean=mean,
        deviation=float(measure.std(ddof=1)),
        drift=drift.value,
        drift_low=low,
        drift_high=high,
        variation_low=deviation[0] / abs(mean) if mean else math.nan,
        variation_high=deviation[1] / abs(mean) if mean else math.nan,
        values=len(measure),
        answer=answer_on_change(drift),
    )


def relative_drift(travel: np.ndarray, measure: np.ndarray) -> Estimate:
    """Return the rise of a series' straight line from its first place to its last, over its mean (-), of this series.

    travel: (k,) increasing; measure: (k,). Unknown of fewer than four values.
    """
    away = travel - 0.5 * (travel[0] + travel[-1])
    fit = correlated_fit(travel, measure, np.column_stack([np.ones(len(away)), away]))
    span, level = float(travel[-1] - travel[0]), float(measure.mean())
    if fit is None or not level:
        slope = float(np.polynomial.polynomial.polyfit(away, measure, 1)[1])
        return Estimate(slope * span / level if level else math.nan, math.nan, 0, 1)
    return fit.ratio(np.array([0.0, span]), np.array([1.0, 0.0]))


def answer_on_change(change: Estimate, tolerance: float = LARGEST_DRIFT) -> str:
    """Return STEADY for a change (-) that is surely within a tolerance (-), DRIFTING for one beyond it, else UNSAID."""
    if not change.known:
        return UNSAID
    low, high = change.bounds(ERROR_RATE)
    if low >= -tolerance and high <= tolerance:
        return STEADY
    return DRIFTING if low > tolerance or high < -tolerance else UNSAID
