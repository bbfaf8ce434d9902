"""Proposals of a search: the values that come next out of those that are allowed, from what was simulated so far.

The same tables give the same proposals, however often a search was interrupted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bulkwear.postproc.inference.improvement import Tried, best_of, next_designs
from bulkwear.postproc.inference.ranges import (
    SPREAD,
    Allowed,
    Range,
    each_once,
    points_of,
    spread_values,
    values_near,
    without,
)

NEAR, NEAR_COUNT = (0.05, 0.15), 32  # -, of the range: how far candidates lie about the best ones; of each, how many
BEST_KEPT = 3  # tried designs that candidates lie about


@dataclass(frozen=True, eq=False)
class Search:
    """A search so far.

    ranges: of the p factors; values: (n, p) of the designs that were simulated, also ones out of range
    tried: the same as points, with their results; allowed: says which values can be simulated
    """

    ranges: tuple[Range, ...]
    values: np.ndarray
    tried: Tried
    allowed: Allowed

    def candidates(self) -> np.ndarray:
        """Return values (m, p) that are allowed and were not tried: over the whole ranges, and about the best."""
        mean = self.tried.response.predict(self.tried.points)[0]
        late = self.tried.chance_within(self.tried.points) < 0.5
        best = self.values[np.lexsort((mean, late))[:BEST_KEPT]]
        seed = self.tried.seed + len(self.values)
        near = [values_near(self.ranges, best, reach, NEAR_COUNT, seed) for reach in NEAR]
        every = each_once(np.vstack([spread_values(self.ranges, SPREAD, seed), *near]))
        fresh = without(every, self.values)
        return fresh[self.allowed(fresh)]

    def proposed(self, count: int) -> np.ndarray:
        """Return up to `count` values to simulate next, by the improvement that is expected of them."""
        candidates = self.candidates()
        return candidates[next_designs(self.tried, points_of(self.ranges, candidates), count)]

    def best_predicted(self, chance: float) -> np.ndarray:
        """Return the values (p,) of the least predicted mean, tried or not, that keep to the limit with that chance."""
        every = np.vstack([self.values, self.candidates()])
        return every[best_of(self.tried, points_of(self.ranges, every), chance)]
