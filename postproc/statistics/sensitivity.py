"""Sobol indices: what part of a response's variance each factor makes over the range of a design.

All factors vary independently and evenly over their ranges. The first-order index of a factor is the part that it makes
alone, the total one adds all its interactions; of an additive response both are the same and add up to 1 (I. M. Sobol,
Math. Comput. Simul. 55, 2001, 271; A. Saltelli et al., Comput. Phys. Commun. 181, 2010, 259). Sample and estimators are
SALib's. A surrogate is a response that is known to some error: of draws of it the intervals hold that error too (L. Le
Gratiet, C. Cannamela, B. Iooss, SIAM/ASA J. Uncertainty Quantification 2, 2014, 336), besides that of the sample.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

CONFIDENCE = 0.95  # -, of the intervals
POWER = 11  # 2048 points of the sequence, each taken (factors + 2) times
RESAMPLES = 200  # of the points, one draw each
SMALLEST_VARIANCE = 1e-24  # -, over the mean square: a response that does not vary has no indices
FIRST, TOTAL = "first", "total"
COLUMNS = ("factor", *(f"{index}{end}" for index in (FIRST, TOTAL) for end in ("", "_low", "_high")))
Values = Callable[[np.ndarray], np.ndarray]
"""Of points (m, p) in the unit cube: the response (m,), or draws (m, d) of a surrogate of it."""


def sobol_indices(values: Values, names: Sequence[str], power: int = POWER, seed: int = 0) -> pd.DataFrame:
    """Return COLUMNS of each factor: indices (-) of first and total order with their 95 % intervals.

    names: of the p factors; power: 2^power points; seeded. Value: median of the draws; interval: quantiles over
    RESAMPLES of the points, each of one draw, so that the error of the sample and that of the surrogate are in it. Both
    are held between 0 and 1, where parts of a variance lie: the estimators pass them by the error of the sample.
    Raises ValueError for a response that does not vary, or is not a finite number everywhere.
    """
    from SALib.sample.sobol import sample  # slow to import

    unit = {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}
    points = sample(unit, 2**power, calc_second_order=False, seed=seed)
    found = np.asarray(values(points), dtype=float).reshape(len(points), -1)
    if not np.isfinite(found).all():
        raise ValueError("the response is not a number everywhere in the range, allowed are finite numbers")
    centred = found - found.mean(axis=0)
    deviation = centred.std(axis=0)
    if (deviation**2 <= SMALLEST_VARIANCE * np.mean(found**2, axis=0)).any():
        raise ValueError("the response does not vary over the range of the factors, so no factor makes a part of it")
    blocks = (centred / deviation).reshape(2**power, len(names) + 2, -1)
    whole = np.median(_indices(blocks), axis=-1)
    low, high = np.quantile(_resampled(blocks, seed), [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], axis=0)
    columns = [np.clip(part, 0.0, 1.0) for k in range(2) for part in (whole[k], low[k], high[k])]
    return pd.DataFrame(dict(zip(COLUMNS, [list(names), *columns], strict=True)))


def _indices(blocks: np.ndarray) -> np.ndarray:
    """Return first and total indices (2, p, d) of (n, p + 2, d) responses at A, A with each column of B, and B."""
    from SALib.analyze.sobol import first_order, total_order

    first, last = blocks[:, 0], blocks[:, -1]
    changed = [blocks[:, k] for k in range(1, blocks.shape[1] - 1)]
    return np.array([[index(first, one, last) for one in changed] for index in (first_order, total_order)])


def _resampled(blocks: np.ndarray, seed: int) -> np.ndarray:
    """Return indices (r, 2, p) of points that are drawn with replacement, each resample of the next draw."""
    chance, (count, _, draws) = np.random.default_rng(seed), blocks.shape
    rows = (blocks[chance.integers(0, count, count), :, r % draws] for r in range(max(RESAMPLES, draws)))
    return np.array([_indices(each[:, :, None])[..., 0] for each in rows])
