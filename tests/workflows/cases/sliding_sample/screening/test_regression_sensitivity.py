"""Sobol indices of a screening's regression: known factors come back, and what does not hold is refused."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.plots.sensitivity import sensitivity_bars
from bulkwear.postproc.statistics.regression import fit
from bulkwear.workflows.cases.sliding_sample.screening.regression_sensitivity import (
    coefficient_draws,
    sensitivity_table,
)
from bulkwear.workflows.report.sections import Points, Table
from bulkwear.workflows.report.sensitivity import finding, sensitivity_blocks
from tests import REPOSITORY
from tests.support.screening_study import FACTORS

NOISE = 0.05  # error (ln) of a run
SAMPLED = 0.04  # -, error of an index from its sample, and from the noise of the runs


@pytest.fixture(scope="module")
def summary():
    """Wear with the square of the bed's thickness and the velocity; over plain nothing but noise."""
    design, chance = pd.read_csv(REPOSITORY / "config/designs/screening.csv"), np.random.default_rng(2)
    noise, other = chance.normal(0.0, NOISE, (2, 13))
    wear = design["bed_thickness_mm"] ** 2 * design["velocity_m_per_s"]
    return design.assign(
        surface="convex",
        particle_scale=2.0,
        worn_volume_per_metre_m3_per_m=1e-12 * wear * np.exp(noise),
        wear_over_plain=np.exp(np.sort(other)[[6, 0, 12, 3, 9, 1, 11, 4, 8, 2, 10, 5, 7]]),
    )


@pytest.fixture(scope="module")
def table(summary):
    return sensitivity_table(summary, FACTORS)


def test_known_factors_decide(table):
    """Thickness and velocity make what the squares of their slopes say, alone as together; all others nothing."""
    found = table[table["response"] == "ln wear per metre"].set_index("factor")
    slopes = {"t": 2.0 * np.log(4.0) / 2.0, "v": np.log(4.0) / 2.0}  # per unit, of levels that double
    whole = sum(value**2 for value in slopes.values())
    for name in FACTORS:
        part = slopes.get(name, 0.0) ** 2 / whole
        assert found.loc[name, "first"] == pytest.approx(part, abs=SAMPLED)
        assert found.loc[name, "total"] == pytest.approx(part, abs=SAMPLED)
        assert found.loc[name, "first_low"] <= found.loc[name, "first"] <= found.loc[name, "first_high"]


def test_noise_is_refused(table):
    """No index of a response that no factor is told apart in; the sentence says so, and the figure is drawn."""
    (row,) = table[table["response"] == "ln wear over plain"].to_dict("records")
    assert row["factor"] == "" and np.isnan(row["total"]) and row["reason"]
    said = finding(table)
    assert "Of the variance of ln wear per metre over the design t alone makes" in said
    assert f"Of ln wear over plain no index is told: {row['reason']}." in said
    wide = finding(table.assign(first_low=0.0, first_high=1.0))
    said = "Which factor decides ln wear per metre cannot be said: t alone makes 0 to 100 % of its variance"
    assert f"{said} (95 % interval)." in wide
    assert len(sensitivity_bars(table, ["a remark"]).axes) == 2


def test_a_model_of_one_factor_tells_no_shares(table):
    """All that it explains is that factor's, whatever it leaves out."""
    wear = table["response"] == "ln wear per metre"
    alone = table.assign(total=table["total"].where(~wear | (table["factor"] == "t"), 0.0))
    said = finding(alone)
    assert said.startswith("Of ln wear per metre the model holds t alone") and "alone makes" not in said


def test_too_few_runs_are_refused(summary):
    """Three runs, and no plain twin, in a sentence each; a page then has no table."""
    worn = "worn_volume_per_metre_m3_per_m"
    known = summary.drop(columns="wear_over_plain").assign(**{worn: summary[worn].where(summary.index < 3)})
    few = sensitivity_table(known, FACTORS)
    assert few["total"].isna().all() and "found 3 runs" in few["reason"][0]
    assert few["reason"][1] == "no run has a plain twin"
    assert [type(block) for block in sensitivity_blocks(few)] == [Points]


def test_the_page_has_points_and_a_table(table):
    """A point for each response, and the indices of those that have some."""
    points, shown = sensitivity_blocks(table)
    assert len(points.items) == 2 and isinstance(shown, Table) and len(shown.data) == len(FACTORS)


def test_draws_of_coefficients_have_their_error():
    """Mean and deviation of the draws are those of Student's t about the estimates."""
    coded = np.tile([[-1.0], [0.0], [1.0]], (4, 1))
    response = coded[:, 0] + np.random.default_rng(4).normal(0.0, 0.1, 12)
    model = fit([(0,)], coded, response)
    draws = coefficient_draws(model, 20000)
    np.testing.assert_allclose(draws.mean(axis=1), model.coefficients, atol=4.0 * model.errors.max() / 100.0)
    student = np.sqrt(model.freedom / (model.freedom - 2.0))
    np.testing.assert_allclose(draws.std(axis=1), student * model.errors, rtol=0.05)
