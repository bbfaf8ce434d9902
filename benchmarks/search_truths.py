"""Responses in closed form that a search is tried on: where the least one lies under a limit is known.

Branin's function of two factors and Hartmann's of three and of six (L. C. W. Dixon and G. P. Szego, Towards Global
Optimisation 2, North-Holland 1978), and a hill in four, of which one hardly acts, as factors of a pattern do.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.stats import qmc

from bulkwear.postproc.inference.ranges import Range, points_of, values_of

STEPS, SAMPLES_POWER, SEED = 0.05, 14, 20170319  # -, of each factor's range; 2^14 designs that stand for all
HALF = 0.5  # -, of the mean of the factors: about half of all designs keep below it

Response = Callable[[np.ndarray], np.ndarray]  # (n, p) points of the unit cube -> (n,)


def branin(points: np.ndarray) -> np.ndarray:
    """Return Branin's function (n,) of points (n, 2), its ranges taken to 0 to 1; least 0.397887, at three places."""
    x, y = 15.0 * points[:, 0] - 5.0, 15.0 * points[:, 1]
    valley = y - 5.1 / (4.0 * math.pi**2) * x**2 + 5.0 / math.pi * x - 6.0
    return valley**2 + 10.0 * (1.0 - 1.0 / (8.0 * math.pi)) * np.cos(x) + 10.0


HEIGHTS = np.array([1.0, 1.2, 3.0, 3.2])
NARROW_3 = np.array([[3.0, 10.0, 30.0], [0.1, 10.0, 35.0], [3.0, 10.0, 30.0], [0.1, 10.0, 35.0]])
PLACES_3 = 1e-4 * np.array([[3689, 1170, 2673], [4699, 4387, 7470], [1091, 8732, 5547], [381, 5743, 8828]])
NARROW_6 = np.array(
    [[10, 3, 17, 3.5, 1.7, 8], [0.05, 10, 17, 0.1, 8, 14], [3, 3.5, 1.7, 10, 17, 8], [17, 8, 0.05, 10, 0.1, 14]]
)
PLACES_6 = 1e-4 * np.array(
    [
        [1312, 1696, 5569, 124, 8283, 5886],
        [2329, 4135, 8307, 3736, 1004, 9991],
        [2348, 1451, 3522, 2883, 3047, 6650],
        [4047, 8828, 8732, 5743, 1091, 381],
    ]
)


def hartmann_3(points: np.ndarray) -> np.ndarray:
    """Return Hartmann's function (n,) of points (n, 3); least -3.86278 at (0.114614, 0.555649, 0.852547)."""
    return _hartmann(points, NARROW_3, PLACES_3)


def hartmann_6(points: np.ndarray) -> np.ndarray:
    """Return Hartmann's function (n,) of points (n, 6); least -3.32237 at (0.201690, 0.150011, 0.476874, ...)."""
    return _hartmann(points, NARROW_6, PLACES_6)


def _hartmann(points: np.ndarray, narrow: np.ndarray, places: np.ndarray) -> np.ndarray:
    return -np.exp(-((points[:, None] - places) ** 2 * narrow).sum(axis=2)) @ HEIGHTS


def hill(points: np.ndarray) -> np.ndarray:
    """Return (n,) a valley in points (n, 4) that three factors decide and the fourth hardly, on a gentle wave."""
    near = ((points - [0.7, 0.3, 0.6, 0.2]) ** 2) @ [1.0, 0.6, 0.4, 0.15]
    return -0.5 * np.exp(-4.0 * near) + 0.1 * np.sin(5.0 * points[:, 0]) * points[:, 1]


def mean_of_factors(points: np.ndarray) -> np.ndarray:
    """Return (n,) the mean of the factors of points (n, p): the limited response."""
    return points.mean(axis=1)


@dataclass(frozen=True)
class Truth:
    """What a search looks for: the least of a response of so many factors, among designs on a grid whose mean of
    factors is at most HALF.
    """

    name: str
    response: Response
    factors: int

    @property
    def ranges(self) -> tuple[Range, ...]:
        """Return the factors' ranges, 0 to 1 in steps."""
        return tuple(Range(f"factor_{number}", 0.0, 1.0, STEPS) for number in range(1, self.factors + 1))

    def true_values(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return both responses (n,) of designs (n, p)."""
        return self.response(values), mean_of_factors(values)

    @cached_property
    def spread(self) -> tuple[float, float]:
        """Return the standard deviations of both responses over all designs."""
        return tuple(float(np.std(each)) for each in self.true_values(self._all))

    @cached_property
    def least(self) -> float:
        """Return the least response of a design that keeps to the limit."""
        near = self._allowed[np.argsort(self.response(self._allowed))[:8]]
        for _ in range(2 * self.factors):  # down to the neighbour on the grid that is less, one factor or two at a time
            moves = np.vstack([np.zeros((1, self.factors)), *(_pairs(self.factors) * STEPS,)])
            tried = values_of(self.ranges, points_of(self.ranges, (near[:, None] + moves).reshape(-1, self.factors)))
            tried = tried[(mean_of_factors(tried) <= HALF + 1e-9)]
            near = tried[np.argsort(self.response(tried), kind="stable")[:8]]
        return float(self.response(near).min())

    @cached_property
    def at_random(self) -> float:
        """Return the median response of designs that keep to the limit."""
        return float(np.median(self.response(self._allowed)))

    @cached_property
    def _all(self) -> np.ndarray:
        return values_of(self.ranges, qmc.Sobol(self.factors, scramble=True, seed=SEED).random_base2(SAMPLES_POWER))

    @property
    def _allowed(self) -> np.ndarray:
        return self._all[mean_of_factors(self._all) <= HALF]


def _pairs(count: int) -> np.ndarray:
    """Return every step (n, count) of -1, 0 or 1 in one factor or two."""
    moves = [
        first * np.eye(count)[i] + second * np.eye(count)[j]
        for i in range(count)
        for j in range(i + 1)
        for first in (-1.0, 1.0)
        for second in ((-1.0, 0.0, 1.0) if j < i else (0.0,))
    ]
    return np.unique(np.array(moves), axis=0)


TRUTHS = (
    Truth("Branin, 2 factors", branin, 2),
    Truth("Hartmann, 3 factors", hartmann_3, 3),
    Truth("hill, 4 factors", hill, 4),
    Truth("Hartmann, 6 factors", hartmann_6, 6),
)
