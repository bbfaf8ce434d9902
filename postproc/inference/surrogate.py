"""Surrogate of a response: a Gaussian process over the parameters, with the scatter between seeds as noise.

C. E. Rasmussen and C. K. I. Williams, Gaussian Processes for Machine Learning, MIT Press 2006, chapters 2 and 5.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

from bulkwear.postproc.inference.problem import Problem

SMOOTHNESS = 2.5  # of the Matern kernel: twice differentiable, as responses of friction are
LENGTH_BOUNDS = (0.15, 5.0)  # -, of the parameter's range: neither shorter than the spacing of points nor a plane
AMPLITUDE_BOUNDS = (0.1, 30.0)  # -, variance of the process over that of the responses
NOISE_BOUNDS = (1e-4, 0.5)  # -, variance between seeds over that of the responses
RESTARTS = 4  # of the search for the kernel's parameters


@dataclass(frozen=True, eq=False)
class Surrogate:
    """A fitted response. centre, scale: of the responses, which the process sees standardised."""

    process: GaussianProcessRegressor
    centre: float
    scale: float

    def predict(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return mean and variance (n,) of the response itself, scatter between seeds left out, at (n, p) points."""
        mean, deviation = self.process.predict(points, return_std=True)
        variance = np.maximum(deviation**2 - self._noise, 0.0)
        return self.centre + self.scale * mean, self.scale**2 * variance

    @property
    def seed_deviation(self) -> float:
        """Standard deviation between simulations that differ in their seed only, as fitted."""
        return self.scale * float(np.sqrt(self._noise))

    @property
    def _noise(self) -> float:
        return float(self.process.kernel_.k2.noise_level)

    def with_point(self, point: np.ndarray) -> Surrogate:
        """Return the surrogate as if its own mean had been simulated at a point (p,): its doubt shrinks there."""
        points = np.vstack([self.process.X_train_, point])
        values = np.append(self.process.y_train_, self.process.predict(point[None])[0])
        alpha = np.append(self.process.alpha, np.median(self.process.alpha))
        process = GaussianProcessRegressor(self.process.kernel_, alpha=alpha, optimizer=None).fit(points, values)
        return Surrogate(process, self.centre, self.scale)


def fit_surrogate(points: np.ndarray, values: np.ndarray, uncertainties: np.ndarray, seed: int) -> Surrogate:
    """Return the surrogate of a response from simulations.

    points: (n, p) in the unit cube; values, uncertainties: (n,) of the measurement on each simulation. The scatter
    between seeds is found by maximum likelihood, with the kernel's amplitude and lengths.
    """
    centre, scale = float(np.mean(values)), max(float(np.std(values)), np.finfo(float).tiny)
    kernel = ConstantKernel(1.0, AMPLITUDE_BOUNDS) * Matern(
        [0.7] * points.shape[1], LENGTH_BOUNDS, nu=SMOOTHNESS
    ) + WhiteKernel(0.02, NOISE_BOUNDS)
    process = GaussianProcessRegressor(
        kernel, alpha=(uncertainties / scale) ** 2 + 1e-10, n_restarts_optimizer=RESTARTS, random_state=seed
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # a parameter at its bound: the bounds are meant
        process.fit(points, (values - centre) / scale)
    return Surrogate(process, centre, scale)


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
            errors = table[f"{response}_uncertainty"].to_numpy(float)
            found[response] = fit_surrogate(points[known], table[response].to_numpy(float), errors, problem.seed)
    return found


Predictions = Mapping[str, tuple[np.ndarray, np.ndarray]]  # response -> mean and variance (n,) at the same points


def predictions(surrogates: Mapping[str, Surrogate], points: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return {response: (mean, variance)} at (n, p) points."""
    return {name: surrogate.predict(points) for name, surrogate in surrogates.items()}
