"""Whether a quantity that adds up along a travel grows at a constant rate, and how much it will be beyond the run.

A cumulated quantity, as a worn volume, carries every fluctuation on to its end: its values are not independent, and a
fit of them calls straight growth curved more often than not, while R2 is close to 1 of anything that grows. What is
tested here are its increments over blocks of travel, divided by their lengths: the rate. The quantity grows linearly
where the rate is constant; its quadratic term is half the slope of the rate.

Of one packing the errors are those of `correlated`, for blocks that follow one another: they say how sure the trend of
this run is, and nothing of another packing. Of several packings each gives one trend, and the estimator of `intervals`
is taken over them.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.correlated import CorrelatedFit, correlated_fit
from bulkwear.postproc.statistics.intervals import UNKNOWN, Estimate, estimate

FEWEST_BLOCKS = 4  # of one packing, for errors of its own trend
FARTHEST = 2.0  # -, of the run's travel: how far a prediction reaches
BLOCKS = ["packing", "start", "end", "increment", "cumulated"]
FEW = f"fewer than {FEWEST_BLOCKS} blocks"


@dataclass(frozen=True)
class RateTrend:
    """How a rate changes along the travel.

    rate: mean over the travel; slope: per unit of travel; change: -, rise of the rate's straight line from the start of
    the run to its end over the mean rate; blocks: number of all packings together
    Errors are unknown for one packing of fewer than FEWEST_BLOCKS blocks.
    """

    rate: Estimate
    slope: Estimate
    change: Estimate
    blocks: int

    @property
    def quadratic(self) -> Estimate:
        """Return the quadratic term of the cumulated quantity, half the slope of its rate."""
        return Estimate(0.5 * self.slope.value, 0.5 * self.slope.error, self.slope.freedom, self.slope.packings)

    @property
    def curved(self) -> bool | None:
        """Return whether the interval of the slope excludes 0, so that 5 % of straight ones do; None if unknown."""
        low, high = self.slope.interval()
        return None if not self.slope.known else bool(low > 0.0 or high < 0.0)

    def constant_within(self, margin: float, error_rate: float = 0.05) -> bool | None:
        """Return whether the rate changes by less than `margin` (-) over the run, surely; None if unknown.

        Two one-sided tests: of rates that change by more, at most `error_rate` pass. Not to pass proves no change.
        """
        low, high = self.change.bounds(error_rate)
        return None if not self.change.known else bool(-margin < low and high < margin)


@dataclass(frozen=True)
class Prediction:
    """A cumulated quantity at a place beyond the run: value, and the interval of one further packing, or of this run.

    packings: how many it is made of: with 1 the interval is that of this very run, simulated on
    reason: why value or interval are NaN; empty where they are not
    """

    value: float
    low: float
    high: float
    packings: int
    reason: str = ""


def blocks_of(
    travel: Sequence[float] | np.ndarray,
    cumulated: Sequence[float] | np.ndarray,
    packings: Sequence[Hashable] | np.ndarray | None = None,
) -> pd.DataFrame:
    """Return the BLOCKS between the values of a cumulated quantity, one row per block.

    travel: (k,) increasing within a packing; cumulated: (k,) with its value at the start of the travel first, as 0
    packings: (k,) labels; without them all are of one. Raises ValueError when a packing's travel does not increase.
    """
    travel, cumulated = np.asarray(travel, dtype=float), np.asarray(cumulated, dtype=float)
    codes, names = pd.factorize(np.zeros(len(travel)) if packings is None else np.asarray(packings))
    order = np.argsort(codes, kind="stable")
    after = np.flatnonzero(np.diff(codes[order]) == 0) + 1
    here, before = order[after], order[after - 1]
    if not (travel[here] > travel[before]).all():
        raise ValueError("the travel does not increase, allowed are increasing values within a packing")
    ends = {"start": travel[before], "end": travel[here]}
    grown = {"increment": cumulated[here] - cumulated[before], "cumulated": cumulated[here]}
    return pd.DataFrame({"packing": names[codes[here]], **ends, **grown})


def rate_trend(blocks: pd.DataFrame) -> RateTrend:
    """Return the trend of the rate of BLOCKS, of one packing or over packings."""
    runs = _runs(blocks)
    if len(runs) == 1:
        return _of_one(runs[0])
    rate, slope, change = (estimate(column) for column in np.array([_least_squares(run) for run in runs]).T)
    return RateTrend(rate, slope, change, len(blocks))


def prediction(
    blocks: pd.DataFrame, place: float, order: int = 1, log: bool = False, farthest: float = FARTHEST
) -> Prediction:
    """Return the cumulated quantity at a place of the travel beyond the run, with a prediction interval.

    blocks: BLOCKS without gaps; order: of the rate: 1 for a straight line, 0 where it is known to be constant
    log: whether packings scatter by a factor; farthest: of the travel of the shortest packing; beyond it all is NaN
    Over packings each is extrapolated, and the interval is that of one more (`Estimate.of_one_more`): an extrapolated
    packing scatters at least as much as a simulated one. Of one packing it holds the errors of its trend and the
    fluctuation of the blocks to come, which go on from its last one.
    """
    runs = _runs(blocks)
    start, end = min(run.start for run in runs), min(run.end for run in runs)
    if place > start + farthest * (end - start):
        reason = f"more than {farthest:g} times the travel of the run"
        return Prediction(math.nan, math.nan, math.nan, len(runs), reason)
    if len(runs) == 1:
        found = _continued(runs[0], place, order)
        return Prediction(found.value, *found.interval(), 1, "" if found.known else FEW)
    over = estimate([_extrapolated(run, place, order) for run in runs], log=log)
    return Prediction(over.value, *over.of_one_more(), over.packings, "" if over.known else UNKNOWN)


@dataclass(frozen=True, eq=False)
class _Run:
    """One packing: middles, lengths and rates (k,) of its blocks, where it starts and ends, and its sum at the end."""

    middles: np.ndarray
    lengths: np.ndarray
    rates: np.ndarray
    start: float
    end: float
    last: float

    @property
    def center(self) -> float:
        return 0.5 * (self.start + self.end)

    def powers(self, order: int) -> np.ndarray:
        """Return (k, order + 1) of the middles about the center."""
        return (self.middles - self.center)[:, None] ** np.arange(order + 1)

    def least_squares(self, order: int) -> np.ndarray:
        """Return the coefficients (order + 1,) of the rate, weighted by the lengths; NaN of too few blocks."""
        if len(self.rates) <= order:
            return np.full(order + 1, math.nan)
        root = np.sqrt(self.lengths)
        return np.linalg.lstsq(self.powers(order) * root[:, None], self.rates * root, rcond=None)[0]

    def fit(self, order: int) -> CorrelatedFit | None:
        """Return the fit of the rate with its errors, None of fewer blocks than FEWEST_BLOCKS."""
        if len(self.rates) < FEWEST_BLOCKS:
            return None
        return correlated_fit(self.middles, self.rates, self.powers(order), self.lengths)


def _runs(blocks: pd.DataFrame) -> list[_Run]:
    """Return the packings in the order in which they appear, the blocks of each along its travel."""
    columns = (blocks[name].to_numpy(float) for name in ("start", "end", "increment", "cumulated"))
    starts, ends, increments, sums = columns
    codes, names = pd.factorize(blocks["packing"].to_numpy())
    found = []
    for code in range(len(names)):
        chosen = np.flatnonzero(codes == code)
        chosen = chosen[np.argsort(ends[chosen])]
        start, end = starts[chosen], ends[chosen]
        rates = increments[chosen] / (end - start)
        found.append(_Run(0.5 * (start + end), end - start, rates, start[0], end[-1], sums[chosen[-1]]))
    return found


def _of_one(run: _Run) -> RateTrend:
    rate, slope, change = _least_squares(run)
    fit = run.fit(1)
    if fit is None:
        return RateTrend(*(Estimate(each, math.nan, 0, 1) for each in (rate, slope, change)), len(run.rates))
    mean, slope = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    return RateTrend(fit.of(mean), fit.of(slope), fit.ratio((run.end - run.start) * slope, mean), len(run.rates))


def _least_squares(run: _Run) -> tuple[float, float, float]:
    """Return mean rate, slope and relative change of a packing; of one block only the rate."""
    rate, slope = run.least_squares(1)
    if math.isnan(rate):
        return float(run.rates.mean()), math.nan, math.nan
    return float(rate), float(slope), float(slope * (run.end - run.start) / rate) if rate else math.nan


def _growth(center: float, end: float, place: float, order: int) -> np.ndarray:
    """Return what (order + 1,) the coefficients of the rate add between the run's end and a place."""
    powers = np.arange(1, order + 2)
    return ((place - center) ** powers - (end - center) ** powers) / powers


def _extrapolated(run: _Run, place: float, order: int) -> float:
    """Return a packing's cumulated quantity at a place, by least squares of its rate."""
    return float(run.last + _growth(run.center, run.end, place, order) @ run.least_squares(order))


def _continued(run: _Run, place: float, order: int) -> Estimate:
    """Return a run's own cumulated quantity at a place: what its trend and its last block let expect of those to come,
    with the errors of the trend and their own fluctuation.
    """
    fit = run.fit(order)
    if fit is None:
        return Estimate(_extrapolated(run, place, order), math.nan, 0, 1)
    length = float(run.lengths.mean())
    ahead = (place - run.end) / length
    number = np.arange(1, max(math.ceil(ahead), 1) + 1)
    parts = np.minimum(ahead - number + 1.0, 1.0)  # of the blocks to come, the last one perhaps in part
    lasting = length * (fit.correlations[:, None] ** number) @ parts  # of what the last block is off the trend
    apart = fit.correlations[:, None, None] ** np.abs(number[:, None] - number)
    fluctuation = length**2 * np.einsum("i,mij,j->m", parts, apart, parts) - lasting**2
    growth = _growth(run.center, run.end, place, order) - lasting[:, None] * run.powers(order)[-1]
    return fit.of(growth, run.last + lasting * run.rates[-1], np.maximum(fluctuation, 0.0))
