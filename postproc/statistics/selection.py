"""Choosing the terms of a regression by AICc among all models, how often chance would choose one
as good, and the best design by a model."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bulkwear.postproc.statistics.model_terms import Heredity, Term, obeys, term_columns
from bulkwear.postproc.statistics.regression import SINGULAR, Fit, aicc, fit

MOST_TERMS = 4
AS_GOOD = 2.0  # AICc above the best up to which a model is as good (K. P. Burnham and D. R. Anderson, 2002)
MODELS_AT_A_TIME = 20_000  # bounds memory: 8 bytes x runs x terms x models
RESPONSES_AT_A_TIME = 100  # of permuted responses, likewise
PERMUTATIONS = 999
ROUNDS = 50  # of the search, each over all factors; a quadratic of few factors settles in a handful
SETTLED = 1e-10  # -, largest change of a coded level in a round


@dataclass(frozen=True)
class Choice:
    """A model of a search: its terms and its AICc."""

    terms: tuple[Term, ...]
    aicc: float


@dataclass(frozen=True, eq=False)
class Search:
    """What models are chosen from: candidate terms that the runs tell apart, and the runs.

    coded: (n, factors) in coded units; response: (n,) without gaps
    most: terms of a model; heredity: which models are models at all
    """

    terms: Sequence[Term]
    coded: np.ndarray
    response: np.ndarray
    most: int = MOST_TERMS
    heredity: Heredity = "none"

    @property
    def columns(self) -> np.ndarray:
        """Return the columns of the terms about their means, (n, terms)."""
        columns = term_columns(self.terms, self.coded)
        return columns - columns.mean(axis=0)

    @property
    def centred(self) -> np.ndarray:
        """Return the response about its mean, (n,)."""
        response = np.asarray(self.response, dtype=float)
        return response - response.mean()

    def models(self) -> Iterator[np.ndarray]:
        """Yield all models, see `all_models`."""
        return all_models(self.terms, len(self.response), self.most, self.heredity)


@dataclass(frozen=True)
class PermutationTest:
    """What a search finds in responses dealt to the runs at random.

    permutations: how many were tried
    model_p: share of them, the observed one counted, in which the best model explains as much by AICc
    term_p: {term: share in which the best model has a term with as large a t value}; for each term of the best model
    r_squared: (permutations,) R2 of the best models
    """

    permutations: int
    model_p: float
    term_p: dict[Term, float]
    r_squared: np.ndarray


def all_models(
    terms: Sequence[Term], runs: int, most: int = MOST_TERMS, heredity: Heredity = "none"
) -> Iterator[np.ndarray]:
    """Yield the models of up to `most` terms, size by size, as positions in `terms`: (models, size) each time.

    Sizes that AICc cannot judge with that many runs are left out.
    """
    for size in range(largest_size(len(terms), runs, most) + 1):
        choices = itertools.combinations(range(len(terms)), size)
        for count in _pieces(math.comb(len(terms), size)):
            flat = itertools.chain.from_iterable(itertools.islice(choices, count))
            block = np.fromiter(flat, dtype=np.intp, count=count * size).reshape(count, size)
            block = block[obeys(block, terms, heredity)]
            if len(block):
                yield block


def largest_size(terms: int, runs: int, most: int = MOST_TERMS) -> int:
    """Return how many terms a model may have: AICc needs four runs more than terms."""
    return max(min(most, terms, runs - 4), 0)


def _pieces(total: int) -> Iterator[int]:
    for start in range(0, total, MODELS_AT_A_TIME):
        yield min(MODELS_AT_A_TIME, total - start)


def _bases(choices: np.ndarray, centred: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return orthonormal bases (models, runs, size) of the models' columns, and which models have full rank."""
    stacked = np.moveaxis(centred[:, choices], 0, 1)
    basis, triangle = np.linalg.qr(stacked)
    diagonal = np.abs(np.diagonal(triangle, axis1=1, axis2=2))
    size = np.linalg.norm(stacked, axis=1)
    return basis, (diagonal > SINGULAR * np.maximum(size, SINGULAR)).all(axis=1)


def _scores(choices: np.ndarray, centred: np.ndarray, responses: np.ndarray) -> np.ndarray:
    """Return the AICc (models, responses) of every model for every response about its mean, (responses, runs)."""
    runs, size = len(centred), choices.shape[1]
    total = (responses**2).sum(axis=1)
    if size == 0:
        return aicc(total, total, runs, 0)[None]
    basis, whole = _bases(choices, centred)
    shares = np.moveaxis(basis, 1, 2).reshape(-1, runs) @ responses.T
    explained = (shares**2).reshape(len(choices), size, -1).sum(axis=1)
    scores = aicc(total - explained, total, runs, size)
    scores[~whole] = np.inf
    return scores


def best_models(search: Search, within: float = AS_GOOD) -> list[Choice]:
    """Return every model whose AICc is within that of the best by `within`, best first, of all of a search.

    Models whose terms the runs cannot tell apart are no models. Raises ValueError for fewer than four runs.
    """
    if len(search.response) < 4:
        raise ValueError(f"{len(search.response)} runs with a result, allowed are four or more to choose a model")
    terms, columns, centred = search.terms, search.columns, search.centred
    found: list[Choice] = []
    for choices in search.models():
        scores = _scores(choices, columns, centred[None])[:, 0]
        best = min([scores.min(), *(choice.aicc for choice in found)])
        found = [choice for choice in found if choice.aicc <= best + within]
        for position in np.flatnonzero(scores <= best + within):
            found.append(Choice(tuple(terms[k] for k in choices[position]), float(scores[position])))
    return sorted(found, key=lambda choice: (choice.aicc, len(choice.terms)))


def permutation_test(search: Search, permutations: int = PERMUTATIONS, seed: int = 0) -> PermutationTest:
    """Return how good a model the same search finds when the response has nothing to do with the factors.

    The whole selection is repeated for every permutation of the response over the runs. Seeded.
    Raises ValueError as `best_models`.
    """
    best = best_models(search, within=0.0)[0]
    centred = search.centred
    dealt = np.random.default_rng(seed).permuted(np.tile(centred, (permutations, 1)), axis=1)
    parts = [dealt[k : k + RESPONSES_AT_A_TIME] for k in range(0, permutations, RESPONSES_AT_A_TIME)]
    found = [_best_of_each(search, part) for part in parts]
    scores = np.concatenate([score for score, _ in found])
    models = [model for _, chosen in found for model in chosen]
    fits = [fit([search.terms[k] for k in model], search.coded, y) for model, y in zip(models, dealt, strict=True)]
    largest = np.array([np.abs(each.t_values[1:]).max(initial=0.0) for each in fits])
    total = centred @ centred
    model = fit(best.terms, search.coded, centred)
    count = permutations + 1
    return PermutationTest(
        permutations=permutations,
        model_p=float((1 + (scores <= best.aicc + SINGULAR).sum()) / count),
        term_p={
            term: float((1 + (largest >= abs(t) * (1.0 - SINGULAR)).sum()) / count)
            for term, t in zip(best.terms, model.t_values[1:], strict=True)
        },
        r_squared=np.array([1.0 - each.residual_sum / total for each in fits]) if total else np.zeros(permutations),
    )


def _best_of_each(search: Search, responses: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return the lowest AICc (responses,) of each response and the positions of the terms of the model that has it."""
    scores = np.full(len(responses), np.inf)
    models: list[np.ndarray] = [np.empty(0, dtype=np.intp)] * len(responses)
    columns = search.columns
    for choices in search.models():
        each = _scores(choices, columns, responses)
        best = each.argmin(axis=0)
        lowest = each[best, np.arange(len(responses))]
        for k in np.flatnonzero(lowest < scores):
            models[k] = choices[best[k]]
        scores = np.minimum(scores, lowest)
    return scores, models


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
