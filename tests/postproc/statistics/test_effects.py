"""Contrasts of an unreplicated design for the half-normal plot."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.factors import half_normal_table, pseudo_error
from bulkwear.postproc.statistics.model_terms import candidate_terms, told_apart
from tests import REPOSITORY
from tests.support.models import coded_table
from tests.support.screening_study import factors_of

ROUNDING = 1e-10
HALF_UNIT = 5e-6  # of the last printed digit


def test_effects_of_a_factorial_as_published():
    """In an orthogonal design the effects per coded unit are half of Montgomery's (Example 6.2, Table 6.12)."""
    data = pd.read_csv(REPOSITORY / "tests/data/filtration_rate.csv", comment="#")
    coded = data[list("ABCD")].to_numpy(float)
    terms, _ = told_apart(candidate_terms(4), coded)
    table = half_normal_table(terms, coded, data["rate"], "ABCD").set_index("term")
    printed = {"A": 21.625, "B": 3.125, "C": 9.875, "D": 14.625, "A*C": -18.125, "A*D": 16.625}
    np.testing.assert_allclose(2.0 * table.loc[list(printed), "effect"], list(printed.values()), atol=HALF_UNIT)


def test_contrasts_hold_all_of_the_response():
    """With more terms than runs there are runs - 1 contrasts, whose squares add up to the total sum of squares."""
    design = pd.read_csv(REPOSITORY / "config/designs/screening.csv")
    coded = coded_table(design, factors_of(design, list(design.columns[1:])))
    response = np.random.default_rng(1).normal(size=13)
    table = half_normal_table(candidate_terms(6), coded, response, "abdhvt")
    assert len(table) == 12
    total = ((response - response.mean()) ** 2).sum()
    np.testing.assert_allclose((table["contrast"] ** 2).sum(), total, rtol=ROUNDING)
    assert (table["contrast"].abs().diff().dropna() >= 0.0).all()
    assert (table["half_normal_score"].diff().dropna() > 0.0).all()


def test_lone_effects_stand_out():
    """Without noise only the terms of the model have a contrast, and their effects are the coefficients."""
    coded = np.random.default_rng(2).choice([-1.0, 0.0, 1.0], (30, 3))
    response = 3.0 + 2.0 * coded[:, 0] * coded[:, 1]
    table = half_normal_table(candidate_terms(3), coded, response, "abc").set_index("term")
    assert table.loc["a*b", "effect"] == pytest.approx(2.0, rel=ROUNDING)
    assert table["contrast"].drop("a*b").abs().max() < ROUNDING


def test_pseudo_error_is_lenths():
    """1.5 times the median of contrasts below 2.5 times 1.5 times the median: written out for one case."""
    assert pseudo_error([1.0, -2.0, 3.0, 100.0]) == pytest.approx(1.5 * 2.0)
    assert pseudo_error([0.0, 0.0]) == 0.0
    assert np.isnan(pseudo_error([]))


def test_pseudo_error_finds_the_error():
    """Of many contrasts, few of them effects, it is the error within a few per cent (Lenth 1989)."""
    contrasts = np.random.default_rng(3).normal(0.0, 2.0, 4000)
    contrasts[:40] += 50.0
    assert pseudo_error(contrasts) == pytest.approx(2.0, rel=0.05)  # 1 % effects and the cut bias it by 1 to 2 %
