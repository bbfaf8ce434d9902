"""Candidate terms: names, aliasing, heredity."""

import numpy as np
import pytest

from bulkwear.postproc.statistics.model_terms import (
    aliased_pairs,
    aliasing,
    candidate_terms,
    parse_term,
    term_name,
    told_apart,
)
from tests.support.models import obeys

NAMES = ["a", "b", "c"]
ROUNDING = 1e-12
FULL = np.array(np.meshgrid([-1, 0, 1], [-1, 0, 1], [-1, 0, 1])).reshape(3, -1).T
HALF = np.array([[-1, -1, 1], [1, -1, -1], [-1, 1, -1], [1, 1, 1]])  # c = a b


def test_names_go_both_ways():
    """A term is read from what it is written as."""
    terms = candidate_terms(3)
    assert [term_name(term, NAMES) for term in terms] == ["a", "b", "c", "a^2", "a*b", "a*c", "b^2", "b*c", "c^2"]
    assert [parse_term(term_name(term, NAMES), NAMES) for term in terms] == terms
    assert parse_term("c*a", NAMES) == (0, 2)


def test_a_full_factorial_aliases_nothing():
    """All nine terms are kept and uncorrelated."""
    terms = candidate_terms(3)
    kept, lost = told_apart(terms, FULL)
    assert (kept, lost) == (terms, [])
    np.testing.assert_allclose(aliasing(terms, FULL, NAMES), np.eye(9), atol=ROUNDING)


def test_a_half_fraction_loses_what_it_aliases():
    """With c = a b each interaction is a main effect, and squares do not change: all are named."""
    kept, lost = told_apart(candidate_terms(3), HALF)
    assert kept == [(0,), (1,), (2,)]
    assert dict(lost) == {(0, 0): None, (1, 1): None, (2, 2): None, (0, 1): (2,), (0, 2): (1,), (1, 2): (0,)}


def test_pairs_are_listed_from_the_strongest():
    """Correlations of at least the bound in size come once each, the strongest first, with their sign."""
    coded = np.array([[-1.0, 1.0, 0.0], [0.0, 0.1, 1.0], [1.0, -1.0, -0.2], [0.5, 0.0, 0.3]])
    pairs = aliased_pairs(aliasing([(0,), (1,), (2,)], coded, NAMES), 0.0)
    assert pairs[["first", "second"]].iloc[0].tolist() == ["a", "b"]
    assert pairs["correlation"][0] < -0.9
    assert (pairs["correlation"].abs().diff().dropna() <= 0.0).all()
    assert len(pairs) == 3


@pytest.mark.parametrize(
    ("model", "weak", "strong"),
    [
        ([], True, True),
        (["a"], True, True),
        (["a*b"], False, False),
        (["a", "a*b"], True, False),
        (["a", "b", "a*b"], True, True),
        (["c", "a*b"], False, False),
        (["a^2"], False, False),
        (["a", "a^2"], True, True),
    ],
)
def test_heredity(model, weak, strong):
    """Strong: both parents are in the model; weak: one is; none: anything goes. A square has one parent."""
    terms = candidate_terms(3)
    choice = np.array([[terms.index(parse_term(name, NAMES)) for name in model]], dtype=int)
    assert obeys(choice, terms, "none").tolist() == [True]
    assert obeys(choice, terms, "weak").tolist() == [weak]
    assert obeys(choice, terms, "strong").tolist() == [strong]


def test_a_parent_that_is_no_candidate_cannot_be_in_the_model():
    """An interaction whose main effect was left out obeys strong heredity in no model."""
    terms = [(0,), (0, 1)]
    assert obeys(np.array([[0, 1]]), terms, "weak").tolist() == [True]
    assert obeys(np.array([[0, 1]]), terms, "strong").tolist() == [False]
