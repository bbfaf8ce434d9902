"""What measured responses say about the parameters: the posterior over points of the unit cube, and what follows.

The model (in the spirit of M. C. Kennedy and A. O'Hagan, Journal of the Royal Statistical Society B 63 (2001) 425-464):

    measured = simulated + discrepancy + error of the measurement

Simulated is the mean over packings, known up to the surrogate's variance; the discrepancy, what the model is off by
even with the right parameters, is normal about 0 with a standard deviation that is given per response. It is given, not
found: there are about as many responses as parameters, and these say nothing of its size. Scales that are marginalised
(half-normal, half-Cauchy) widen the region as much and hold the truth less often (docs/calibration_coverage.md).

All functions take the posterior as weights (n,) of evenly spread points (n, p), which sum to 1.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bulkwear.postproc.inference.problem import Measured
from bulkwear.postproc.inference.surrogate import Predictions

FAMILY_SHARE = 0.95  # of the posterior, in the stated region and intervals
CORE_SHARE = 0.5  # of the posterior, in the region that the recommendation is taken from


def log_normal(value: float, mean: np.ndarray, variance: np.ndarray | float) -> np.ndarray:
    """Return the logarithm of the normal density of a value."""
    return -0.5 * ((value - mean) ** 2 / variance + np.log(2.0 * np.pi * variance))


def posterior_weights(predicted: Predictions, measured: Mapping[str, Measured]) -> np.ndarray:
    """Return the posterior weights (n,) of points with these predictions, every point as likely before.

    The likelihood of a point is the product over the responses of the normal density of the measured value, with the
    variances of measurement, discrepancy and surrogate added.
    """
    logs = sum(
        log_normal(measured[name].value, mean, measured[name].variance + variance)
        for name, (mean, variance) in predicted.items()
        if name in measured
    )
    weights = np.exp(logs - np.max(logs))
    return weights / weights.sum()


def densest(weights: np.ndarray, share: float) -> np.ndarray:
    """Return which points (n,) belong to the region of highest density that holds a share of the posterior."""
    order = np.argsort(weights)[::-1]
    inside = np.zeros(len(weights), bool)
    inside[order[: np.searchsorted(np.cumsum(weights[order]), share) + 1]] = True
    return inside


def recommended(points: np.ndarray, weights: np.ndarray) -> int:
    """Return which point is recommended: that of the densest half nearest to the posterior's mean.

    The mean of a curved family may lie outside it, and the densest point wanders along it with every simulation; this
    one does neither.
    """
    core = densest(weights, CORE_SHARE)
    distance = np.linalg.norm(points - weights @ points, axis=1)
    return int(np.argmin(np.where(core, distance, np.inf)))


def interval(values: np.ndarray, weights: np.ndarray, share: float = FAMILY_SHARE) -> tuple[float, float]:
    """Return the central interval of values (n,) that holds a share of the posterior."""
    order = np.argsort(values)
    cumulated = np.cumsum(weights[order])
    ends = np.searchsorted(cumulated, [(1.0 - share) / 2.0, (1.0 + share) / 2.0])
    low, high = values[order][np.minimum(ends, len(values) - 1)]
    return float(low), float(high)


def denser_shares(
    weights: np.ndarray, predicted: Predictions, measured: Mapping[str, Measured], others: Predictions
) -> np.ndarray:
    """Return the share (k,) of the posterior in points that are denser than k others, below 0.95 in the family.

    weights: (n,) of the points with the predictions `predicted`; others: predictions at the k, which need not be points
    of the posterior: the nearest one may be far off where the family is narrow
    """
    both = {name: tuple(map(np.concatenate, zip(each, others[name], strict=True))) for name, each in predicted.items()}
    density = posterior_weights(both, measured)
    return np.array([weights[density[: len(weights)] > value].sum() for value in density[len(weights) :]])
