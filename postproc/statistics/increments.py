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
    table = pd.DataFrame({"end": np.asarray(travel, dtype=float), "cumulated": np.asarray(cumulated, dtype=float)})
    table["packing"] = 0 if packings is None else list(packings)
    before = table.groupby("packing", sort=False)[["end", "cumulated"]].shift()
    table = table.assign(start=before["end"], increment=table["cumulated"] - before["cumulated"])
    table = table[before["end"].notna()]
    if not (table["end"] > table["start"]).all():
        raise ValueError("the travel does not increase, allowed are increasing values within a packing")
    return table[BLOCKS].reset_index(drop=True)


def rate_trend(blocks: pd.DataFrame) -> RateTrend:
    """Return the trend of the rate of BLOCKS, of one packing or over packings."""
    packings = [one for _, one in blocks.groupby("packing", sort=False)]
    if len(packings) == 1:
        return _of_one(packings[0])
    lines = np.array([_least_squares(one) for one in packings]).reshape(-1, 3)
    rate, slope, change = (estimate(column) for column in lines.T)
    return RateTrend(rate, slope, change, len(blocks))


def prediction(
    blocks: pd.DataFrame, place: float, order: int = 1, log: bool = False, farthest: float = FARTHEST
) -> Prediction:
    """Return the cumulated quantity at a place of the travel beyond the run, with a prediction interval.

    blocks: BLOCKS without gaps; order: of the rate: 1 for a straight line, 0 where it is known to be constant
    log: whether packings scatter by a factor; farthest: of the travel of the shortest packing; beyond it all is NaN
    Over packings each is extrapolated, and the interval is that of one more (`Estimate.of_one_more`): an extrapolated
    packing scatters at least as much as a simulated one. Of one packing it holds the errors of its trend and the
    fluctuation of the blocks to come.
    """
    packings = [one for _, one in blocks.groupby("packing", sort=False)]
    start, end = blocks["start"].min(), min(one["end"].max() for one in packings)
    if place > start + farthest * (end - start):
        reason = f"more than {farthest:g} times the travel of the run"
        return Prediction(math.nan, math.nan, math.nan, len(packings), reason)
    if len(packings) == 1:
        found = _continued(packings[0], place, order)
        reason = "" if found.known else FEW
        return Prediction(found.value, *found.interval(), 1, reason)
    over = estimate([_extrapolated(one, place, order) for one in packings], log=log)
    return Prediction(over.value, *over.of_one_more(), over.packings, "" if over.known else UNKNOWN)


def _of_one(one: pd.DataFrame) -> RateTrend:
    rate, slope, change = _least_squares(one)
    fit = _fit(one, order=1)
    if fit is None:
        return RateTrend(*(Estimate(each, math.nan, 0, 1) for each in (rate, slope, change)), len(one))
    mean, slope = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    return RateTrend(fit.of(mean), fit.of(slope), fit.ratio(_span(one) * slope, mean), len(one))


def _columns(one: pd.DataFrame, order: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Return lengths, rates, the powers (k, order + 1) of the middles about that of the run, and that middle."""
    length = (one["end"] - one["start"]).to_numpy(float)
    center = 0.5 * (one["start"].min() + one["end"].max())
    away = 0.5 * (one["start"] + one["end"]).to_numpy(float) - center
    return length, one["increment"].to_numpy(float) / length, away[:, None] ** np.arange(order + 1), center


def _fit(one: pd.DataFrame, order: int) -> CorrelatedFit | None:
    length, rates, powers, _ = _columns(one, order)
    if len(one) < FEWEST_BLOCKS:
        return None
    middles = 0.5 * (one["start"] + one["end"]).to_numpy(float)
    return correlated_fit(middles, rates, powers, length)


def _span(one: pd.DataFrame) -> float:
    return float(one["end"].max() - one["start"].min())


def _least_squares(one: pd.DataFrame) -> tuple[float, float, float]:
    """Return mean rate, slope and relative change of a packing, weighted by the lengths; NaN of one block."""
    length, rates, powers, _ = _columns(one, 1)
    if len(one) < 2:
        return float(rates.mean()), math.nan, math.nan
    root = np.sqrt(length)
    rate, slope = np.linalg.lstsq(powers * root[:, None], rates * root, rcond=None)[0]
    return float(rate), float(slope), float(slope * _span(one) / rate) if rate else math.nan


def _growth(center: float, end: float, place: float, order: int) -> np.ndarray:
    """Return what (order + 1,) the coefficients of the rate add between the run's end and a place."""
    powers = np.arange(1, order + 2)
    return ((place - center) ** powers - (end - center) ** powers) / powers


def _extrapolated(one: pd.DataFrame, place: float, order: int) -> float:
    """Return a packing's cumulated quantity at a place, by least squares of its rate."""
    length, rates, powers, center = _columns(one, order)
    if len(one) <= order:
        return math.nan
    root = np.sqrt(length)
    terms = np.linalg.lstsq(powers * root[:, None], rates * root, rcond=None)[0]
    last = one.loc[one["end"].idxmax()]
    return float(last["cumulated"] + _growth(center, last["end"], place, order) @ terms)


def _continued(one: pd.DataFrame, place: float, order: int) -> Estimate:
    """Return a run's own cumulated quantity at a place, with the fluctuation of what is to come."""
    length, _, _, center = _columns(one, order)
    last, fit = one.loc[one["end"].idxmax()], _fit(one, order)
    if fit is None:
        return Estimate(_extrapolated(one, place, order), math.nan, 0, 1)
    ahead = (place - last["end"]) / length.mean()  # blocks to come, and the sum of their noises
    whole = np.arange(1, max(math.ceil(ahead), 1))
    sums = ahead + 2.0 * ((ahead - whole) * fit.correlations[:, None] ** whole).sum(axis=1)
    growth = _growth(center, last["end"], place, order)
    return fit.of(growth, float(last["cumulated"]), sums * length.mean() ** 2)
