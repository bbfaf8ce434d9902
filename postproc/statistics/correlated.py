"""Regression on few values that follow one another along a travel and are correlated, by how much is not known.

    value_k = columns_k . coefficients + noise_k,   correlation of noises at a distance d apart: r^(d/d_mean)

A noise that forgets exponentially (AR(1) at even distances). With r known, generalised least squares and Student's t
are exact. A short series says little of r, and what is put in for it decides the error: an estimate of r is too small
on average and makes errors too short. So no r is chosen: the exact t distributions of all r between 0 and
LARGEST_CORRELATION are mixed with the weight that the series gives each of them (its restricted likelihood), from the
reference prior 1/sqrt(1 - r^2) (J. O. Berger and R.-Y. Yang, Econometric Theory 10, 1994). Negative r, of which errors
would be shorter, is not taken for known. The interval of the mixture is told as that of a Student's t with an error
and degrees of freedom of its own, which share its two-sided quantiles at 90 and 95 %.

How often the intervals miss, by simulation: benchmarks/series_rates.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from bulkwear.postproc.statistics.intervals import CONFIDENCE, Estimate

LARGEST_CORRELATION = 0.98  # -, of neighbours
NODES = 16  # of the correlation, between 0 and its largest
MATCHED = (0.90, 0.95)  # -, two-sided confidences at which error and freedom are those of the mixture
ROUNDING = 1e-12  # -, of the sum of squares: what is left below it has no scatter
PRECISION = 1e-6  # -, of quantiles
SPARE = 2  # degrees of freedom that must be left


@dataclass(frozen=True, eq=False)
class CorrelatedFit:
    """A regression at each correlation. m correlations, p coefficients.

    correlations, weights: (m,), the weights sum to 1; coefficients: (m, p); covariances: (m, p, p) of the coefficients
    over the variance; variances: (m,) of a value; freedom: values less coefficients
    """

    correlations: np.ndarray
    weights: np.ndarray
    coefficients: np.ndarray
    covariances: np.ndarray
    variances: np.ndarray
    freedom: int

    def mean(self, contrast: np.ndarray) -> float:
        """Return contrast (p,) . coefficients."""
        return float(self.weights @ (self.coefficients @ contrast))

    def of(self, contrast: np.ndarray, offset: np.ndarray | float = 0.0, further: np.ndarray | float = 0.0) -> Estimate:
        """Return the estimate of offset + contrast . coefficients, of this series (`packings` is 1).

        contrast: (p,), or (m, p) by correlation; offset: a number or (m,)
        further: (m,) variance by correlation, over that of a value, of what is to be met besides, such as later values
        """
        contrasts = np.broadcast_to(contrast, self.coefficients.shape)
        shares = np.einsum("mi,mij,mj->m", contrasts, self.covariances, contrasts) + further
        means = np.einsum("mi,mi->m", contrasts, self.coefficients) + offset
        return _as_t(means, np.sqrt(self.variances * shares), self)

    def ratio(self, upper: np.ndarray, lower: np.ndarray) -> Estimate:
        """Return upper . coefficients over lower . coefficients, its error to first order; unknown where that is 0."""
        below = self.mean(lower)
        if not below:
            return Estimate(math.nan, math.nan, 0, 1)
        found = self.mean(upper) / below
        error = self.of((upper - found * lower) / below)
        return Estimate(found, error.error, error.freedom, 1)

    def deviation(self, confidence: float = CONFIDENCE) -> tuple[float, float]:
        """Return the interval of the standard deviation of a value; both ends 0 where nothing is left of the series."""
        from scipy import special  # slow to import, and many pages read this module

        if not self.variances.max() > 0.0:
            return 0.0, 0.0
        squares = self.variances * self.freedom
        tails = 0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence
        least, most = (
            np.sqrt(squares.min() / special.chdtri(self.freedom, tails[0])),
            np.sqrt(squares.max() / special.chdtri(self.freedom, tails[1])),
        )

        def below(tried: float) -> float:
            return float(self.weights @ special.chdtrc(self.freedom, squares / tried**2))

        low, high = (_where(below, share, 0.999 * float(least), 1.001 * float(most)) for share in tails)
        return low, high


def correlated_fit(
    places: np.ndarray, values: np.ndarray, columns: np.ndarray, sizes: np.ndarray | None = None
) -> CorrelatedFit | None:
    """Return the `CorrelatedFit` of a series, or None for fewer values than columns and SPARE.

    places: (k,) increasing; values: (k,); columns: (k, p) of the regression
    sizes: (k,) over which each value is a mean, as lengths of travel: the variance goes with their inverse
    """
    count, terms = columns.shape
    if count < terms + SPARE:
        return None
    scale = np.ones(count) if sizes is None else np.sqrt(sizes / np.mean(sizes))
    correlations, white, log = whitened(places, np.column_stack([columns, values]) * scale[:, None])
    design, response = white[..., :-1], white[..., -1:]
    normal = np.swapaxes(design, 1, 2) @ design
    covariances = np.linalg.inv(normal)
    coefficients = (covariances @ (np.swapaxes(design, 1, 2) @ response))[..., 0]
    left = response[..., 0] - np.einsum("mkp,mp->mk", design, coefficients)
    squares = np.einsum("mk,mk->m", left, left)
    freedom = count - terms
    if squares.min() <= ROUNDING * float((values**2).sum()):
        weights, squares = np.full(NODES, 1.0 / NODES), np.zeros(NODES)
    else:
        weights = weights_of(log - 0.5 * np.linalg.slogdet(normal)[1] - 0.5 * freedom * np.log(squares))
    return CorrelatedFit(correlations, weights, coefficients, covariances, squares / freedom, freedom)


def whitened(places: np.ndarray, table: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the correlations (m,) of neighbours, a table (k, p) made white by each (m, k, p), and what making it so
    adds to the logarithm of the likelihood (m,).

    places: (k,) increasing, of the rows. The correlations have the same prior weight each.
    """
    distances = np.diff(places)
    angles = math.asin(LARGEST_CORRELATION) * (np.arange(NODES) + 0.5) / NODES
    correlations = np.sin(angles)  # even steps of the angle: the reference prior
    next_one = correlations[:, None] ** (distances / distances.mean())
    fresh = np.sqrt(1.0 - next_one**2)
    white = np.empty((NODES, *table.shape))
    white[:, 0] = table[0]
    white[:, 1:] = (table[None, 1:] - next_one[..., None] * table[None, :-1]) / fresh[..., None]
    return correlations, white, -np.log(fresh).sum(axis=1)


def weights_of(log_likelihood: np.ndarray) -> np.ndarray:
    """Return the weights (m,) of the correlations, which sum to 1."""
    weights = np.exp(log_likelihood - log_likelihood.max())
    return weights / weights.sum()


def _as_t(means: np.ndarray, errors: np.ndarray, fit: CorrelatedFit) -> Estimate:
    """Return the Student's t nearest to a mixture of them, at MATCHED."""
    value = float(fit.weights @ means)
    if not errors.max() > 0.0:
        return Estimate(value, 0.0, float(fit.freedom), 1)
    nearer, farther = _reaches(means - value, errors, fit)
    freedoms, ratios, quantiles = _ratio_table()
    freedom = float(np.exp(np.interp(farther / nearer, ratios[::-1], np.log(freedoms)[::-1])))
    return Estimate(
        value, farther / float(np.exp(np.interp(math.log(freedom), np.log(freedoms), quantiles))), freedom, 1
    )


def _reaches(means: np.ndarray, errors: np.ndarray, fit: CorrelatedFit) -> list[float]:
    """Return how far from 0 the shares MATCHED of a mixture reach to both sides."""
    from scipy import special  # slow to import, and many pages read this module

    def inside(tried: float) -> float:
        outer, inner = special.stdtr(fit.freedom, np.array([tried - means, -tried - means]) / errors)
        return float(fit.weights @ (outer - inner))

    most = float(np.abs(means).max() + errors.max() * special.stdtrit(fit.freedom, 0.5 + 0.5 * MATCHED[-1]))
    return [_where(inside, share, 0.0, most) for share in MATCHED]


def _where(rising: Callable[[float], float], share: float, low: float, high: float) -> float:
    """Return where a function that rises reaches a share between two places."""
    from scipy import optimize  # slow to import, and every page reads this module

    return float(optimize.brentq(lambda tried: rising(tried) - share, low, high, rtol=PRECISION, xtol=PRECISION * high))


@cache
def _ratio_table() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return degrees of freedom, the ratio of the quantiles at MATCHED, falling, and the logarithm of the outer one."""
    from scipy import special  # slow to import, and many pages read this module

    freedoms = np.geomspace(0.3, 1e4, 400)
    inner, outer = (special.stdtrit(freedoms, 0.5 + 0.5 * share) for share in MATCHED)
    return freedoms, outer / inner, np.log(outer)
