"""Least squares on terms of coded factors, against published analyses and known models."""

import itertools

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from bulkwear.postproc.statistics.model_terms import candidate_terms, parse_term, term_columns
from bulkwear.postproc.statistics.regression import (
    aicc,
    bic_corrected,
    coefficient_table,
    fit,
    fit_measures,
    predict,
    press,
    residual_table,
)
from tests import DATA

ROUNDING = 1e-10  # of sums over a few runs
FIVE_DIGITS, FOUR_DIGITS, THREE_DIGITS, TWO_DIGITS = 5e-6, 5e-5, 5e-4, 5e-3  # half a unit of the last printed digit
SURE = 4.0  # standard deviations of a count of trials: a false alarm in 16,000 seeds


def data(name, factors, response):
    """Coded factors and response of a data set."""
    table = pd.read_csv(DATA / name, comment="#")
    return table[list(factors)].to_numpy(float), table[response].to_numpy(float)


def terms_of(text, names):
    """Terms from a line of names."""
    return [parse_term(name, names) for name in text.split()]


@pytest.fixture(scope="module")
def filtration():
    """The reduced model of Montgomery's filtration rates."""
    coded, rate = data("filtration_rate.csv", "ABCD", "rate")
    return fit(terms_of("A C D A*C A*D", "ABCD"), coded, rate)


@pytest.fixture(scope="module")
def carbon():
    """The published model of Lawson's mesoporous carbon."""
    coded, response = data("mesoporous_carbon.csv", "ABCDE", "response")
    return fit(terms_of("A B D E B^2 B*D", "ABCDE"), coded, response)


def random_design(runs=30, factors=3, seed=5):
    """A design without any structure."""
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (runs, factors))


# --- published analyses


def test_coefficients_as_published(filtration):
    """Rate = 70.06250 + 10.81250 A + 4.93750 C + 7.31250 D - 9.06250 AC + 8.31250 AD (Montgomery, Ex. 6.2)."""
    printed = [70.06250, 10.81250, 4.93750, 7.31250, -9.06250, 8.31250]
    np.testing.assert_allclose(filtration.coefficients, printed, atol=FIVE_DIGITS)


def test_measures_as_published(filtration):
    """R2 0.9660, adjusted 0.9489, predicted 0.9128, PRESS 499.52; sums of squares 195.12 and 5730.94 (ibid.)."""
    measures = fit_measures(filtration)
    found = [measures[f"r_squared{which}"] for which in ("", "_adjusted", "_predicted")]
    np.testing.assert_allclose(found, [0.9660, 0.9489, 0.9128], atol=FOUR_DIGITS)
    sums = [press(filtration), filtration.residual_sum, filtration.total_sum]
    np.testing.assert_allclose(sums, [499.52, 195.12, 5730.94], atol=TWO_DIGITS + ROUNDING)


def test_residuals_of_a_screening_design_as_published(carbon):
    """A definitive screening design, model with a square and an interaction: residuals as Lawson's program prints."""
    np.testing.assert_allclose(carbon.residuals[:5], [-13.348, -14.470, -5.452, -3.882, 10.255], atol=THREE_DIGITS)


# --- laws


def test_a_known_model_is_returned():
    """Without noise, coefficients are the model's own and all measures of fit are 1."""
    coded = random_design()
    terms = terms_of("a b*c c^2", "abc")
    truth = np.array([2.0, -1.0, 0.5, 3.0])
    model = fit(terms, coded, truth[0] + term_columns(terms, coded) @ truth[1:])
    np.testing.assert_allclose(model.coefficients, truth, rtol=ROUNDING)
    measures = fit_measures(model)
    shares = [measures[f"r_squared{which}"] for which in ("", "_adjusted", "_predicted")]
    np.testing.assert_allclose(shares, 1.0, atol=ROUNDING)


def test_press_is_leaving_out_every_run_in_turn():
    """PRESS is the sum of squared errors of each run predicted by a fit to all others."""
    coded = random_design(12)
    response = np.random.default_rng(6).normal(size=12)
    terms = terms_of("a b", "abc")
    errors = []
    for k in range(12):
        others = np.arange(12) != k
        model = fit(terms, coded[others], response[others])
        errors.append(response[k] - predict(model, coded[k : k + 1])["predicted"].iloc[0])
    np.testing.assert_allclose(press(fit(terms, coded, response)), np.sum(np.square(errors)), rtol=ROUNDING)


def test_leverages_add_up_to_the_coefficients(filtration, carbon):
    """The trace of the hat matrix is the number of coefficients; residuals are orthogonal to the fit."""
    for model in (filtration, carbon):
        np.testing.assert_allclose(model.leverage.sum(), len(model.coefficients), rtol=ROUNDING)
        assert abs(model.residuals @ model.fitted) < ROUNDING * model.total_sum


@pytest.mark.verify
def test_intervals_cover():
    """Of 95 % intervals of coefficients, of the mean and of one further run, 95 % contain the truth (seeded trials)."""
    rng = np.random.default_rng(11)
    coded, place, trials = random_design(13), np.array([[0.3, -0.8, 0.1]]), 2000
    terms = terms_of("a b*c", "abc")
    truth = 1.0 + term_columns(terms, coded) @ [0.4, -0.7]
    mean = 1.0 + (term_columns(terms, place) @ [0.4, -0.7])[0]
    hits = np.zeros(3)
    for _ in range(trials):
        model = fit(terms, coded, truth + rng.normal(0.0, 0.2, 13))
        line = predict(model, place).iloc[0]
        further = mean + rng.normal(0.0, 0.2)
        reach = stats.t.ppf(0.975, model.freedom) * model.errors[2]
        hits += [
            abs(model.coefficients[2] + 0.7) < reach,
            line["mean_low"] < mean < line["mean_high"],
            line["run_low"] < further < line["run_high"],
        ]
    assert np.abs(hits / trials - 0.95).max() < SURE * np.sqrt(0.95 * 0.05 / trials)


def test_p_values_are_of_students_t():
    """For a single factor, p is that of the correlation coefficient (scipy's, by another way)."""
    coded = random_design(15, 1)
    response = coded[:, 0] + np.random.default_rng(8).normal(0.0, 0.8, 15)
    table = coefficient_table(fit([(0,)], coded, response), "a")
    np.testing.assert_allclose(table["p_value"][1], stats.pearsonr(coded[:, 0], response).pvalue, rtol=1e-9)
    assert table["term"].tolist() == ["Constant", "a"]


def test_aicc_is_akaikes_with_its_correction():
    """n ln(RSS / n) + 2 k + 2 k (k + 1) / (n - k - 1) with k = terms + 2, written out for one case."""
    expected = 13 * np.log(2.0 / 13) + 2 * 6 + 2 * 6 * 7 / (13 - 6 - 1)
    assert float(aicc(2.0, 10.0, 13, 4)) == pytest.approx(expected, rel=ROUNDING)
    assert np.isinf(aicc(2.0, 10.0, 7, 4))


def test_bic_is_corrected_for_few_runs():
    """n ln(RSS / n) + k ln(n) n / (n - k - 2) for k coefficients (McQuarrie 1999); no model where n = k + 2; for many
    runs a term costs ln(n).
    """
    expected = 13 * np.log(2.0 / 13) + 5 * np.log(13) * 13 / (13 - 5 - 2)
    assert float(bic_corrected(2.0, 10.0, 13, 4)) == pytest.approx(expected, rel=ROUNDING)
    assert np.isinf(bic_corrected(2.0, 10.0, 7, 4))
    many = 100_000
    difference = bic_corrected(1.0, 2.0, many, 3) - bic_corrected(1.0, 2.0, many, 2)
    assert float(difference) == pytest.approx(np.log(many), rel=10.0 / many)


def test_normal_scores_are_ordered_like_the_residuals():
    """The scores of a residual table rise with the residuals, and are symmetric about zero."""
    coded = random_design(9)
    table = residual_table(fit([(0,)], coded, np.random.default_rng(9).normal(size=9)))
    ordered = table.sort_values("residual")["normal_score"].to_numpy()
    assert (np.diff(ordered) > 0.0).all()
    np.testing.assert_allclose(ordered, -ordered[::-1], atol=ROUNDING)


# --- edges


def test_terms_that_cannot_be_told_apart_are_refused():
    """Two equal columns, or fewer runs than coefficients, are no model."""
    coded = np.repeat(random_design(8, 1), 2, axis=1)
    with pytest.raises(ValueError, match="8 runs cannot tell 3 coefficients apart"):
        fit([(0,), (1,)], coded, np.arange(8.0))
    with pytest.raises(ValueError, match="3 runs cannot tell 4 coefficients apart"):
        fit([(0,), (1,), (2,)], random_design(3), np.arange(3.0))


def test_a_saturated_model_has_no_error():
    """As many coefficients as runs: a perfect fit, no error, no limits, and PRESS is infinite."""
    coded = random_design(4)
    model = fit([(0,), (1,), (2,)], coded, np.arange(4.0))
    assert np.isnan(model.error)
    assert np.isinf(press(model))
    assert predict(model, coded)["run_low"].isna().all()


def test_a_constant_response_has_no_shares():
    """Where the response does not vary, R2 is undefined, not 0 or 1."""
    measures = fit_measures(fit([(0,)], random_design(6), np.ones(6)))
    assert np.isnan([measures["r_squared"], measures["r_squared_predicted"]]).all()


# --- terms


def test_candidates_are_all_of_second_order():
    """k main effects and k (k + 1) / 2 squares and products, each once."""
    terms = candidate_terms(6)
    assert len(terms) == len(set(terms)) == 6 + 21
    assert set(terms) == {(k,) for k in range(6)} | set(itertools.combinations_with_replacement(range(6), 2))


def test_unknown_terms_are_named():
    """What is no product of two known factors is refused with the factors there are."""
    for text in ("a*x", "a*b*c", "a^3", ""):
        with pytest.raises(ValueError, match="allowed are products of at most two of a, b, c"):
            parse_term(text, "abc")
