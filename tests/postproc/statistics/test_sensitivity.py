"""Sobol indices of functions whose indices are known, and of draws of a surrogate."""

import math

import numpy as np
import pytest

from bulkwear.postproc.statistics.sensitivity import COLUMNS, sobol_indices

SAMPLED = 0.03  # -, error of an index from 2048 points
A, B = 7.0, 0.1  # of Ishigami's function


def ishigami(points):
    """sin x + A sin^2 y + B z^4 sin x over -pi to pi (T. Ishigami and T. Homma, 1990)."""
    x, y, z = (math.pi * (2.0 * points - 1.0)).T
    return np.sin(x) + A * np.sin(y) ** 2 + B * z**4 * np.sin(x)


def test_ishigamis_function():
    """Indices in closed form (Saltelli et al. 2008): no first order of z, which acts with x alone."""
    found = sobol_indices(ishigami, ["x", "y", "z"])
    x, y, both = 0.5 * (1.0 + B * math.pi**4 / 5.0) ** 2, A**2 / 8.0, B**2 * math.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    variance = x + y + both
    np.testing.assert_allclose(found["first"], np.array([x, y, 0.0]) / variance, atol=SAMPLED)
    np.testing.assert_allclose(found["total"], np.array([x + both, y, both]) / variance, atol=SAMPLED)
    assert tuple(found) == COLUMNS
    for index in ("first", "total"):
        assert (found[f"{index}_low"] <= found[index]).all() and (found[index] <= found[f"{index}_high"]).all()


def test_parts_and_their_intervals_lie_between_nothing_and_all():
    """Also where one factor makes all of the variance and another one none of it."""
    found = sobol_indices(lambda points: points[:, 0], ["all", "none"])
    assert found.drop(columns="factor").stack().between(0.0, 1.0).all()
    assert (found.loc[0, "first_low"], found.loc[0, "first_high"]) == (pytest.approx(1.0, abs=2.0 * SAMPLED), 1.0)


def test_an_additive_response():
    """Parts are the squares of the slopes over their sum, first and total order alike; a factor without one has 0."""
    slopes = np.array([3.0, 2.0, 1.0, 0.0])
    found = sobol_indices(lambda points: 5.0 + points @ slopes, list("abcd"))
    parts = slopes**2 / (slopes @ slopes)
    np.testing.assert_allclose(found["first"], parts, atol=SAMPLED)
    np.testing.assert_allclose(found["total"], parts, atol=SAMPLED)
    assert (np.abs(found[["first", "total"]].iloc[-1]) < 1e-12).all()


def test_indices_have_no_unit():
    """The same of a response in other units and about another mean."""
    one, other = (sobol_indices(lambda p, f=f: f * ishigami(p) - 1e3 * f, ["x", "y", "z"]) for f in (1.0, 1e-9))
    np.testing.assert_allclose(one.drop(columns="factor"), other.drop(columns="factor"), atol=1e-6)


def test_the_error_of_a_surrogate_is_in_the_interval():
    """Slopes that are known to 0.3 of 1: the interval is that of the draws, far wider than the sample's alone."""
    slopes = 1.0 + 0.3 * np.random.default_rng(3).standard_normal((2, 100))
    known = sobol_indices(lambda points: points @ np.ones(2), ["a", "b"])
    drawn = sobol_indices(lambda points: points @ slopes, ["a", "b"])
    parts = np.quantile(slopes[0] ** 2 / (slopes**2).sum(axis=0), [0.025, 0.975])
    low, high = drawn["first_low"].iloc[0], drawn["first_high"].iloc[0]
    np.testing.assert_allclose([low, high], parts, atol=2.0 * SAMPLED)
    assert high - low > 2.0 * (known["first_high"] - known["first_low"]).iloc[0]


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        (lambda points: np.full(len(points), 3.0), "does not vary over the range"),
        (lambda points: np.full(len(points), np.nan), "allowed are finite numbers"),
    ],
)
def test_what_has_no_indices_is_refused(values, sentence):
    """A constant, and what is no number, in one sentence."""
    with pytest.raises(ValueError, match=sentence):
        sobol_indices(values, ["a", "b"])
