"""Means of settings whose packings are the same beds, and the errors that these means share.

    value = setting + packing + rest,   packings and rests independent, a packing the same for all its settings

All patterns of a packing slide through one bed, and are set over one plain twin: what that twin is wrong by is common
to them all. It shifts every mean alike, so patterns are told apart by the rest alone, and against plain by both.

Variances by the analysis of variance of two crossed factors (S. R. Searle, G. Casella and C. E. McCulloch, Variance
Components, Wiley 1992, chapter 4), means by generalised least squares, where settings have unequal packings too.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence

import numpy as np
import pandas as pd

ROUNDING = 1e-9  # -, of the whole variance: a rest below it is rounding


def means_and_covariance(
    settings: Sequence[Hashable], packings: Sequence[Hashable], values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return means (s,) of settings, in the order in which they appear, and the covariance (s, s) of their errors.

    settings, packings: (k,) labels of values (k,). The covariance is 0 where no setting has two packings. Where no two
    settings share two packings, nothing tells packing and rest apart, and all of the scatter is taken for rest.
    """
    values = np.asarray(values, float)
    of_setting, of_packing = _indicators(settings), _indicators(packings)
    packing, rest = _variances(values, of_setting, of_packing)
    if not rest > 0.0:
        return np.linalg.lstsq(of_setting, values)[0], np.zeros((of_setting.shape[1],) * 2)
    covariance = rest * np.eye(len(values)) + packing * of_packing @ of_packing.T
    weighed = np.linalg.solve(covariance, of_setting)
    errors = np.linalg.inv(of_setting.T @ weighed)
    return errors @ weighed.T @ values, errors


def _indicators(labels: Sequence[Hashable]) -> np.ndarray:
    """Return which of the different labels each one is, (k, m) of 0 and 1."""
    return np.eye(len(set(labels)))[pd.factorize(np.asarray(labels))[0]]


def _variances(values: np.ndarray, of_setting: np.ndarray, of_packing: np.ndarray) -> tuple[float, float]:
    """Return the variances of packings and of the rest; both 0 where nothing scatters, or no one knows."""
    both = _mean_square(values, of_setting)
    if np.isnan(both) or not both > 0.0:
        return 0.0, 0.0
    alone = _mean_square(values, np.hstack([of_setting, of_packing]))
    rest = both if np.isnan(alone) else max(min(alone, both), ROUNDING * both)
    return both - rest, rest


def _mean_square(values: np.ndarray, columns: np.ndarray) -> float:
    """Return the mean square (k,) values leave about columns (k, m), NaN without a degree of freedom."""
    found, _, rank, _ = np.linalg.lstsq(columns, values)
    freedom = len(values) - rank
    left = values - columns @ found
    return float(left @ left) / freedom if freedom else np.nan
