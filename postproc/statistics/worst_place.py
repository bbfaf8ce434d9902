"""The load of the worst place, without the lift that choosing it gives.

Of many places that scatter, the one with the largest mean has been lucky to be called the worst: its mean is above its
own truth, by two standard errors or more of a hundred alike places. So a block is judged by others: its value is that
of the place which they name the worst. What named the place knows nothing of the value, which so has the truth of that
place as its mean (M. Stone, J. R. Stat. Soc. B 36, 1974, 111). Where places are not alike, a lesser one is named now
and then: the mean is then the truth of what one names with so many blocks, a little below that of the very worst place.

The mean over packings is geometric, as is that of the values: a place where one packing alone has a great load, as of a
grain that jams there, is not the worst of all.

The others are all other packings. Of one packing they are the other half of its blocks, of the earlier or the later
ones, not all blocks but one: those name the same place again and again, by what is in most of the means, and the mean
of such values scatters twice as much as its blocks tell: of many alike places its interval held the truth in half of
the runs.

Values that name places for one another are never independent (Y. Bengio and Y. Grandvalet, J. Mach. Learn. Res. 5,
2004, 1089). How much they share was found by simulation, of 2 to 1,000 places, alike and graded: about 0.3 between
packings at most. Between halves it is 0.5, and they name lesser places more often: they are taken to share all, so that
the error is that of half as many blocks. Errors are widened for that, unless one place is the worst beyond doubt. How
often intervals hold the truth: benchmarks/service_life_coverage.py.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.block_means import mean_of_blocks
from bulkwear.postproc.statistics.intervals import Estimate

SHARED_BY_PACKINGS, SHARED_BY_HALVES = 0.3, 1.0  # -, correlation of values that name places for one another
CLEAR = 4.0  # standard errors of a difference that the worst place is above the next: halves then name it too
ALIKE = 0.5  # -, of the largest load: places above tell how much loads scatter


@dataclass(frozen=True, eq=False)
class WorstPlace:
    """The place with the largest load, and what blocks say of it that did not name it. b blocks.

    place: index among the places, from all blocks; load: its mean load over all blocks, geometric over packings,
    lifted by the choice
    named: (b,) place that the others of each block name, -1 without others; values: (b,) the block's value there, in
    the unit of the values, NaN without; loads: (b,) the same over what is allowed there
    packings: (b,) labels; clear: whether the place is the worst beyond doubt
    """

    place: int
    load: float
    named: np.ndarray
    values: np.ndarray
    loads: np.ndarray
    packings: np.ndarray
    clear: bool

    def value(self, log: bool = True) -> Estimate:
        """Return the mean of the values, see `block_means.mean_of_blocks`; log: of its logarithm."""
        return self._mean(self.values, log)

    def mean_load(self, log: bool = True) -> Estimate:
        """Return the mean of the loads, as `value`; where more or less is allowed at other places it is what counts."""
        return self._mean(self.loads, log)

    @property
    def agreement(self) -> float:
        """Return the share (-) of the blocks whose others name the place that all name; NaN without others."""
        found = self.named[self.named >= 0]
        return float((found == self.place).mean()) if len(found) else math.nan

    def _mean(self, values: np.ndarray, log: bool) -> Estimate:
        found = mean_of_blocks(values, self.packings, log)
        if self.clear or not found.known:
            return found
        if found.packings == 1:
            widened = 1.0 + SHARED_BY_HALVES
        else:  # of a mean, and of the scatter that the values show of it
            widened = (1.0 + (found.packings - 1.0) * SHARED_BY_PACKINGS) / (1.0 - SHARED_BY_PACKINGS)
        return Estimate(found.value, math.sqrt(widened) * found.error, found.freedom, found.packings, log)


def worst_place(
    values: np.ndarray,
    allowed: np.ndarray | None = None,
    packings: Sequence[Hashable] | np.ndarray | None = None,
) -> WorstPlace:
    """Return the place with the largest mean load, and each block's value at the place that its others name.

    values: (b, p), a row per block, those of a packing in the order of its run, a column per place; NaN are left out,
    and a place without a value in some packing is never the worst
    allowed: (p,) > 0, the load is a value over it; None: 1; NaN or infinite: never the worst
    packings: (b,) labels; packings count alike; None: all blocks are of one
    Raises ValueError for shapes that do not fit, allowed values not above 0, or where no place has a load.
    """
    values = np.asarray(values, dtype=float)
    labels = np.zeros(len(values), dtype=int) if packings is None else np.asarray(packings)
    _check(values, allowed, labels)
    limits = np.ones(values.shape[1]) if allowed is None else np.asarray(allowed, dtype=float)
    loads = values / np.where(np.isfinite(limits), limits, math.nan)
    groups = pd.factorize(labels)[0]
    means = _group_means(loads, groups)
    overall = geometric_mean(means)
    place = _worst(means)
    if place < 0:
        raise ValueError("no place has a load in all packings, allowed is one place or more")
    if len(means) == 1:
        groups = (2 * np.arange(len(values)) >= len(values)).astype(int)
        means = _group_means(loads, groups)
    named = _named_by_others(means)[groups]
    rows, there = np.arange(len(values)), named >= 0
    at_place = (np.where(there, table[rows, np.maximum(named, 0)], math.nan) for table in (values, loads))
    return WorstPlace(place, float(overall[place]), named, *at_place, labels, _clear(loads, labels))


def _check(values: np.ndarray, allowed: np.ndarray | None, labels: np.ndarray) -> None:
    if values.ndim != 2 or 0 in values.shape:
        raise ValueError(f"found values of the shape {values.shape}, allowed are blocks by places, one each or more")
    if allowed is not None and np.shape(allowed) != values.shape[1:]:
        raise ValueError(f"found {np.size(allowed)} allowed values of {values.shape[1]} places, allowed is one of each")
    if allowed is not None and (np.asarray(allowed) <= 0.0).any():
        raise ValueError(f"found the allowed value {np.nanmin(allowed):g}, allowed are values above 0")
    if labels.shape != values.shape[:1]:
        raise ValueError(f"found {len(labels)} packings of {len(values)} blocks, allowed is one label per block")


def _group_means(loads: np.ndarray, groups: np.ndarray) -> np.ndarray:
    """Return the mean (g, p) over the blocks of each group; NaN of a place without a value in one."""
    sums, counts = (
        np.array([part[groups == group].sum(axis=0) for group in range(groups.max() + 1)])
        for part in (np.nan_to_num(loads), np.isfinite(loads).astype(float))
    )
    return np.divide(sums, counts, out=np.full(sums.shape, math.nan), where=counts > 0.0)


def _named_by_others(means: np.ndarray) -> np.ndarray:
    """Return for each group (g,) the place that the means of all other groups name; -1 without others."""
    if len(means) == 1:
        return np.array([-1])
    return np.array([_worst(np.delete(means, group, axis=0)) for group in range(len(means))])


def geometric_mean(means: np.ndarray) -> np.ndarray:
    """Return the geometric mean (p,) over packings (g, p); NaN of a place without a value in one, 0 without a load."""
    if len(means) == 1:
        return means[0]
    return np.exp(_logarithm(means).mean(axis=0))


def _logarithm(means: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore"):
        return np.log(np.maximum(means, 0.0))


def _worst(means: np.ndarray) -> int:
    """Return the place of the largest mean over groups (g, p), the first of equal ones; -1 without any value.

    Where no place has a load in every group, the arithmetic mean names it.
    """
    overall = geometric_mean(means)
    if np.isnan(overall).all():
        return -1
    return int(np.nanargmax(overall if np.nanmax(overall) > 0.0 else means.mean(axis=0)))


def _clear(loads: np.ndarray, labels: np.ndarray) -> bool:
    """Return whether the largest mean is above the next one by more than chance: by CLEAR errors of a difference.

    The scatter between packings, of the logarithm, or between the blocks of one, is taken from all places above ALIKE
    together.
    """
    groups = pd.factorize(labels)[0]
    several = groups.max() > 0
    means = _group_means(loads, groups if several else np.arange(len(loads)))
    if several:
        means = _logarithm(means)
    overall = means.mean(axis=0)
    largest = np.sort(overall[np.isfinite(overall)])[::-1]
    if len(largest) < 2 or len(means) < 2:
        return len(largest) == 1
    alike = overall > (largest[0] + math.log(ALIKE) if several else ALIKE * largest[0])
    squares = means[:, alike].var(axis=0, ddof=1)
    return bool(largest[0] - largest[1] > CLEAR * math.sqrt(2.0 * squares.mean() / len(means)))
