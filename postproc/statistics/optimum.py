"""The best design by a model inside the ranges of its factors."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np

from bulkwear.postproc.statistics.model_terms import term_columns
from bulkwear.postproc.statistics.regression import Fit

ROUNDS = 50  # of the search, each over all factors; a quadratic of few factors settles in a handful
SETTLED = 1e-10  # -, largest change of a coded level in a round


def best_design(model: Fit, factors: int, fixed: Mapping[int, float] | None = None) -> np.ndarray:
    """Return the design with the least response by a model, (factors,) coded, each level from -1 to 1.

    fixed: coded levels of factors that are given, by position, also beyond -1 and 1
    Factors that the model does not have stay at 0: it says nothing about them.

    Every corner, middle of an edge, face and body is a start; from each, one factor after the other goes to where the
    model is least along it (a parabola at most), until nothing moves.
    """
    given = dict(fixed or {})
    free = sorted({k for term in model.terms for k in term} - set(given))
    starts = np.zeros((3 ** len(free), factors))
    starts[:, free] = list(itertools.product((-1.0, 0.0, 1.0), repeat=len(free)))
    starts[:, list(given)] = list(given.values())
    for _ in range(ROUNDS):
        before = starts.copy()
        for factor in free:
            starts[:, factor] = _least_along(model, starts, factor)
        if np.abs(starts - before).max(initial=0.0) < SETTLED:
            break
    return starts[_responses(model, starts).argmin()]


def _responses(model: Fit, coded: np.ndarray) -> np.ndarray:
    return model.coefficients[0] + term_columns(model.terms, coded) @ model.coefficients[1:]


def _least_along(model: Fit, places: np.ndarray, factor: int) -> np.ndarray:
    """Return the level (k,) of a factor in -1 to 1 with the least response, the others held."""
    levels = np.array([-1.0, 0.0, 1.0])
    trial = np.repeat(places[None], 3, axis=0)
    trial[:, :, factor] = levels[:, None]
    low, middle, high = (_responses(model, each) for each in trial)
    slope, curvature = 0.5 * (high - low), 0.5 * (high + low) - middle
    curved = curvature > 0.0
    vertex = np.divide(-0.5 * slope, curvature, out=np.zeros_like(slope), where=curved)
    ends = np.where(slope == 0.0, np.where(curvature < 0.0, 1.0, places[:, factor]), -np.sign(slope))
    return np.where(curved, np.clip(vertex, -1.0, 1.0), ends)
