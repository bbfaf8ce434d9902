"""What is to be calibrated: parameters with their ranges, tests with their responses, and what was measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.stats import qmc


@dataclass(frozen=True)
class Parameter:
    """A parameter and the range in which it is looked for; every value in it is as likely before anything is known."""

    name: str
    low: float
    high: float


MODEL_DISCREPANCY = 2.0  # -, of the model over the deviation of a measurement, where nothing is known


@dataclass(frozen=True)
class Measured:
    """A measured response, its standard uncertainty, and that of the model, in the unit of the simulated one.

    discrepancy: standard deviation of what the model is off by even with the right parameters; None for
    MODEL_DISCREPANCY deviations, 0 for a model that is right
    """

    value: float
    deviation: float
    discrepancy: float | None = None

    @property
    def variance(self) -> float:
        """Variance of the measured about the simulated response: of the measurement and of the model, independent."""
        unknown = self.discrepancy is None
        return self.deviation**2 + (MODEL_DISCREPANCY * self.deviation if unknown else self.discrepancy) ** 2


@dataclass(frozen=True)
class Experiment:
    """A kind of simulation. responses: what it gives; initial: runs before the acquisition rule; most: in all."""

    name: str
    responses: tuple[str, ...]
    initial: int
    most: int


@dataclass(frozen=True)
class Problem:
    """A calibration.

    tests: in the order in which they are taken, cheap ones first; each goes on where the ones before leave doubt
    measured: by response; responses of tests that nobody measured are simulated and predicted, and constrain nothing
    parallel: simulations between two looks at the surrogate
    surrogate_share: stop when the surrogate's own variance is at most this share (see acquisition.py)
    seed: of the random points and of the simulations
    """

    parameters: tuple[Parameter, ...]
    tests: tuple[Experiment, ...]
    measured: Mapping[str, Measured]
    parallel: int = 2
    surrogate_share: float = 0.5
    seed: int = 1

    @property
    def names(self) -> list[str]:
        """Names of the parameters."""
        return [parameter.name for parameter in self.parameters]

    def to_unit(self, values: np.ndarray) -> np.ndarray:
        """Return (n, p) parameter values as points of the unit cube."""
        low, high = self._bounds
        return (np.asarray(values, float) - low) / (high - low)

    def from_unit(self, points: np.ndarray) -> np.ndarray:
        """Return (n, p) points of the unit cube as parameter values."""
        low, high = self._bounds
        return low + np.asarray(points, float) * (high - low)

    @property
    def _bounds(self) -> tuple[np.ndarray, np.ndarray]:
        return (
            np.array([parameter.low for parameter in self.parameters]),
            np.array([parameter.high for parameter in self.parameters]),
        )

    def spread_points(self, power: int) -> np.ndarray:
        """Return (2^power, p) points that fill the unit cube evenly (scrambled Sobol sequence, seeded)."""
        return qmc.Sobol(len(self.parameters), scramble=True, seed=self.seed).random_base2(power)

    def points_of(self, simulations: pd.DataFrame) -> np.ndarray:
        """Return the (n, p) points of the unit cube of a table of simulations."""
        return self.to_unit(simulations[self.names].to_numpy())
