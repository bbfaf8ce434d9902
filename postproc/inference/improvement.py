"""Noisy Bayesian optimisation under a limit: which designs to simulate next, and what is known of the best one.

Looked for is the least of a response where a second one keeps to a limit, both known from simulations that scatter.
A design is worth simulating for the improvement that it is expected to bring over the least of the tried designs. As
nobody knows that one exactly, all of them are drawn together from the surrogates, and improvements are means over the
draws: noisy expected improvement (B. Letham, B. Karrer, G. Ottoni and E. Bakshy, Bayesian Analysis 14, 2019, 495-519).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.stats import norm

from bulkwear.postproc.inference.surrogate import Surrogate, fit_surrogate

DRAWS_OF_KERNEL = 16  # of each kernel of a surrogate; 256 draws in all with its 16
INTERVAL = 1.959964  # standard deviations that 95 % of a normal distribution lie within


@dataclass(frozen=True, eq=False)
class Tried:
    """Designs that were simulated.

    points: (n, p) in the unit cube; values: (n,) of the response that shall be least; noise: (n, n), the covariance of
    their errors; limited, limited_noise: the same of the one that shall be at most `limit`
    seed: of all draws
    """

    points: np.ndarray
    values: np.ndarray
    noise: np.ndarray
    limited: np.ndarray
    limited_noise: np.ndarray
    limit: float
    seed: int = 1

    @cached_property
    def response(self) -> Surrogate:
        """Surrogate of the response that shall be least."""
        return fit_surrogate(self.points, self.values, self.noise, self.seed)

    @cached_property
    def limited_response(self) -> Surrogate:
        """Surrogate of the one that has a limit."""
        return fit_surrogate(self.points, self.limited, self.limited_noise, self.seed)

    def chance_within(self, points: np.ndarray) -> np.ndarray:
        """Return the probability (m,) that designs (m, p) keep to the limit."""
        mean, variance = self.limited_response.predict(points)
        return norm.cdf((self.limit - mean) / np.sqrt(np.maximum(variance, np.finfo(float).tiny)))

    def interval(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the predicted mean of the response (m,) and both ends of its 95 % interval, scatter left out."""
        mean, variance = self.response.predict(points)
        reach = INTERVAL * np.sqrt(variance)
        return mean, mean - reach, mean + reach


def next_designs(tried: Tried, candidates: np.ndarray, count: int) -> list[int]:
    """Return which of the candidates (m, p) to simulate next, up to `count` of them, the most promising first.

    Each improves on the least of those tried and those chosen before it, in the same draw. In a draw in which none of
    them keeps to the limit, any that does improves on the largest value.
    """
    points, known = np.vstack([tried.points, candidates]), len(tried.points)
    drawn = tried.response.draws(points, DRAWS_OF_KERNEL, tried.seed)
    within = tried.limited_response.draws(points, DRAWS_OF_KERNEL, tried.seed + 1) <= tried.limit
    least = np.where(within[:known], drawn[:known], np.inf).min(axis=0)
    least = np.where(np.isfinite(least), least, drawn.max(axis=0))
    chosen: list[int] = []
    for _ in range(min(count, len(candidates))):
        gain = (np.maximum(least - drawn[known:], 0.0) * within[known:]).mean(axis=1)
        gain[chosen] = -1.0
        chosen.append(int(np.argmax(gain)))
        own, keeps = drawn[known + chosen[-1]], within[known + chosen[-1]]
        least = np.where(keeps, np.minimum(least, own), least)
    return chosen


def best_of(tried: Tried, points: np.ndarray, chance: float) -> int:
    """Return which of some designs (m, p) has the least predicted mean, of those that keep to the limit with that
    chance or more; where none does, the one that does so most likely.
    """
    sure = tried.chance_within(points)
    if not (sure >= chance).any():
        return int(np.argmax(sure))
    return int(np.argmin(np.where(sure >= chance, tried.response.predict(points)[0], np.inf)))
