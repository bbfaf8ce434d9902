"""Choosing the terms of a regression among all models, and how often chance would choose one as good.

The choice is by the corrected Bayesian criterion with what it costs to choose among many models (`regression`), under
strong heredity, up to as many terms as the runs allow. docs/selection_error_rates.md tells how often that errs, and
how often AICc would.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bulkwear.postproc.statistics.model_search import Models, Score, Terms, best_by_size
from bulkwear.postproc.statistics.model_terms import Heredity, Term, parents_of, term_columns
from bulkwear.postproc.statistics.regression import SINGULAR, aicc, bic_corrected, fit

AS_GOOD = 2.0  # of the criterion, above the best, up to which a model is as good (K. P. Burnham, D. R. Anderson, 2002)
WIDTH = 60  # models of each size that a search follows
SHARE_OF_CHOICE = 0.75  # of twice ln(models of a shape), the price of choosing among them
CHILDREN_AT_A_TIME = 1_000_000  # bounds memory: some 100 bytes for each model that is scored
PERMUTATIONS = 999

Criterion = Literal["extended_bic", "aicc"]


@dataclass(frozen=True)
class Choice:
    """A model of a search: its terms and its score by the criterion of the search."""

    terms: tuple[Term, ...]
    score: float


@dataclass(frozen=True, eq=False)
class Search:
    """What models are chosen from, and by what.

    terms: candidates that the runs tell apart; coded: (n, factors) in coded units; response: (n,) without gaps
    most: terms of a model, None for as many as the runs allow; heredity: which models are models at all
    criterion: by which models are compared; width: models of each size that are followed, see `model_search`
    """

    terms: Sequence[Term]
    coded: np.ndarray
    response: np.ndarray
    most: int | None = None
    heredity: Heredity = "strong"
    criterion: Criterion = "extended_bic"
    width: int = WIDTH

    @property
    def centred(self) -> np.ndarray:
        """Return the response about its mean, (n,)."""
        response = np.asarray(self.response, dtype=float)
        return response - response.mean()

    def of_sizes(self, responses: np.ndarray) -> Iterator[Models]:
        """Yield the best models of each size for other responses about their means, (R, n); see `best_by_size`."""
        columns = term_columns(self.terms, self.coded)
        parents, least = parents_of(self.terms, self.heredity)
        main = np.array([len(term) == 1 for term in self.terms], dtype=bool)
        terms = Terms(columns - columns.mean(axis=0), main, parents, least)
        most = largest_size(len(self.terms), len(self.response), self.most)
        return best_by_size(terms, responses, most, self.width, score_of(self))


@dataclass(frozen=True)
class PermutationTest:
    """What a search finds in responses dealt to the runs at random.

    permutations: how many were tried
    model_p: share of them, the observed one counted, in which the best model is as good by the criterion
    term_p: {term: share in which the best model has a term with as large a t value}; for each term of the best model
    r_squared: (permutations,) R2 of the best models
    """

    permutations: int
    model_p: float
    term_p: dict[Term, float]
    r_squared: np.ndarray


def largest_size(terms: int, runs: int, most: int | None = None) -> int:
    """Return how many terms a model may have: both criteria need four runs more than terms."""
    return max(min(terms if most is None else most, terms, runs - 4), 0)


def score_of(search: Search) -> Score:
    """Return the criterion of a search as a function of what `model_search` knows of a model."""
    runs = len(search.response)
    if search.criterion == "aicc":
        return lambda rest, total, mains, others: aicc(rest, total, runs, mains + others)
    price = 2.0 * SHARE_OF_CHOICE * logarithms_of_models(search.terms, search.heredity)
    rows, columns = (length - 1 for length in price.shape)  # beyond are models that have a term twice: none
    return lambda rest, total, mains, others: (
        bic_corrected(rest, total, runs, mains + others) + price[np.minimum(mains, rows), np.minimum(others, columns)]
    )


def logarithms_of_models(terms: Sequence[Term], heredity: Heredity) -> np.ndarray:
    """Return ln of how many models have so many main effects (rows) and terms of second order (columns).

    Taken as if every factor had its main effect, its square and its interactions among the terms.
    """
    mains = sum(len(term) == 1 for term in terms)
    others = len(terms) - mains
    table = np.zeros((mains + 1, others + 1))
    for k in range(mains + 1):
        inside, across = k * (k + 1) // 2, k * (mains - k)
        open_to = min({"strong": inside, "weak": inside + across, "none": others}[heredity], others)
        for j in range(others + 1):
            table[k, j] = math.log(math.comb(mains, k) * max(math.comb(open_to, j), 1))
    return table


def best_models(search: Search, within: float = AS_GOOD) -> list[Choice]:
    """Return the models whose score is within that of the best by `within`, best first, of those that a search follows.

    Models whose terms the runs cannot tell apart are no models. Raises ValueError for fewer than four runs.
    """
    if len(search.response) < 4:
        raise ValueError(f"{len(search.response)} runs with a result, allowed are four or more to choose a model")
    found = []
    for models in search.of_sizes(search.centred[None]):
        for score, chosen in zip(models.score[0], models.chosen[0], strict=True):
            if np.isfinite(score):
                found.append(Choice(tuple(search.terms[k] for k in np.flatnonzero(chosen)), float(score)))
    best = min(choice.score for choice in found)
    near = [choice for choice in found if choice.score <= best + within]
    return sorted(near, key=lambda choice: (choice.score, len(choice.terms)))


def best_of_each(search: Search, responses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest score (R,) for each of other responses (R, n), and which terms that model has, (R, terms)."""
    centred = responses - responses.mean(axis=1, keepdims=True)
    at_a_time = max(CHILDREN_AT_A_TIME // (search.width * max(len(search.terms), 1)), 1)
    parts = [_best_of_part(search, centred[k : k + at_a_time]) for k in range(0, len(centred), at_a_time)]
    scores, chosen = zip(*parts, strict=True)
    return np.concatenate(scores), np.concatenate(chosen)


def _best_of_part(search: Search, centred: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    scores = np.full(len(centred), np.inf)
    chosen = np.zeros((len(centred), len(search.terms)), dtype=bool)
    for models in search.of_sizes(centred):
        better = models.score[:, 0] < scores
        scores = np.where(better, models.score[:, 0], scores)
        chosen[better] = models.chosen[better, 0]
    return scores, chosen


def permutation_test(search: Search, permutations: int = PERMUTATIONS, seed: int = 0) -> PermutationTest:
    """Return how good a model the same search finds when the response has nothing to do with the factors.

    The whole selection is repeated for every permutation of the response over the runs. Seeded.
    Raises ValueError as `best_models`.
    """
    best = best_models(search, within=0.0)[0]
    centred = search.centred
    dealt = np.random.default_rng(seed).permuted(np.tile(centred, (permutations, 1)), axis=1)
    scores, chosen = best_of_each(search, dealt)
    models = [[search.terms[k] for k in np.flatnonzero(each)] for each in chosen]
    fits = [fit(model, search.coded, y) for model, y in zip(models, dealt, strict=True)]
    largest = np.array([np.abs(each.t_values[1:]).max(initial=0.0) for each in fits])
    total = centred @ centred
    model = fit(best.terms, search.coded, centred)
    count = permutations + 1
    return PermutationTest(
        permutations=permutations,
        model_p=float((1 + (scores <= best.score + SINGULAR).sum()) / count),
        term_p={
            term: float((1 + (largest >= abs(t) * (1.0 - SINGULAR)).sum()) / count)
            for term, t in zip(best.terms, model.t_values[1:], strict=True)
        },
        r_squared=np.array([1.0 - each.residual_sum / total for each in fits]) if total else np.zeros(permutations),
    )
