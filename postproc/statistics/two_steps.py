"""Terms of a definitive screening design in two steps: main effects first, then terms of second order within them.

B. Jones and C. J. Nachtsheim, "Effective design-based model selection for definitive screening designs",
Technometrics 59 (2017) 319-329. Every run has its mirror image, so the response is the sum of an odd part, in which
only main effects are, and an even one, in which only terms of second order are. What main effects leave of the odd
part is error (fake factors, that is, runs beyond those that the factors need), as is the scatter between repeated runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from bulkwear.postproc.statistics.model_search import Terms, best_by_size
from bulkwear.postproc.statistics.model_terms import Term, candidate_terms, term_columns, told_apart

MAIN_LEVELS = {1: 0.20, 2: 0.10}  # of significance, by degrees of freedom of the error: a test on few has no power
MAIN_LEVEL = 0.05  # with more of them
MIRRORED = 1e-6  # -, how near coded levels are that count as the same
SECOND_LEVEL = 0.20  # below it the even part still holds more than error
EVERY_SUBSET = 3  # active factors up to which all terms of second order may be taken; beyond, half of the room
WIDTH = 300  # subsets of each size that are followed: all of them up to four active factors


@dataclass(frozen=True)
class TwoSteps:
    """What the two steps find.

    mains, seconds: active main effects and terms of second order
    error: standard deviation of the error, from inactive main effects, fake factors and repeats; NaN if there are none
    error_freedom: its degrees of freedom; own_freedom: those of fake factors and repeats alone, 0 if there are none
    complete: False where the even part still holds more than error when no more terms may be taken
    """

    mains: tuple[Term, ...]
    seconds: tuple[Term, ...]
    error: float
    error_freedom: int
    own_freedom: int
    complete: bool

    @property
    def terms(self) -> tuple[Term, ...]:
        """Return all of them, main effects first."""
        return self.mains + self.seconds


@dataclass(frozen=True, eq=False)
class _Parts:
    """A response (n,) in its odd and even part, both (n,), with their degrees of freedom, and the sum of squares and
    degrees of freedom of the scatter between repeats.
    """

    odd: np.ndarray
    even: np.ndarray
    odd_freedom: int
    even_freedom: int
    repeats: float
    repeats_freedom: int


def two_steps(coded: np.ndarray, response: np.ndarray) -> TwoSteps:
    """Return the active terms of a design whose runs all have their mirror images.

    coded: (n, factors) in coded units; response: (n,) without gaps
    Raises ValueError for a run without its mirror image, or with another number of repeats than it, and for runs that
    cannot tell the main effects apart.
    """
    coded, response = np.asarray(coded, dtype=float), np.asarray(response, dtype=float)
    if np.linalg.matrix_rank(coded) < coded.shape[1]:
        raise ValueError(f"{len(coded)} runs cannot tell the main effects of {coded.shape[1]} factors apart")
    parts = _split(coded, response)
    active, own_freedom = _active_factors(coded, parts)
    mains = coded[:, active]
    freedom = parts.odd_freedom - len(active) + parts.repeats_freedom
    sum_of_errors = _rest(mains, parts.odd) + parts.repeats
    variance = sum_of_errors / freedom if freedom else np.nan
    seconds, complete = _active_seconds(coded, active, parts, variance, freedom) if len(active) else ((), True)
    return TwoSteps(
        mains=tuple((int(k),) for k in active),
        seconds=seconds,
        error=float(np.sqrt(variance)),
        error_freedom=freedom,
        own_freedom=own_freedom,
        complete=complete,
    )


def _split(coded: np.ndarray, response: np.ndarray) -> _Parts:
    levels = MIRRORED * np.round(coded / MIRRORED) + 0.0  # no -0
    settings, of_run, repeats = np.unique(levels, axis=0, return_inverse=True, return_counts=True)
    of_run = of_run.ravel()
    same = np.abs(settings[:, None] + settings[None]).max(axis=2) < MIRRORED
    mirror = np.where(same.any(axis=1), same.argmax(axis=1), -1)
    if (wrong := (mirror < 0) | (repeats != repeats[mirror])).any():
        run = int(np.flatnonzero(wrong[of_run])[0]) + 1
        raise ValueError(f"run {run} has no mirror image as often as itself, allowed are designs in which all have one")
    mean = np.bincount(of_run, response) / repeats
    odd, even = 0.5 * (mean - mean[mirror]), 0.5 * (mean + mean[mirror])
    centres = int((mirror == np.arange(len(settings))).sum())
    pairs = (len(settings) - centres) // 2
    return _Parts(
        odd=odd[of_run],
        even=even[of_run] - response.mean(),
        odd_freedom=pairs,
        even_freedom=pairs + centres - 1,
        repeats=float(((response - mean[of_run]) ** 2).sum()),
        repeats_freedom=len(response) - len(settings),
    )


def _rest(columns: np.ndarray, response: np.ndarray) -> float:
    """Return the sum of squares that columns leave of a response."""
    if not columns.shape[1]:
        return float(response @ response)
    left = response - columns @ np.linalg.lstsq(columns, response, rcond=None)[0]
    return float(left @ left)


def _active_factors(coded: np.ndarray, parts: _Parts) -> tuple[np.ndarray, int]:
    """Return the positions of factors with a main effect, and the degrees of freedom of fake factors and repeats."""
    inverse = np.linalg.pinv(coded.T @ coded)
    effects = inverse @ (coded.T @ parts.odd)
    gain = effects**2 / np.diag(inverse)  # what the odd part loses without the factor
    freedom = parts.odd_freedom - coded.shape[1] + parts.repeats_freedom
    if freedom <= 0:
        return _beyond_the_others(coded, parts, gain), 0
    variance = (_rest(coded, parts.odd) + parts.repeats) / freedom
    chance = stats.f.sf(gain / max(variance, np.finfo(float).tiny), 1, freedom)
    return np.flatnonzero(chance < MAIN_LEVELS.get(freedom, MAIN_LEVEL)), freedom


def _beyond_the_others(coded: np.ndarray, parts: _Parts, gain: np.ndarray) -> np.ndarray:
    """Return the factors with a main effect where nothing but other main effects tells the error.

    The largest effects are tested together against the rest, one, two, three of them; the smallest p value decides, if
    it is below `MAIN_LEVEL`.
    """
    order, whole = np.argsort(-gain, kind="stable"), float(parts.odd @ parts.odd)
    chances = []
    for count in range(1, len(order)):
        rest, left = _rest(coded[:, order[:count]], parts.odd), parts.odd_freedom - count
        ratio = ((whole - rest) / count) / max(rest / left, np.finfo(float).tiny)
        chances.append(stats.f.sf(ratio, count, left))
    best = int(np.argmin(chances))
    return np.sort(order[: best + 1]) if chances[best] < MAIN_LEVEL else order[:0]


def _active_seconds(
    coded: np.ndarray, active: np.ndarray, parts: _Parts, variance: float, freedom: int
) -> tuple[tuple[Term, ...], bool]:
    """Return the terms of second order in active factors after which the even part is no more than error, and whether
    it is: the best one, two, three of them, until an F test at `SECOND_LEVEL` finds no more.
    """
    terms = [tuple(int(active[k]) for k in term) for term in candidate_terms(len(active)) if len(term) == 2]
    terms, _ = told_apart(terms, coded)
    room = parts.even_freedom - 1 if len(active) <= EVERY_SUBSET else parts.even_freedom // 2
    for models in _best_subsets(terms, coded, parts.even, room):
        chosen = tuple(term for term, inside in zip(terms, models.chosen[0, 0], strict=True) if inside)
        left = parts.even_freedom - len(chosen)
        ratio = models.score[0, 0] / left / max(variance, np.finfo(float).tiny)
        if stats.f.sf(ratio, left, freedom) > SECOND_LEVEL:
            return chosen, True
    return chosen, False


def _best_subsets(terms: Sequence[Term], coded: np.ndarray, even: np.ndarray, most: int):
    """Yield the subset of each size, none first, that leaves the least sum of squares (its score)."""
    columns = term_columns(terms, coded)
    count = len(terms)
    free = np.zeros((count, count), dtype=bool), np.zeros(count, dtype=int)
    space = Terms(columns - columns.mean(axis=0), np.zeros(count, dtype=bool), *free)
    return best_by_size(space, even[None], min(most, count), WIDTH, lambda rest, total, mains, others: rest)
