"""Means with intervals over packings and blocks: the one estimator behind every interval that is told of a bed.

A packing is one independent realisation of a bed. A block is a stretch of its travel, such as a wear cycle or a
revolution; blocks of one packing follow one another and are alike, packings are not. The model is

    block value = mean + packing + block,   packings independent, blocks of a packing correlated in any way

The mean is taken over the blocks of each packing, then over the packings, all with the same weight. Its standard error
is the standard deviation of the packings' means over the root of their number. That holds the scatter of packings and
of blocks together, whatever the correlation of the blocks, and Student's t on (packings - 1) degrees of freedom gives
the interval: the analysis of variance of a random factor, with its mean square between packings. Blocks of one packing
say nothing about the next one: of one packing the scatter is unknown, and there is no interval.

Positive quantities whose scatter is a factor, as volumes and their ratios, are told by their logarithm: the mean is
geometric, the interval that of the logarithm. How far these intervals hold the truth is measured in
docs/interval_coverage.md.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import pandas as pd

CONFIDENCE = 0.95  # -, of every interval that is shown
UNKNOWN = "one packing, scatter unknown"
COLUMNS = ("packings", "interval_low", "interval_high")  # of tables that tell intervals


@dataclass(frozen=True)
class Estimate:
    """A mean over packings.

    value: the mean, geometric where `log`; NaN without a packing
    error: its standard error, of the logarithm (-) where `log`; NaN where the scatter is unknown
    freedom: degrees of freedom of the error; 0 where it is unknown
    packings: how many there are; 1 with a known error is of this run alone, see `increments`
    log: whether errors and intervals are those of the logarithm
    """

    value: float
    error: float
    freedom: float
    packings: int
    log: bool = False

    @property
    def known(self) -> bool:
        """Return whether the scatter is known, so that there is an interval."""
        return self.freedom > 0 and math.isfinite(self.error)

    def interval(self, confidence: float = CONFIDENCE) -> tuple[float, float]:
        """Return the two-sided interval of the mean; NaN at both ends where the scatter is unknown."""
        return self._about(self.error, 0.5 + 0.5 * confidence)

    def bounds(self, error_rate: float) -> tuple[float, float]:
        """Return the one-sided bounds, each of which the truth passes at `error_rate` (-)."""
        return self._about(self.error, 1.0 - error_rate)

    def of_one_more(self, confidence: float = CONFIDENCE) -> tuple[float, float]:
        """Return the interval in which the value of one further packing falls; NaN where the scatter is unknown.

        Of one packing it is: an interval that its own blocks give is of this run, and tells nothing of another one.
        """
        if self.packings < 2:
            return math.nan, math.nan
        return self._about(self.error * math.sqrt(self.packings + 1.0), 0.5 + 0.5 * confidence)

    def width(self, confidence: float = CONFIDENCE) -> float:
        """Return the whole width of the interval over the mean, -; NaN where the scatter is unknown."""
        low, high = self.interval(confidence)
        return (high - low) / abs(self.value) if self.value else math.nan

    def _about(self, error: float, share: float) -> tuple[float, float]:
        if not self.known:
            return math.nan, math.nan
        reach = students_t(share, self.freedom) * error
        if self.log:
            return self.value * math.exp(-reach), self.value * math.exp(reach)
        return self.value - reach, self.value + reach

    def text(self, digits: int = 3, unit: str = "", factor: float = 1.0) -> str:
        """Return the mean with its interval and number of packings, or that its scatter is unknown.

        digits: significant ones of the mean, or of the interval's reach where that is larger; the ends of the interval
        have the same decimals; factor: of display units
        """
        ending = f" {unit}" if unit else ""
        if not math.isfinite(self.value):
            return "no value"
        low, high = (factor * end for end in self.interval())
        decimals = _decimals(np.nanmax([abs(factor * self.value), 0.5 * abs(high - low)]), digits)
        mean = f"{factor * self.value:.{decimals}f}{ending}"
        if not self.known:
            return f"{mean} ({UNKNOWN})" if self.packings < 2 else f"{mean} (scatter unknown)"
        of = f"{self.packings} packings" if self.packings > 1 else "of this run"
        return f"{mean} ({100.0 * CONFIDENCE:.0f} % interval {low:.{decimals}f} to {high:.{decimals}f}, {of})"


@dataclass(frozen=True)
class Ends:
    """An interval at CONFIDENCE that no mean over packings gives, as that of a crossing; it is judged like an estimate.

    value: what it is about; low, high: its ends, NaN where the scatter is unknown; packings: behind each point of it
    """

    value: float
    low: float
    high: float
    packings: int

    @property
    def known(self) -> bool:
        """Return whether there is an interval."""
        return not (math.isnan(self.low) or math.isnan(self.high))

    def bounds(self, error_rate: float) -> tuple[float, float]:
        """Return the ends. Raises ValueError for an error rate that they do not keep."""
        if error_rate < 0.5 * (1.0 - CONFIDENCE):
            raise ValueError(f"found the error rate {error_rate:g}, allowed is {0.5 * (1.0 - CONFIDENCE):g} or more")
        return self.low, self.high

    def text(self, digits: int = 3, unit: str = "") -> str:
        """Return the value with its interval, or that its scatter is unknown."""
        ending = f" {unit}" if unit else ""
        if not self.known:
            return f"{self.value:.{digits}g}{ending} ({UNKNOWN if self.packings == 1 else 'no interval'})"
        return (
            f"{self.value:.{digits}g}{ending}"
            f" ({100.0 * CONFIDENCE:.0f} % interval {self.low:.{digits}g} to {self.high:.{digits}g})"
        )


@cache  # few different ones are asked for, by many estimates
def students_t(share: float, freedom: float) -> float:
    """Return the quantile of Student's t at a share (-), on so many degrees of freedom."""
    from scipy import special  # slow to import, and every start of Snakemake reads this module

    return float(special.stdtrit(freedom, share))


def _decimals(value: float, digits: int) -> int:
    return max(digits - 1 - math.floor(math.log10(abs(value))), 0) if value else digits - 1


def estimate(
    values: Sequence[float] | np.ndarray, packings: Sequence[Hashable] | np.ndarray | None = None, log: bool = False
) -> Estimate:
    """Return the mean of block values over packings, by the estimator of this module.

    values: (k,) one per block; NaN, and where `log` what is not above zero, are left out
    packings: (k,) labels; without them each value is that of a packing of its own
    Raises ValueError for labels of another number.
    """
    means = packing_means(values, packings, log)
    count = len(means)
    value = float(means.mean()) if count else math.nan
    error = float(means.std(ddof=1) / math.sqrt(count)) if count > 1 else math.nan
    return Estimate(math.exp(value) if log else value, error, max(count - 1, 0), count, log)


def packing_means(
    values: Sequence[float] | np.ndarray, packings: Sequence[Hashable] | np.ndarray | None = None, log: bool = False
) -> np.ndarray:
    """Return the mean over the blocks of each packing (n,), its logarithm where `log`; arguments as for `estimate`.

    The blocks themselves are averaged, not their logarithms: a packing's volume is the sum of its blocks'.
    """
    values = np.asarray(values, dtype=float)
    labels = np.arange(len(values)) if packings is None else np.asarray(packings)
    if labels.shape != values.shape:
        raise ValueError(f"found {len(labels)} packings of {len(values)} values, allowed is one label per value")
    means = pd.Series(values).groupby(labels, sort=False).mean().to_numpy()
    if log:
        means = np.log(np.where(means > 0.0, means, np.nan))
    return means[np.isfinite(means)]


def difference(first: Estimate, second: Estimate) -> Estimate:
    """Return first minus second, or their ratio where both are of the logarithm, of packings that share nothing.

    Degrees of freedom by B. L. Welch (Biometrika 34, 1947). Values that share their packings are to be subtracted or
    divided packing by packing instead, which removes what they share.
    Raises ValueError for one estimate of the logarithm and one that is not.
    """
    if first.log != second.log:
        raise ValueError("found one estimate of a logarithm and one of a value, allowed are two of a kind")
    value = first.value / second.value if first.log else first.value - second.value
    packings = min(first.packings, second.packings)
    if not (first.known and second.known):
        return Estimate(value, math.nan, 0, packings, first.log)
    squares = np.array([first.error, second.error]) ** 2
    parts = float((squares**2 / np.array([first.freedom, second.freedom])).sum())
    freedom = float(squares.sum() ** 2 / parts) if parts > 0.0 else first.freedom + second.freedom
    return Estimate(value, math.sqrt(squares.sum()), freedom, packings, first.log)


def estimates(
    settings: Sequence[Hashable] | np.ndarray,
    values: Sequence[float] | np.ndarray,
    packings: Sequence[Hashable] | np.ndarray | None = None,
    log: bool = False,
    one_scatter: bool = False,
) -> dict[Hashable, Estimate]:
    """Return {setting: its `estimate`}, in the order in which settings appear.

    settings: (k,) labels, one per value
    one_scatter: whether all settings are taken to scatter alike: the variance between packings is then pooled over the
        settings with two packings or more, with the sum of their degrees of freedom. That is an assumption, and a
        setting that scatters more than the others has too short an interval; of one packing nothing is known still.
    """
    table = pd.DataFrame({"setting": list(settings), "value": np.asarray(values, dtype=float)})
    table["packing"] = np.arange(len(table)) if packings is None else list(packings)
    groups = table.groupby("setting", sort=False)
    found = {name: estimate(one["value"], one["packing"], log) for name, one in groups}
    if not one_scatter:
        return found
    known = [each for each in found.values() if each.known]
    freedom = sum(each.freedom for each in known)
    variance = sum(each.freedom * each.packings * each.error**2 for each in known) / freedom if freedom else math.nan
    return {
        name: Estimate(each.value, math.sqrt(variance / each.packings), freedom, each.packings, log)
        if each.known
        else each
        for name, each in found.items()
    }


def interval_table(found: Mapping[Hashable, Estimate], confidence: float = CONFIDENCE) -> pd.DataFrame:
    """Return setting, mean, and COLUMNS of estimates; NaN ends where the scatter is unknown."""
    rows = [(name, each.value, each.packings, *each.interval(confidence)) for name, each in found.items()]
    return pd.DataFrame(rows, columns=["setting", "mean", *COLUMNS])


def error_of_mean(series: np.ndarray) -> float:
    """Return the standard error of the mean of a series (k,) whose values follow one another.

    The lag-one correlation r of the values widens it by the root of (1 + r)/(1 - r), that of a series which forgets
    exponentially; r is corrected for the bias of short series (F. H. C. Marriott and J. A. Pope, Biometrika 41, 1954)
    and kept within 0 and 1 - 2/k, that two values at least are independent. NaN for fewer than three values.
    """
    series = np.asarray(series, dtype=float)
    count = len(series)
    if count < 3:
        return math.nan
    rest = series - series.mean()
    square = float(rest @ rest)
    if square == 0.0:
        return 0.0
    found = float(rest[1:] @ rest[:-1]) / square
    corrected = (found + 1.0 / count) / (1.0 - 3.0 / count) if count > 3 else found
    correlation = min(max(corrected, 0.0), 1.0 - 2.0 / count)
    return math.sqrt(square / (count - 1) / count * (1.0 + correlation) / (1.0 - correlation))
