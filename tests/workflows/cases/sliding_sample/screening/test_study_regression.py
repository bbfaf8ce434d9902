"""The regression of a screening study as a whole: from wear to tables and warnings."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.factors import Factor
from bulkwear.workflows.cases.sliding_sample.screening.regression_warnings import screening_warnings
from bulkwear.workflows.cases.sliding_sample.screening.study_regression import (
    best_design_table,
    chance_test,
    chosen_coefficients,
    effects,
    log_normalised,
    method_table,
    model_table,
    residuals,
    screen,
    wear_at,
)
from tests import REPOSITORY
from tests.support.screening_study import factors_of

SYMBOLS = "abdhvt"
ROUNDING = 1e-9
NOISE = 0.05  # error (ln), a tenth of the smallest effect


@pytest.fixture(scope="module")
def design():
    """Table 3.8."""
    return pd.read_csv(REPOSITORY / "config/designs/screening.csv")


@pytest.fixture(scope="module")
def factors(design):
    """Its factors by column, with their short names."""
    columns = list(design.columns[1:])
    found = factors_of(design, columns)
    return {c: Factor(s, f.low, f.high, f.spacing) for c, s, f in zip(columns, SYMBOLS, found, strict=True)}


@pytest.fixture(scope="module")
def coded(design, factors):
    return np.column_stack([factor.coded(design[column]) for column, factor in factors.items()])


@pytest.fixture(scope="module")
def wear(coded):
    """Wear (mm3) by ln y = 0.5 a + 0.6 v + 1.4 t - 0.6 b d, with a little noise."""
    a, b, d, _, v, t = coded.T
    return 3.0 * np.exp(0.5 * a + 0.6 * v + 1.4 * t - 0.6 * b * d + np.random.default_rng(1).normal(0.0, NOISE, 13))


@pytest.fixture(scope="module")
def study(design, factors, wear):
    return screen(design, factors, wear)


def test_the_response_is_the_logarithm_of_normalised_wear():
    """The largest wear has 0; a factor e less has 1 less; what has no logarithm has no response."""
    np.testing.assert_allclose(log_normalised([2.0, 2.0 * np.e, np.nan, 0.0, -1.0]), [-1.0, 0.0] + [np.nan] * 3)
    assert np.isnan(log_normalised([0.0, np.nan])).all()


def test_the_known_terms_come_back(study):
    """The best model has the four terms and the parents of b*d; coefficients are near, its chance is the least."""
    table = chosen_coefficients(study, chance_test(study, 49))
    assert table["term"].tolist() == ["Constant", "a", "b", "d", "v", "t", "b*d"]
    np.testing.assert_allclose(table["coefficient"][1:], [0.5, 0, 0, 0.6, 1.4, -0.6], atol=4 * NOISE / np.sqrt(8))
    assert np.isnan(table["p_value_permutation"][0])
    assert (table["p_value_permutation"][1:] >= 0.02).all()
    assert (table.set_index("term")["p_value_after_selection"][["a", "v", "t", "b*d"]] < 1e-4).all()


def test_models_are_listed_by_heredity(study):
    """Each heredity has its best first, with all measures; strong heredity comes first, none needs no parents."""
    table = model_table(study)
    assert list(table.groupby("heredity", sort=False)["above_best"].first().items()) == [
        ("strong", 0.0),
        ("weak", 0.0),
        ("none", 0.0),
    ]
    assert table["model"][0] == "a + b + d + v + t + b*d"
    assert table.loc[table["heredity"] == "none", "model"].iloc[0] == "a + v + t + b*d"


def test_methods_stand_beside_each_other(design, factors, wear, coded):
    """A strong model is found by all three; without all mirror images there are no two steps, and it is said."""
    _, b, d, *_ = coded.T
    clear = wear * np.exp(0.8 * b + 0.7 * d)
    table = method_table(screen(design, factors, clear)).set_index("term")
    assert set(table.index[table["found_by"] == "all"]) == {"a", "b", "d", "v", "t", "b*d"}
    lost = screen(design, factors, np.where(np.arange(13) == 3, np.nan, clear))
    assert set(method_table(lost)["two_steps"]) == {"-"}
    words = "the two-step method cannot be used: run 4 has no mirror image"
    assert any(sentence.startswith(words) for sentence in screening_warnings(lost))


def test_residuals_name_their_runs(study, design):
    """One line per used run; response is fit plus residual."""
    table = residuals(study)
    assert table["row"].tolist() == design["row"].tolist()
    np.testing.assert_allclose(table["response"], table["fitted"] + table["residual"], atol=ROUNDING)


def test_half_normal_plot_shows_the_known_terms(study):
    """The four largest contrasts are those of the known terms."""
    assert set(effects(study)["term"][-4:]) == {"a", "v", "t", "b*d"}


def test_wear_is_predicted_in_its_own_unit(study, wear, coded):
    """Predictions at the runs are near the wear that was given, inside the interval of one further run."""
    table = wear_at(study, coded)
    np.testing.assert_allclose(table["predicted"], wear, rtol=4 * NOISE)
    assert ((table["run_low"] < wear) & (wear < table["run_high"])).all()


def test_best_design_inside_the_ranges(study):
    """Least wear: small a, slow, thin, and b d large, both low or both high; h is not in the model. Given ones stay."""
    table = best_design_table(study, [{}, {"t": 40.0, "b": 8.0}])
    assert table[["a", "v", "t"]].iloc[0].tolist() == pytest.approx([2.0, 0.5, 10.0])
    assert table["b"][0] in (pytest.approx(2.0), pytest.approx(8.0))
    assert table.iloc[1][["b", "d", "t"]].tolist() == pytest.approx([8.0, 60.0, 40.0])
    assert table["not_in_model"].tolist() == ["h", "h"]
    assert (table["run_low"] < table["predicted"]).all()
    with pytest.raises(ValueError, match="factor x is not known, allowed are a, b, d, h, v, t"):
        best_design_table(study, [{"x": 1.0}])


# --- what is lost


def test_lost_runs_are_named(design, factors, wear):
    """Failed and missing runs are left out, named, and it is said that main effects are no longer clear."""
    gappy = wear.copy()
    gappy[[3, 7]] = [np.nan, 0.0]
    study = screen(design, factors, gappy)
    assert len(study.response) == 11
    first, second, *_ = screening_warnings(study)
    assert first == "R4, R8: no wear above zero, missing or failed; 11 of 13 runs are used"
    assert second.startswith("main effects are not clear of interactions and squares: the largest correlation is 0.")
    assert study.choices["none"][0].terms == ((0,), (4,), (5,), (1, 2))


def test_a_lost_pair_leaves_main_effects_clear(design, factors, wear):
    """A run lost with its mirror image (R4 and R5) leaves main effects clear of second order."""
    gappy = wear.copy()
    gappy[[3, 4]] = np.nan
    sentences = screening_warnings(screen(design, factors, gappy))
    assert not any("main effects are not clear" in sentence for sentence in sentences)


def test_a_different_scale_is_an_aliased_factor(design, factors, wear):
    """A particle scale that follows the thickness is named with the factor it is aliased with."""
    scale = np.where(design["bed_thickness_mm"] > 10, 2.0, 1.26)
    sentences = screening_warnings(screen(design, factors, wear, {"particle scale": scale}))
    expected = "the particle scale is not the same in all runs (1.26 to 2): it is aliased with t (+0.90)"
    assert any(sentence.startswith(expected) for sentence in sentences)
    same = screening_warnings(screen(design, factors, wear, {"particle scale": np.full(13, 2.0)}))
    assert not any("particle scale" in sentence for sentence in same)


def test_few_runs_say_so(design, factors, wear):
    """Six runs still give a model of up to two terms, and say what they cannot tell."""
    gappy = np.where(np.arange(13) < 6, wear, np.nan)
    study = screen(design, factors, gappy)
    sentences = screening_warnings(study)
    assert "6 runs are few for 6 factors, models of up to 2 terms are compared" in sentences
    assert any("cannot be told from" in sentence for sentence in sentences)
    assert len(study.model.terms) <= 2


def test_a_factor_that_stays_the_same_is_left_out(design, factors, wear):
    """Where only runs of one level are left, the factor's terms are named and left out."""
    thick = np.where(design["bed_thickness_mm"] == 40, wear, np.nan)
    study = screen(design, factors, thick)
    assert "t does not change over the runs and is left out" in screening_warnings(study)
    assert (5,) not in study.candidates


def test_three_runs_are_refused(design, factors, wear):
    """Nothing can be said of three runs."""
    with pytest.raises(ValueError, match="found 3 runs with wear above zero, allowed are 4 or more"):
        screen(design, factors, np.where(np.arange(13) < 3, wear, np.nan))


def test_what_looks_alike_is_named(study):
    """The neighbours of b*d are named, where the error of the two steps comes from, and what else they find."""
    sentences = screening_warnings(study)
    assert any(sentence.startswith("no fake factor and no repeated row tells the error") for sentence in sentences)
    assert any(sentence.startswith("the two-step method finds other terms") for sentence in sentences)
    assert any(sentence.startswith("b*d looks much like") for sentence in sentences)
    assert any("27 candidate terms compete for 13 runs" in sentence for sentence in sentences)


def test_runs_without_replicates_are_said(study, design, factors, wear):
    """Without a repeated row scatter and misfit are one; a design of which a row is repeated does not say so."""
    words = "no row is repeated: the error"
    assert any(sentence.startswith(words) for sentence in screening_warnings(study))
    repeated = screen(pd.concat([design, design[:1]], ignore_index=True), factors, np.append(wear, 1.01 * wear[0]))
    assert not any(sentence.startswith(words) for sentence in screening_warnings(repeated))
