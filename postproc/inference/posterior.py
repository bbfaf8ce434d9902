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


def distance_from(weights: np.ndarray, predicted: Predictions, measured: Mapping[str, Measured], index: int) -> dict:
    """Return how far a point is from what was measured, and from the family.

    For each response its deviation over the standard deviation of measurement, model and surrogate; and the share of
    the posterior in points that are denser than it: below 0.95 it belongs to the family.
    """
    deviations = {
        name: float((mean[index] - measured[name].value) / np.sqrt(measured[name].variance + variance[index]))
        for name, (mean, variance) in predicted.items()
        if name in measured
    }
    return {"deviations": deviations, "denser_share": float(weights[weights > weights[index]].sum())}
