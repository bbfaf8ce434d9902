"""The best design of a model inside the ranges."""

import itertools

import numpy as np
import pytest

from bulkwear.postproc.statistics.model_terms import candidate_terms, parse_term, term_columns
from bulkwear.postproc.statistics.optimum import best_design
from bulkwear.postproc.statistics.regression import fit

ROUNDING = 1e-9
GRID = np.array(list(itertools.product(np.linspace(-1.0, 1.0, 21), repeat=3)))


def model_of(terms, coefficients, factors=3):
    """A fitted model with these coefficients, the constant first."""
    coded = np.random.default_rng(1).uniform(-1.0, 1.0, (40, factors))
    return fit(terms, coded, coefficients[0] + term_columns(terms, coded) @ np.array(coefficients[1:]))


def response(model, coded):
    return model.coefficients[0] + term_columns(model.terms, np.atleast_2d(coded)) @ model.coefficients[1:]


@pytest.mark.parametrize("seed", range(25))
def test_no_place_of_a_grid_is_better(seed):
    """For any quadratic of three factors, up to four terms of it, no place of a fine grid has less response."""
    rng = np.random.default_rng(seed)
    every = candidate_terms(3)
    terms = [every[k] for k in rng.choice(9, 4, replace=False)]
    model = model_of(terms, rng.normal(size=5))
    best = best_design(model, 3)
    assert np.abs(best).max() <= 1.0
    assert response(model, best)[0] <= response(model, GRID).min() + ROUNDING


def test_a_bowl_is_found_at_its_bottom():
    """(a - 0.3)^2 + (b + 0.6)^2 is least at (0.3, -0.6)."""
    terms = [parse_term(name, "ab") for name in ("a", "b", "a^2", "b^2")]
    best = best_design(model_of(terms, [0.0, -0.6, 1.2, 1.0, 1.0], 2), 2)
    np.testing.assert_allclose(best, [0.3, -0.6], atol=1e-8)


def test_given_factors_stay():
    """A given level stays, and the others adapt: with b*d, b follows the sign of d; silent factors stand at 0."""
    model = model_of([(0, 1)], [0.0, -1.0])
    np.testing.assert_allclose(best_design(model, 3, {0: -0.5}), [-0.5, -1.0, 0.0])
    np.testing.assert_allclose(best_design(model, 3, {0: 0.5}), [0.5, 1.0, 0.0])
    np.testing.assert_allclose(best_design(model, 3, {0: 1.5, 1: 0.2}), [1.5, 0.2, 0.0])


def test_a_constant_leaves_all_at_the_middle():
    """A model of nothing says nothing."""
    np.testing.assert_allclose(best_design(model_of([], [1.0]), 3), np.zeros(3))
