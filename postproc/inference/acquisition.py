"""Which simulation comes next, when there are enough, and which test would tell the most."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.special import logsumexp

from bulkwear.postproc.inference.posterior import log_normal
from bulkwear.postproc.inference.problem import Measured
from bulkwear.postproc.inference.surrogate import Predictions, Surrogate, predictions

DRAWS = 1500  # from the posterior, for the expected information; its error is then below 0.1 bit


def log_likelihood_variance(predicted: Predictions, measured: Mapping[str, Measured]) -> np.ndarray:
    """Return the logarithm of the variance (n,) of the likelihood that the surrogate's doubt leaves at each point.

    For a normal likelihood with variance s2 of a response that is itself normal with mean m and variance v:
    E[L] = N(y; m, s2 + v), E[L^2] = N(y; m, s2/2 + v) / (2 sqrt(pi s2)); independent responses multiply. (M.
    Jaervenpaeae, M. U. Gutmann, A. Pleska, A. Vehtari and P. Marttinen, Bayesian Analysis 14 (2019) 595-622.)
    """
    mean_log, square_log = 0.0, 0.0
    for name, (mean, variance) in predicted.items():
        if name in measured:
            value, noise = measured[name].value, measured[name].variance
            mean_log = mean_log + log_normal(value, mean, noise + variance)
            square_log = square_log + log_normal(value, mean, noise / 2.0 + variance)
            square_log = square_log - np.log(2.0 * np.sqrt(np.pi * noise))
    return square_log + np.log1p(-np.exp(np.minimum(2.0 * mean_log - square_log, -1e-12)))


def next_points(
    points: np.ndarray, surrogates: Mapping[str, Surrogate], measured: Mapping[str, Measured], count: int
) -> np.ndarray:
    """Return the `count` points (count, p) to simulate next, out of (n, p) candidates.

    The rule: where the surrogate leaves most doubt about the likelihood: where a pair may fit and nobody knows. Of
    several at once each is chosen as if the ones before had been simulated and had given the surrogate's mean.
    """
    chosen = []
    for _ in range(count):
        doubt = log_likelihood_variance(predictions(surrogates, points), measured)
        chosen.append(points[int(np.argmax(doubt))])
        surrogates = {name: surrogate.with_point(chosen[-1]) for name, surrogate in surrogates.items()}
    return np.array(chosen)


def spread_over(points: np.ndarray, first: int, inside: np.ndarray, count: int) -> np.ndarray:
    """Return `count` points (count, p) of those `inside` (n,): from `first` on, always the farthest from all before."""
    candidates, chosen = points[inside], [points[first]]
    while len(chosen) < count:
        distance = np.linalg.norm(candidates[:, None] - np.array(chosen)[None], axis=2).min(axis=1)
        chosen.append(candidates[int(np.argmax(distance))])
    return np.array(chosen)


def surrogate_share(
    weights: np.ndarray, predicted: Predictions, measured: Mapping[str, Measured], responses: Sequence[str]
) -> float:
    """Return which share of the variance of the measured response is the surrogate's, in the posterior's mean.

    The rest is that of measurement and model; the largest of the given responses counts. The stopping rule: enough when
    it is at most `Problem.surrogate_share`; more simulations then sharpen the posterior less than these blur it.
    """
    shares = [
        float(weights @ (variance / (variance + measured[name].variance)))
        for name, (_, variance) in predicted.items()
        if name in responses and name in measured
    ]
    return max(shares, default=0.0)


def expected_information(
    weights: np.ndarray, predicted: Predictions, measured: Mapping[str, Measured], seed: int
) -> dict[str, float]:
    """Return {response: bits} that measuring it once more is expected to tell about the parameters.

    The mutual information between parameters, distributed as the posterior, and a response measured and modelled with
    its standard deviations: 0 where all of the family give the same, 1 bit where it halves the family. Nested Monte
    Carlo, seeded.
    """
    random = np.random.default_rng(seed)
    drawn = random.choice(len(weights), DRAWS, p=weights)
    bits = {}
    for name, (mean, variance) in predicted.items():
        if name not in measured:
            continue
        spread = measured[name].variance + variance[drawn]
        values = mean[drawn] + np.sqrt(spread) * random.standard_normal(DRAWS)
        logs = log_normal(values[:, None], mean[drawn][None], spread[None])
        gain = np.diag(logs) - (logsumexp(logs, axis=1) - np.log(DRAWS))
        bits[name] = max(float(gain.mean() / np.log(2.0)), 0.0)
    return bits
