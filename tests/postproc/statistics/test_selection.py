"""Choice of terms among all models, and the test by permutation."""

import itertools

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics import selection
from bulkwear.postproc.statistics.model_terms import candidate_terms, parse_term, term_columns, told_apart
from bulkwear.postproc.statistics.regression import fit
from bulkwear.postproc.statistics.screening_design import coded_design
from bulkwear.postproc.statistics.selection import (
    Search,
    best_models,
    best_of_each,
    largest_size,
    logarithms_of_models,
    permutation_test,
    score_of,
)
from tests import REPOSITORY
from tests.support.models import coded_table, obeys
from tests.support.screening_study import factors_of

NAMES = "abdhvt"
MODEL = ("a", "b", "d", "v", "t", "b*d")
COEFFICIENTS = np.array([-1.859, 0.449, 0.3, -0.4, 0.650, 1.425, -0.629])  # Yan 2022, Table 3.9, with parents of b*d
ROUNDING = 1e-9  # of a score
QUIET = 0.05  # error (ln) at which effects of 0.3 and more cannot be missed: 17 of their standard errors
FALSE_TERMS = 1.5  # per analysis of a clear model; docs/selection_error_rates.md has 0.1 to 0.7, by AICc up to 5
TRIALS = 60
SURE = 4.0  # standard deviations of a count of trials


@pytest.fixture(scope="module")
def table():
    """Table 3.8 in coded units."""
    design = pd.read_csv(REPOSITORY / "config/designs/screening.csv")
    return coded_table(design, factors_of(design, list(design.columns[1:])))


def terms_of(*names):
    return tuple(parse_term(name, NAMES) for name in names)


def response_of(coded):
    """Response of the known model, without noise."""
    return COEFFICIENTS[0] + term_columns(terms_of(*MODEL), coded) @ COEFFICIENTS[1:]


def hereditary_models(factors, size):
    """Positions (m, size) in the candidate terms of all models of strong heredity: their second order within mains."""
    terms = candidate_terms(factors)
    place = {term: k for k, term in enumerate(terms)}
    for count in range(size + 1):
        for mains in itertools.combinations(range(factors), count):
            inside = [place[pair] for pair in itertools.combinations_with_replacement(mains, 2)]
            for pairs in itertools.combinations(inside, size - count):
                yield (*mains, *pairs)


def brute_force(search, factors):
    """Scores and terms of every model there is, each fitted by itself; by QR, without any order of search."""
    columns = term_columns(search.terms, search.coded)
    columns, score, total = columns - columns.mean(axis=0), score_of(search), search.centred @ search.centred
    found = {}
    for size in range(largest_size(len(search.terms), len(search.response), search.most) + 1):
        models = np.array(list(hereditary_models(factors, size)), dtype=int)
        if not len(models):
            continue
        basis, triangle = np.linalg.qr(np.moveaxis(columns[:, models], 0, 1))
        whole = (np.abs(np.diagonal(triangle, axis1=1, axis2=2)) > 1e-6).all(axis=1)
        left = search.centred - (basis @ (np.swapaxes(basis, 1, 2) @ search.centred)[:, :, None])[:, :, 0]
        mains = (models < factors).sum(axis=1)
        values = score((left**2).sum(axis=1), total, mains, size - mains)
        for model, value in zip(models[whole], values[whole], strict=True):
            found[frozenset(search.terms[k] for k in model)] = value
    return found


@pytest.mark.parametrize("criterion", ["extended_bic", "aicc"])
@pytest.mark.parametrize(("factors", "fake"), [(4, 0), (4, 2), (5, 0), (6, 0)])
def test_the_search_finds_what_brute_force_finds(factors, fake, criterion):
    """Where all models can be fitted, the best and every model as good are those of the search, with their scores."""
    coded, terms = coded_design(factors, fake).astype(float), candidate_terms(factors)
    rng = np.random.default_rng([1, factors, fake])
    for size in (0.0, 2.0):
        response = rng.normal(size=len(coded)) + size * (coded[:, :3].sum(axis=1) + coded[:, 0] * coded[:, 2])
        search = Search(terms, coded, response, criterion=criterion)
        every = brute_force(search, factors)
        best = min(every.values())
        near = {model: score for model, score in every.items() if score <= best + selection.AS_GOOD}
        found = {frozenset(choice.terms): choice.score for choice in best_models(search)}
        assert set(found) == set(near)
        np.testing.assert_allclose([found[model] for model in near], list(near.values()), atol=ROUNDING)


@pytest.mark.parametrize("factors", [8, 12])
def test_a_wider_search_finds_nothing_better(factors):
    """With more factors than brute force can do, five times as many models that are followed change no choice."""
    coded, terms = coded_design(factors, 2).astype(float), candidate_terms(factors)
    responses = np.random.default_rng(2).normal(size=(4, len(coded)))
    responses[2:] += 2.0 * (coded[:, :3].sum(axis=1) + coded[:, 0] * coded[:, 1])
    usual, wide = (best_of_each(Search(terms, coded, responses[0], width=w), responses) for w in (60, 300))
    np.testing.assert_allclose(usual[0], wide[0], atol=ROUNDING)
    assert (usual[1] == wide[1]).all()


@pytest.mark.parametrize("factors", range(4, 13))
def test_a_clear_model_is_found_in_any_design(factors):
    """Three main effects and two terms of second order, 20 times the error, are chosen, and few others."""
    coded, terms = coded_design(factors, 2).astype(float), candidate_terms(factors)
    truth = ((0,), (1,), (2,), (0, 2), (1, 1))
    response = term_columns(truth, coded) @ np.array([2.0, -2.0, 2.0, 2.0, -2.0])
    noisy = response + 0.1 * np.random.default_rng([3, factors]).normal(size=(5, len(coded)))
    chosen = best_of_each(Search(terms, coded, noisy[0]), noisy)[1]
    found = [set(itertools.compress(terms, each)) for each in chosen]
    assert all(each >= set(truth) for each in found)
    assert sum(len(each - set(truth)) for each in found) <= FALSE_TERMS * len(found)


def test_the_known_model_is_returned_without_noise(table):
    """Without noise the best model is the true one, alone, with its coefficients."""
    found = best_models(Search(candidate_terms(6), table, response_of(table)))
    assert [choice.terms for choice in found] == [terms_of(*MODEL)]
    model = fit(found[0].terms, table, response_of(table))
    np.testing.assert_allclose(model.coefficients, COEFFICIENTS, rtol=ROUNDING)


def test_the_known_terms_are_returned_with_noise(table):
    """With little noise the best model is the true one, whatever the seed."""
    noisy = response_of(table) + np.random.default_rng(3).normal(0.0, QUIET, (20, 13))
    chosen = best_of_each(Search(candidate_terms(6), table, noisy[0]), noisy)[1]
    assert {tuple(itertools.compress(candidate_terms(6), each)) for each in chosen} == {terms_of(*MODEL)}


def test_other_heredities_need_fewer_parents(table):
    """b*d alone is chosen without heredity, with one parent under weak heredity, with both under strong heredity."""
    _, b, d, *_, t = table.T

    def chosen(response, heredity):
        return best_models(Search(candidate_terms(6), table, response, heredity=heredity))[0].terms

    assert chosen(t + b * d, "none") == terms_of("t", "b*d")
    assert chosen(t + b * d + 0.2 * b, "weak") == terms_of("b", "t", "b*d")
    assert chosen(t + b * d + 0.2 * b, "strong") == terms_of("b", "d", "t", "b*d")


def test_models_are_counted():
    """The price of choosing counts the models of a shape as a list of all of them that obey the heredity does."""
    terms = candidate_terms(3)
    for heredity in ("none", "weak", "strong"):
        table = np.exp(logarithms_of_models(terms, heredity))
        for size in range(1, 5):
            models = np.array(list(itertools.combinations(range(9), size)))
            mains = (models[obeys(models, terms, heredity)] < 3).sum(axis=1)
            for count in range(min(size, 3) + 1):
                if expected := (mains == count).sum():
                    assert round(table[count, size - count]) >= expected
                    if heredity == "none" or size == count:
                        assert round(table[count, size - count]) == expected
        strong = [len(list(hereditary_models(3, size))) for size in (2, 3)]
        assert heredity != "strong" or strong == [3 + 3, 1 + 3 * 3]


@pytest.mark.parametrize(("heredity", "most", "criterion"), [("none", 5, "aicc"), ("strong", None, "extended_bic")])
def test_published_terms_are_chosen(heredity, most, criterion):
    """The filtration rates give the published terms (Montgomery, Example 6.2)."""
    data = pd.read_csv(REPOSITORY / "tests/data/filtration_rate.csv", comment="#")
    coded, rate = data[list("ABCD")].to_numpy(float), data["rate"].to_numpy(float)
    terms, _ = told_apart(candidate_terms(4), coded)
    best = best_models(Search(terms, coded, rate, most, heredity, criterion))
    assert best[0].terms == tuple(parse_term(name, "ABCD") for name in ("A", "C", "D", "A*C", "A*D"))


@pytest.mark.parametrize(
    ("runs", "most", "size"), [(4, None, 0), (5, None, 1), (13, None, 9), (8, 3, 3), (60, None, 27)]
)
def test_runs_bound_the_models(runs, most, size):
    """Models have up to as many terms as the runs allow, four fewer, or as many as are asked for."""
    assert largest_size(27, runs, most) == size


def test_too_few_runs_are_refused(table):
    """Three runs choose nothing."""
    with pytest.raises(ValueError, match="3 runs with a result, allowed are four or more"):
        best_models(Search(candidate_terms(6), table[:3], np.arange(3.0)))


def test_a_response_that_does_not_vary_has_no_terms(table):
    """All runs alike: the mean is the model."""
    assert best_models(Search(candidate_terms(6), table, np.ones(13)))[0].terms == ()


def test_parts_do_not_matter(table, monkeypatch):
    """Many responses at once or one after the other give the same choices."""
    noise = np.random.default_rng(6).normal(size=(7, 13))
    search = Search(candidate_terms(6), table, noise[0])
    whole = best_of_each(search, noise)
    monkeypatch.setattr(selection, "CHILDREN_AT_A_TIME", 1)
    single = best_of_each(search, noise)
    np.testing.assert_allclose(whole[0], single[0], atol=ROUNDING)
    assert (whole[1] == single[1]).all()
    assert tuple(itertools.compress(search.terms, whole[1][0])) == best_models(search)[0].terms


# --- permutations


def test_a_real_model_is_beyond_chance(table):
    """For the known model with little noise, hardly any permutation is as good: p is the least that can be."""
    response = response_of(table) + np.random.default_rng(7).normal(0.0, QUIET, 13)
    chance = permutation_test(Search(candidate_terms(6), table, response), permutations=99)
    assert chance.model_p == 0.01
    assert set(chance.term_p) == set(terms_of(*MODEL))
    assert chance.r_squared.shape == (99,)


def test_the_p_value_holds_where_there_is_nothing():
    """In responses of pure noise the p value of the whole search is below 0.1 in a tenth of the trials, and never below
    a level more often than that; it is 1 where no term is chosen, hence above 0.5 more often than in half of them.
    """
    rng = np.random.default_rng(8)
    coded = rng.choice([-1.0, 0.0, 1.0], (12, 4))
    terms, _ = told_apart(candidate_terms(4), coded)
    trials = [
        permutation_test(Search(terms, coded, rng.normal(size=12), 2), permutations=19, seed=k).model_p
        for k in range(TRIALS)
    ]
    share = {level: np.mean(np.array(trials) <= level + ROUNDING) for level in (0.1, 0.2, 0.5)}
    reach = {level: SURE * np.sqrt(level * (1.0 - level) / TRIALS) for level in share}
    assert abs(share[0.1] - 0.1) < reach[0.1]
    assert all(share[level] - level < reach[level] for level in share)
    assert np.mean(np.array(trials) == 1.0) > 0.5


def test_chance_alone_explains_much(table):
    """Four of 27 terms chosen for 13 runs explain most of pure noise: why p values after selection mislead."""
    noise = np.random.default_rng(9).normal(size=13)
    search = Search(candidate_terms(6), table, noise, 4, "none", "aicc")
    chance = permutation_test(search, permutations=50)
    assert np.median(chance.r_squared) > 0.5
    best = best_models(search)[0]
    naive = fit(best.terms, table, noise).p_values[1:].min(initial=1.0)
    assert min(chance.term_p.values(), default=1.0) > naive


def test_permutations_are_seeded(table):
    """The same seed gives the same test, another one another."""
    noise = np.random.default_rng(10).normal(size=13)
    first, same, other = (
        permutation_test(Search(candidate_terms(6), table, noise, 2), permutations=30, seed=seed).r_squared
        for seed in (1, 1, 2)
    )
    assert (first == same).all()
    assert (first != other).any()
