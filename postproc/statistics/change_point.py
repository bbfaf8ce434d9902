"""Where a run-in ends: the place of a series from which on it is level, with its interval, or that no run-in is found.

    value = level + slope max(end - place, 0) + noise

A broken line: a straight transient, then a level. Noises may be correlated with their neighbours, by how much is not
known: each quantity below is mixed over correlations as in `correlated`, with weights by the likelihood of the best
broken line of each.

Whether there is a run-in: the largest F statistic of a transient over all ends, against its own distribution in series
that are level all along (D. W. K. Andrews, Econometrica 61, 1993), drawn at each correlation. One test for all ends:
of level series 5 % have a run-in by chance, however many places there are. The interval holds all ends whose likelihood
ratio to the best one is not too small, by an F with two degrees of freedom above: an end is no regular parameter, with
one degree intervals miss weak transients two to four times too often. How often both fail, by simulation:
benchmarks/series_rates.py.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy import stats

from bulkwear.postproc.statistics.correlated import ROUNDING, weights_of, whitened
from bulkwear.postproc.statistics.intervals import CONFIDENCE

FEWEST_VALUES = 6
ERROR_RATE = 0.05  # -, of level series in which a run-in is found
MOVED = 2  # degrees of freedom above, of the ratio of likelihoods
DRAWS = 999  # level series per correlation
SEED = 20260101
ENDED, NOT_ENDED = "ended", "not ended within the run"
NONE_FOUND, UNSAID = "no run-in found", "cannot be said"


@dataclass(frozen=True)
class RunIn:
    """The run-in of a series.

    end: place from which on it is level; low, high: of its interval at 95 %; NaN where no run-in is found
    p_value: -, of a transient as clear as the one found in a series without; change: of the level from the first place
    to the end, in the unit of the series; answer: ENDED, NOT_ENDED (the interval holds the last place), NONE_FOUND or
    UNSAID (fewer than FEWEST_VALUES values)
    """

    end: float
    low: float
    high: float
    p_value: float
    change: float
    answer: str

    def text(self, unit: str) -> str:
        """Return the answer with its numbers; unit: of the places."""
        if self.answer in (NONE_FOUND, UNSAID):
            return self.answer
        interval = f"{100.0 * CONFIDENCE:.0f} % interval {self.low:g} to {self.high:g}"
        return f"ended at {unit} {self.end:g} ({interval})" if self.answer == ENDED else f"{self.answer} ({interval})"


def run_in(places: Sequence[float] | np.ndarray, values: Sequence[float] | np.ndarray) -> RunIn:
    """Return the run-in of a series of values (k,) at increasing places (k,); NaN values are left out.

    Ends are looked for at the places themselves, from the second to the last; at the last one the series is a straight
    line all along.
    """
    places, values = np.asarray(places, dtype=float), np.asarray(values, dtype=float)
    there = np.isfinite(values)
    places, values = places[there], values[there]
    if len(values) < FEWEST_VALUES:
        return RunIn(*[math.nan] * 5, UNSAID)
    shares, squares, slopes, weights = _broken_lines(places, values)
    if weights is None:
        return RunIn(math.nan, math.nan, math.nan, 1.0, 0.0, NONE_FOUND)
    found, drawn = shares.max(axis=1), _drawn(tuple(np.round((places - places[0]) / np.ptp(places), 9)))
    rarer = (1.0 + (drawn >= found[:, None]).sum(axis=1)) / (DRAWS + 1.0)
    p_value = float(weights @ rarer)
    if p_value > ERROR_RATE:
        return RunIn(math.nan, math.nan, math.nan, p_value, math.nan, NONE_FOUND)
    freedom, best = len(values) - 3, squares.min(axis=1, keepdims=True)
    ratios = (squares / np.maximum(best, ROUNDING * squares.max()) - 1.0) * freedom
    likely = weights @ stats.f.sf(np.maximum(ratios, 0.0) / MOVED, MOVED, freedom)
    place = int(np.argmax(likely))
    inside = np.flatnonzero(likely > 1.0 - CONFIDENCE)
    low, high = (float(places[1 + index]) for index in (inside[0], inside[-1]))
    change = -float(weights @ slopes[:, place]) * float(places[1 + place] - places[0])
    answer = NOT_ENDED if high == places[-1] else ENDED
    return RunIn(float(places[1 + place]), low, high, p_value, change, answer)


def _broken_lines(
    places: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray | None]:
    """Return of every correlation (m) and end (c) what share of the squares its transient explains, the squares that
    are left and the slope of the transient, (m, c) each, and the weights (m,) of the correlations; None for a series
    without scatter.
    """
    _, white, log = whitened(places, np.column_stack([np.ones(len(places)), _transients(places), values]))
    level, rest = white[..., :1], white[..., 1:]
    scale = (level**2).sum(axis=1, keepdims=True)
    rest = rest - level * (level * rest).sum(axis=1, keepdims=True) / scale
    transients, series = rest[..., :-1], rest[..., -1]
    sizes, products = (transients**2).sum(axis=1), np.einsum("mkc,mk->mc", transients, series)
    whole = (series**2).sum(axis=1)
    explained = products**2 / sizes
    squares = np.maximum(whole[:, None] - explained, ROUNDING * whole[:, None])
    if whole.min() <= ROUNDING * float((values**2).sum()):
        return explained, squares, products, None
    at = np.argmin(squares, axis=1)[:, None]
    best, size = (np.take_along_axis(table, at, axis=1)[:, 0] for table in (squares, sizes))
    weights = weights_of(
        log - 0.5 * np.log(scale[:, 0, 0]) - 0.5 * np.log(size) - 0.5 * (len(values) - 2) * np.log(best)
    )
    return explained / whole[:, None], squares, products / sizes, weights


def _transients(places: np.ndarray) -> np.ndarray:
    """Return max(end - place, 0) of every end from the second place to the last, (k, k - 1)."""
    return np.maximum(places[None, 1:] - places[:, None], 0.0)


@cache
def _drawn(places: tuple[float, ...]) -> np.ndarray:
    """Return the largest share of the squares that a transient explains in level series, (m, DRAWS)."""
    rng = np.random.default_rng(SEED)
    where = np.array(places)
    _, white, _ = whitened(where, np.column_stack([np.ones(len(where)), _transients(where)]))
    noise = rng.standard_normal((len(where), DRAWS))
    found = []
    for level, transients in zip(white[..., :1], white[..., 1:], strict=True):
        unit = level / np.sqrt((level**2).sum())
        rest, series = transients - unit @ (unit.T @ transients), noise - unit @ (unit.T @ noise)
        explained = (rest.T @ series) ** 2 / (rest**2).sum(axis=0)[:, None]
        found.append(explained.max(axis=0) / (series**2).sum(axis=0))
    return np.array(found)
