"""Choice of terms among all models, and the test by permutation."""

import itertools
import math

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics import selection
from bulkwear.postproc.statistics.factors import coded_table, factors_of
from bulkwear.postproc.statistics.model_terms import candidate_terms, parse_term, term_columns, told_apart
from bulkwear.postproc.statistics.regression import fit, fit_measures
from bulkwear.postproc.statistics.selection import Search, all_models, best_models, largest_size, permutation_test
from tests import REPOSITORY

NAMES = "abdhvt"
MODEL = ("a", "v", "t", "b*d")
COEFFICIENTS = np.array([-1.859, 0.449, 0.650, 1.425, -0.629])  # Yan 2022, Table 3.9: a model as the study expects it
ROUNDING = 1e-9  # of AICc
QUIET = 0.05  # error (ln) at which four effects of 0.45 and more cannot be missed: 25 of their standard errors
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


def test_all_models_are_tried(table):
    """Every set of up to four of 27 terms comes once: 1 + 27 + 351 + 2925 + 17550."""
    blocks = list(all_models(candidate_terms(6), 13))
    assert sum(map(len, blocks)) == sum(math.comb(27, k) for k in range(5)) == 20_854
    fours = np.concatenate([block for block in blocks if block.shape[1] == 4])
    assert len(np.unique(fours, axis=0)) == math.comb(27, 4)


def test_the_known_model_is_returned_without_noise(table):
    """Without noise the best model is the true one, alone, with its coefficients."""
    found = best_models(Search(candidate_terms(6), table, response_of(table)))
    assert [choice.terms for choice in found] == [terms_of(*MODEL)]
    model = fit(found[0].terms, table, response_of(table))
    np.testing.assert_allclose(model.coefficients, COEFFICIENTS, rtol=ROUNDING)


def test_the_known_terms_are_returned_with_noise(table):
    """With little noise the best model is the true one, whatever the seed."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        noisy = response_of(table) + rng.normal(0.0, QUIET, 13)
        assert best_models(Search(candidate_terms(6), table, noisy))[0].terms == terms_of(*MODEL)


def test_scores_are_those_of_single_fits(table):
    """AICc and the order of models agree with fitting each model by itself (four factors, all models)."""
    response = np.random.default_rng(4).normal(size=13)
    terms = candidate_terms(4)
    found = best_models(Search(terms, table[:, :4], response), within=np.inf)
    singly = {}
    for size in range(5):
        for model in itertools.combinations(terms, size):
            try:
                singly[model] = fit_measures(fit(model, table[:, :4], response))["aicc"]
            except ValueError:
                continue
    assert {choice.terms for choice in found} >= set(singly)
    for choice in found:
        if choice.terms in singly:
            assert choice.aicc == pytest.approx(singly[choice.terms], abs=ROUNDING)
    scores = [choice.aicc for choice in found]
    assert scores == sorted(scores)


def test_every_model_as_good_is_returned(table):
    """All models within 2 of the best come back, none beyond, whatever the size of the blocks."""
    response = response_of(table) + np.random.default_rng(5).normal(0.0, 0.5, 13)
    every = best_models(Search(candidate_terms(6), table, response), within=50.0)
    found = best_models(Search(candidate_terms(6), table, response))
    assert found == [choice for choice in every if choice.aicc <= every[0].aicc + 2.0]
    assert len(every) > len(found) > 1


def test_blocks_do_not_matter(table, monkeypatch):
    """Many small blocks of models give the same choice as a few large ones."""
    response = np.random.default_rng(6).normal(size=13)
    whole = best_models(Search(candidate_terms(6), table, response))
    monkeypatch.setattr(selection, "MODELS_AT_A_TIME", 777)
    assert best_models(Search(candidate_terms(6), table, response)) == whole


def test_heredity_binds_the_choice(table):
    """With strong heredity b*d needs b and d, so four terms cannot hold the known model, and none is chosen without."""
    response = response_of(table)
    strong = best_models(Search(candidate_terms(6), table, response, heredity="strong"))
    for choice in strong:
        mains = {term[0] for term in choice.terms if len(term) == 1}
        assert all(set(term) <= mains for term in choice.terms)
    assert best_models(Search(candidate_terms(6), table, response, 6, "strong"))[0].terms == terms_of(
        "a", "b", "d", "v", "t", "b*d"
    )


@pytest.mark.parametrize(("heredity", "most", "model"), [("none", 5, "A C D A*C A*D"), ("strong", 5, "A C D A*C A*D")])
def test_published_terms_are_chosen(heredity, most, model):
    """Among all models of five terms the filtration rates give the published one (Montgomery, Example 6.2)."""
    data = pd.read_csv(REPOSITORY / "tests/data/filtration_rate.csv", comment="#")
    coded, rate = data[list("ABCD")].to_numpy(float), data["rate"].to_numpy(float)
    terms, _ = told_apart(candidate_terms(4), coded)
    best = best_models(Search(terms, coded, rate, most, heredity))
    assert [choice.terms for choice in best] == [tuple(parse_term(name, "ABCD") for name in model.split())]


@pytest.mark.parametrize(("runs", "size"), [(4, 0), (5, 1), (7, 3), (8, 4), (30, 4)])
def test_few_runs_bound_the_models(runs, size):
    """AICc compares models of up to runs - 4 terms."""
    assert largest_size(27, runs) == size


def test_too_few_runs_are_refused(table):
    """Three runs choose nothing."""
    with pytest.raises(ValueError, match="3 runs with a result, allowed are four or more"):
        best_models(Search(candidate_terms(6), table[:3], np.arange(3.0)))


# --- permutations


def test_a_real_model_is_beyond_chance(table):
    """For the known model with little noise, hardly any permutation is as good: p is the least that can be."""
    response = response_of(table) + np.random.default_rng(7).normal(0.0, QUIET, 13)
    chance = permutation_test(Search(candidate_terms(6), table, response), permutations=99)
    assert chance.model_p == 0.01
    assert set(chance.term_p) == set(terms_of(*MODEL))
    assert chance.r_squared.shape == (99,)


def test_the_p_value_holds_where_there_is_nothing():
    """In responses of pure noise the p value of the whole search is uniform: below 0.2 in a fifth of the trials."""
    rng = np.random.default_rng(8)
    coded = rng.choice([-1.0, 0.0, 1.0], (12, 4))
    terms, _ = told_apart(candidate_terms(4), coded)
    trials = [
        permutation_test(Search(terms, coded, rng.normal(size=12), 2), permutations=19, seed=k).model_p
        for k in range(TRIALS)
    ]
    for level in (0.2, 0.5):
        share = np.mean(np.array(trials) <= level)
        assert abs(share - level) < SURE * np.sqrt(level * (1.0 - level) / TRIALS)


def test_chance_alone_explains_much(table):
    """Four of 27 terms chosen for 13 runs explain most of pure noise: why p values after selection mislead."""
    noise = np.random.default_rng(9).normal(size=13)
    chance = permutation_test(Search(candidate_terms(6), table, noise), permutations=50)
    assert np.median(chance.r_squared) > 0.5
    best = best_models(Search(candidate_terms(6), table, noise))[0]
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
