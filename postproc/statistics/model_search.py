"""Search among all models of some terms, size by size, for those of least score; of many responses at once.

Models of a size are those of the size before with one term more that heredity allows. Of each size the best `width`
are followed. Where no size has more models than that, every model is seen; else a model can be missed, if all ways to
it lead over models that are worse than `width` others of their size.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

INDEPENDENT = 1e-9  # -, least share of a column's sum of squares that the terms before it must leave

Score = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""Of sums of squares of residuals, those of the responses, and numbers of main effects and of second-order terms."""


@dataclass(frozen=True, eq=False)
class Models:
    """Models of one size of each of R responses, B each, best first.

    score: (R, B), infinite where a response has fewer models than B; lower is better
    chosen: (R, B, T) which of T terms a model has
    """

    score: np.ndarray
    chosen: np.ndarray


@dataclass(frozen=True, eq=False)
class Terms:
    """The terms of a search.

    columns: (n, T) about the mean
    main: (T,) True for main effects
    parents: (T, T) True at [t, p] where p is a main effect of a factor of the second-order term t
    least: (T,) how many of its parents a model must have before it may take a term
    """

    columns: np.ndarray
    main: np.ndarray
    parents: np.ndarray
    least: np.ndarray

    @property
    def unit(self) -> np.ndarray:
        """Return the columns at length one, (n, T); nothing where a term does not change."""
        size = np.linalg.norm(self.columns, axis=0)
        return self.columns / np.where(size > 0.0, size, 1.0)

    @property
    def labels(self) -> np.ndarray:
        """Return a random whole number per term, (T,), whose sum tells models apart."""
        return np.random.default_rng(0).integers(1, 2**63, len(self.main), dtype=np.uint64)


@dataclass(frozen=True, eq=False)
class _Beam:
    """Models with what further terms need.

    residuals: (R, B, n); left: (R, B, T) share of each unit column's square that the model leaves
    bases: (R, B, size, n) orthonormal; mains: (R, B) numbers of main effects; labels: (R, B)
    """

    models: Models
    residuals: np.ndarray
    left: np.ndarray
    bases: np.ndarray
    mains: np.ndarray
    labels: np.ndarray


def best_by_size(terms: Terms, responses: np.ndarray, most: int, width: int, score: Score) -> Iterator[Models]:
    """Yield the best `width` models of no term, of one, and so on up to `most`, of each response about its mean (R, n).

    Models whose columns the runs cannot tell apart are no models.
    """
    total = (responses**2).sum(axis=1)
    beam = _start(terms, responses, total, score)
    yield beam.models
    for size in range(1, most + 1):
        scores = _children(beam, terms, total, size, score)
        labels = (beam.labels[:, :, None] + terms.labels).reshape(len(total), -1)
        beam = _followed(beam, terms, *_best_of_different(scores.reshape(len(total), -1), labels, size, width))
        if not np.isfinite(beam.models.score).any():
            return
        yield beam.models


def _start(terms: Terms, responses: np.ndarray, total: np.ndarray, score: Score) -> _Beam:
    (runs, count), lines = terms.columns.shape, len(responses)
    none = np.zeros((lines, 1), dtype=int)
    return _Beam(
        models=Models(score(total[:, None], total[:, None], none, none), np.zeros((lines, 1, count), dtype=bool)),
        residuals=responses[:, None, :],
        left=np.broadcast_to((terms.unit**2).sum(axis=0), (lines, 1, count)),
        bases=np.zeros((lines, 1, 0, runs)),
        mains=none,
        labels=np.zeros((lines, 1), dtype=np.uint64),
    )


def _children(beam: _Beam, terms: Terms, total: np.ndarray, size: int, score: Score) -> np.ndarray:
    """Return the scores (R, B, T) of the models of a beam with one term more, infinite where that is no model."""
    chosen = beam.models.chosen
    allowed = ~chosen & (beam.left > INDEPENDENT) & np.isfinite(beam.models.score)[:, :, None]
    if terms.least.any():
        allowed &= chosen.astype(np.float32) @ terms.parents.T.astype(np.float32) >= terms.least
    along = beam.residuals @ terms.unit
    gain = np.divide(along**2, beam.left, out=np.zeros_like(along), where=allowed)
    rest = np.maximum((beam.residuals**2).sum(axis=2)[:, :, None] - gain, 0.0)
    mains = beam.mains[:, :, None] + terms.main
    return np.where(allowed, score(rest, total[:, None, None], mains, size - mains), np.inf)


def _best_of_different(
    scores: np.ndarray, labels: np.ndarray, repeats: int, width: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return positions, scores (R, B) of the best `width` of different labels; one comes `repeats` times at most."""
    few = min(width * repeats, scores.shape[1])
    places = np.argpartition(scores, few - 1, axis=1)[:, :few]
    near, names = (np.take_along_axis(each, places, 1) for each in (scores, labels))
    order = np.lexsort((near, names), axis=1)
    places, near, names = (np.take_along_axis(each, order, 1) for each in (places, near, names))
    near[:, 1:][names[:, 1:] == names[:, :-1]] = np.inf
    best = np.argsort(near, axis=1, kind="stable")[:, :width]
    return np.take_along_axis(places, best, 1), np.take_along_axis(near, best, 1)


def _followed(beam: _Beam, terms: Terms, places: np.ndarray, scores: np.ndarray) -> _Beam:
    """Return the beam of the children at some places (R, B), of all that `_children` tells, with their scores."""
    parent, term = places // len(terms.main), places % len(terms.main)
    lines = np.arange(len(places))[:, None]
    chosen = beam.models.chosen[lines, parent]
    np.put_along_axis(chosen, term[:, :, None], True, 2)
    bases, residuals = beam.bases[lines, parent], beam.residuals[lines, parent]
    unit = terms.unit
    new = unit.T[term]
    for _ in range(2):  # the second time for what rounding leaves
        new = new - ((bases @ new[:, :, :, None]).swapaxes(2, 3) @ bases)[:, :, 0]
    new = new / np.maximum(np.linalg.norm(new, axis=2, keepdims=True), INDEPENDENT)
    return _Beam(
        models=Models(scores, chosen),
        residuals=residuals - (new * residuals).sum(axis=2, keepdims=True) * new,
        left=beam.left[lines, parent] - (new @ unit) ** 2,
        bases=np.concatenate([bases, new[:, :, None]], axis=2),
        mains=beam.mains[lines, parent] + terms.main[term],
        labels=beam.labels[lines, parent] + terms.labels[term],
    )
