"""Mean over blocks of one packing or of several and change over those of one, with the errors that they give.

Of several packings it is the estimator of `intervals`. Of one packing the blocks give the error of this run alone,
which tells nothing of another packing: `error_of_mean`, that widens for neighbours that are alike, and Student's t on
as many degrees of freedom as that error counts independent blocks, less one. The mixture over all correlations of
`correlated` is not used for a mean: up to twenty blocks do not exclude that all of them are off by the same, and its
intervals are two to four times as wide as blocks that forget within their length need. The price: of neighbours that
are correlated by more than 0.2 intervals hold the truth somewhat too rarely, so blocks are to be longer than the flow
remembers. The change of a series is treated alike: shown to be small by a dozen blocks, where the drift of
`steady`, which trusts nothing, needs forty. How often intervals hold: benchmarks/service_life_coverage.py.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence

import numpy as np

from bulkwear.postproc.statistics.intervals import Estimate, error_of_mean, estimate

FEWEST_BLOCKS = 4  # of one packing, for an error of its own


def mean_of_blocks(
    values: Sequence[float] | np.ndarray,
    packings: Sequence[Hashable] | np.ndarray | None = None,
    log: bool = False,
) -> Estimate:
    """Return the mean of block values; of one packing with the error of this run (`packings` of the estimate is 1).

    values: (k,), those of a packing in the order of its run; NaN are left out; packings: (k,) labels, without them all
    are of one; log: whether intervals are those of the logarithm, of positive means only
    The error is unknown of one packing with fewer than FEWEST_BLOCKS blocks. Raises ValueError as `estimate`.
    """
    values = np.asarray(values, dtype=float)
    there = np.isfinite(values)
    if packings is not None and (len(packings) != len(values) or len(set(np.asarray(packings)[there].tolist())) > 1):
        return estimate(values, packings, log)
    series = values[there]
    mean = float(series.mean()) if len(series) else math.nan
    if log and not mean > 0.0:
        return Estimate(math.nan, math.nan, 0, 0, log)
    if len(series) < FEWEST_BLOCKS:
        return Estimate(mean, math.nan, 0, min(len(series), 1), log)
    error, independent = error_of_mean(series), _independent(series)
    return Estimate(mean, error / mean if log else error, max(independent - 1.0, 1.0), 1, log)


def change_of_blocks(values: Sequence[float] | np.ndarray) -> Estimate:
    """Return second less first half of a series over its mean (-), of this run: half the rise of its straight line.

    values: (k,) of blocks of the same length, in their order. What the line leaves tells the error, widened as that of
    a mean. NaN of a series without a mean; unknown of fewer than FEWEST_BLOCKS blocks.
    """
    values = np.asarray(values, dtype=float)
    level = float(values.mean()) if len(values) else 0.0
    if not level or len(values) < 2:
        return Estimate(math.nan, math.nan, 0, min(len(values), 1))
    places = (np.arange(len(values)) - 0.5 * (len(values) - 1)) / len(values)
    square = float(places @ places)
    rise = float(places @ values) / square / level
    if len(values) < FEWEST_BLOCKS:
        return Estimate(0.5 * rise, math.nan, 0, 1)
    rest = values / level - 1.0 - rise * places
    freedom = _independent(rest) - 2.0
    variance = float(rest @ rest) / (len(values) - 2) * len(values) / _independent(rest)
    return Estimate(0.5 * rise, 0.5 * math.sqrt(variance / square), max(freedom, 1.0), 1)


def _independent(series: np.ndarray) -> float:
    """Return as how many independent values a series counts for the error of its mean."""
    error = error_of_mean(series)
    return float(series.var(ddof=1)) / error**2 if error > 0.0 else float(len(series))
