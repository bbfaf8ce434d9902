"""Surrogate of a response: a Gaussian process over the parameters, with the scatter between seeds as noise.

C. E. Rasmussen and C. K. I. Williams, Gaussian Processes for Machine Learning, MIT Press 2006, chapters 2 and 5. With a
dozen simulations nobody knows the kernel's lengths, its amplitude and the scatter between seeds; taken at their most
likely values the process is too sure of itself. So predictions are means over draws from their posterior.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd
from scipy.linalg import cho_solve, solve_triangular
from scipy.stats import norm, qmc

from bulkwear.postproc.inference.problem import Problem

# Prior of the logarithms of a kernel's lengths (of the parameter's range), amplitude and noise (variances over that of
# the responses): median and standard deviation of each, log-normal.
LENGTH = (1.0, 1.0)
AMPLITUDE = (4.0, 1.5)
NOISE = (0.02, 1.7)
MEAN_VARIANCE = 4.0  # -, of the process' unknown mean over that of the responses
DRAWS_POWER = 10  # 1024 draws from the prior, and as many near the ones that fit
KERNELS = 16  # draws from the posterior that predictions are means over
DRAW_JITTER = 1e-8  # -, of the variance of draws at many points, for rounding
JITTER = 1e-9  # -, of the diagonal over the variance of the responses


@dataclass(frozen=True, eq=False)
class Surrogate:
    """A response of which simulations are known.

    points (n, p) in the unit cube; values (n,), noise (n, n), standardised: of the simulations, and the covariance of
    their errors; kernels (k, p + 2): lengths, amplitude and scatter between seeds of each draw; centre, scale: of
    the responses
    """

    points: np.ndarray
    values: np.ndarray
    noise: np.ndarray
    kernels: np.ndarray
    centre: float
    scale: float

    def predict(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return mean and variance (n,) of the response itself, scatter between seeds left out, at (n, p) points."""
        means, variances = (np.array(found) for found in zip(*self._of_kernels(points), strict=True))
        variance = variances.mean(axis=0) + means.var(axis=0)
        return self.centre + self.scale * means.mean(axis=0), self.scale**2 * variance

    @property
    def seed_deviation(self) -> float:
        """Standard deviation between simulations that differ in their seed only: the median of the draws."""
        return self.scale * float(np.sqrt(np.median(self.kernels[:, -1])))

    def draws(self, points: np.ndarray, of_each: int, seed: int) -> np.ndarray:
        """Return draws (n, k of_each) of the response itself at (n, p) points, `of_each` by each kernel; seeded."""
        chance, found = np.random.default_rng(seed), []
        for kernel, factor, weights in zip(self.kernels, *self._solved, strict=True):
            across = _covariance(points, self.points, kernel[None])[0]
            rest = solve_triangular(factor, across.T, lower=True, check_finite=False)
            left = _covariance(points, points, kernel[None])[0] - rest.T @ rest
            spread = np.linalg.cholesky(left + DRAW_JITTER * (kernel[-2] + MEAN_VARIANCE) * np.eye(len(points)))
            found.append((across @ weights)[:, None] + spread @ chance.standard_normal((len(points), of_each)))
        return self.centre + self.scale * np.hstack(found)

    @property
    def left_out_share(self) -> float:
        """Part (-) of the simulations' variance that the surrogate of all others explains of each; 0 for their mean.

        By the inverse of the covariance, without another fit (C. E. Rasmussen and C. K. I. Williams, 2006, Eq 5.12),
        mean over the kernels.
        """
        factors, weights = self._solved
        identity = np.eye(len(self.values))
        inverse = np.array([cho_solve((factor, True), identity).diagonal() for factor in factors])
        missed = (weights / inverse).mean(axis=0)
        spread = (self.values - self.values.mean()) * len(self.values) / (len(self.values) - 1.0)
        return 1.0 - float(missed @ missed) / float(spread @ spread)

    def with_point(self, point: np.ndarray) -> Surrogate:
        """Return the surrogate as if its own mean had been simulated at a point (p,): its doubt shrinks there."""
        mean = (self.predict(point[None])[0] - self.centre) / self.scale
        noise = np.pad(self.noise, (0, 1))
        noise[-1, -1] = np.median(self.noise.diagonal())
        return replace(self, points=np.vstack([self.points, point]), values=np.append(self.values, mean), noise=noise)

    def _of_kernels(self, points: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield standardised mean and variance (n,) at points by each kernel."""
        for kernel, factor, weights in zip(self.kernels, *self._solved, strict=True):
            across = _covariance(points, self.points, kernel[None])[0]
            rest = solve_triangular(factor, across.T, lower=True, check_finite=False)
            yield across @ weights, np.maximum(kernel[-2] + MEAN_VARIANCE - (rest**2).sum(axis=0), 0.0)

    @cached_property
    def _solved(self) -> tuple[np.ndarray, np.ndarray]:
        """Cholesky factors (k, n, n) of the simulations' covariance by each kernel; its inverse times the values."""
        factors = np.linalg.cholesky(_of_simulations(self.points, self.noise, self.kernels))
        return factors, np.array([cho_solve((factor, True), self.values) for factor in factors])


def _covariance(first: np.ndarray, second: np.ndarray, kernels: np.ndarray) -> np.ndarray:
    """Return the covariance (k, n, m) of the response between (n, p) and (m, p) points: Matern 5/2, and its mean's."""
    lengths, amplitude = kernels[:, None, :-2], kernels[:, -2, None, None]
    ours, theirs = first[None] / lengths, second[None] / lengths
    squared = (ours**2).sum(axis=2)[:, :, None] + (theirs**2).sum(axis=2)[:, None] - 2.0 * ours @ theirs.mT
    distance = np.sqrt(5.0 * np.maximum(squared, 0.0))
    return amplitude * (1.0 + distance + distance**2 / 3.0) * np.exp(-distance) + MEAN_VARIANCE


def _of_simulations(points: np.ndarray, noise: np.ndarray, kernels: np.ndarray) -> np.ndarray:
    """Return the covariance (k, n, n) of simulations: of the response, between seeds, and of the errors."""
    seeds = (kernels[:, -1] + JITTER)[:, None, None] * np.eye(len(points))
    return _covariance(points, points, kernels) + seeds + noise


# ---------------------------------------------------------------- fit


def fit_surrogate(points: np.ndarray, values: np.ndarray, noise: np.ndarray, seed: int) -> Surrogate:
    """Return the surrogate of a response from simulations.

    points: (n, p) in the unit cube; values: (n,) of the simulations; noise: (n, n), the covariance of their errors,
    diagonal where they share nothing. Kernels are drawn from their posterior by importance sampling, first from the
    prior, then from a normal about what fits; seeded.
    """
    count, centre = len(values), float(np.mean(values))
    shared = (noise.sum() - noise.trace()) / max(count * (count - 1), 1)  # by it the values do not differ
    doubt = float(np.sqrt(max(noise.trace() / count - shared, 0.0)))
    scale = max(float(np.std(values)), doubt, np.finfo(float).tiny)
    standardised, noise = (values - centre) / scale, noise / scale**2
    dimensions = points.shape[1] + 2
    middle = np.log([*(LENGTH[0] for _ in range(dimensions - 2)), AMPLITUDE[0], NOISE[0]])
    spread = np.diag([*(LENGTH[1] for _ in range(dimensions - 2)), AMPLITUDE[1], NOISE[1]])
    normal = norm.ppf(qmc.Sobol(dimensions, scramble=True, seed=seed).random_base2(DRAWS_POWER))

    def weighted(draws: np.ndarray, log_proposal: np.ndarray) -> np.ndarray:
        log_prior = -0.5 * (((draws - middle) / spread.diagonal()) ** 2).sum(axis=1)
        logs = log_prior - log_proposal + _log_evidence(points, standardised, noise, np.exp(draws))
        weights = np.exp(logs - logs.max())
        return weights / weights.sum()

    draws, log_proposal = middle + normal @ spread, -0.5 * (normal**2).sum(axis=1)
    weights = weighted(draws, log_proposal)
    found = weights @ draws
    covariance = (draws - found).T @ ((draws - found) * weights[:, None]) + 0.05 * spread**2
    draws = found + normal @ np.linalg.cholesky(covariance).T
    weights = weighted(draws, log_proposal)
    chosen = np.searchsorted(np.cumsum(weights), (np.arange(KERNELS) + 0.5) / KERNELS)
    return Surrogate(points, standardised, noise, np.exp(draws[np.minimum(chosen, len(draws) - 1)]), centre, scale)


def _log_evidence(points: np.ndarray, values: np.ndarray, noise: np.ndarray, kernels: np.ndarray) -> np.ndarray:
    """Return the logarithm (k,) of the density of standardised values (n,) under each kernel, but for a constant."""
    factors = np.linalg.cholesky(_of_simulations(points, noise, kernels))
    rest = np.linalg.solve(factors, np.broadcast_to(values[:, None], (len(kernels), len(values), 1)))[..., 0]
    return -0.5 * (rest**2).sum(axis=1) - np.log(np.diagonal(factors, axis1=1, axis2=2)).sum(axis=1)


def fit_surrogates(problem: Problem, simulations: pd.DataFrame) -> dict[str, Surrogate]:
    """Return {response: surrogate} of every response with simulations.

    simulations: a row per simulation: the parameters; per response its value, and its uncertainty as
    `<response>_uncertainty`; NaN where a simulation does not give it.
    """
    points = problem.points_of(simulations)
    found = {}
    for response in (name for test in problem.tests for name in test.responses):
        if response in simulations and (known := simulations[response].notna().to_numpy()).any():
            table = simulations[known]
            noise = np.diag(table[f"{response}_uncertainty"].to_numpy(float) ** 2)
            found[response] = fit_surrogate(points[known], table[response].to_numpy(float), noise, problem.seed)
    return found


Predictions = Mapping[str, tuple[np.ndarray, np.ndarray]]  # response -> mean and variance (n,) at the same points


def predictions(surrogates: Mapping[str, Surrogate], points: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return {response: (mean, variance)} at (n, p) points."""
    return {name: surrogate.predict(points) for name, surrogate in surrogates.items()}
