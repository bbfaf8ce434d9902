"""Sobol indices of a calibration's surrogates: a formula's come back, what does not hold is refused."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.inference.surrogate import fit_surrogate
from bulkwear.workflows.cases.calibration.sensitivity import sensitivity_table
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.report.products import products_of
from bulkwear.workflows.report.sensitivity import refused
from bulkwear.workflows.report.surrogate_indices import why_not
from tests.support.calibration_study import ROLLING, SLIDING
from tests.support.charts import drawn_chart, names, values

SLOPES = np.array([2.0, 1.0])
SIX_DIGITS = 1e-5  # relative; what a page keeps of values
SAMPLED = 0.1  # -, of 256 points and of a surrogate of twelve simulations


def surrogate(values, count=12):
    """A surrogate of simulations that are spread over the square."""
    points = np.random.default_rng(1).random((count, 2))
    return fit_surrogate(points, values(points), 1e-4 * np.eye(count), seed=1)


def calibrated(of):
    """What the table asks of a finished calibration."""
    return SimpleNamespace(
        problem=SimpleNamespace(names=[SLIDING, ROLLING]),
        known=SimpleNamespace(surrogates={"shear_angle_deg": of}),
    )


def test_a_linear_response():
    """Of slopes 2 and 1 the parts are 4/5 and 1/5, in the intervals too, in words that people use."""
    found = sensitivity_table(calibrated(surrogate(lambda points: 30.0 + points @ SLOPES)))
    assert found["factor"].tolist() == ["sliding friction", "rolling friction"]
    parts = SLOPES**2 / (SLOPES @ SLOPES)
    for index in ("first", "total"):
        np.testing.assert_allclose(found[index], parts, atol=SAMPLED)
        assert (found[f"{index}_low"] <= parts).all() and (parts <= found[f"{index}_high"]).all()
    assert (found["reason"] == "").all()


def test_draws_are_those_of_the_prediction():
    """Mean and deviation of draws are those that the surrogate predicts."""
    known, places = surrogate(lambda points: points @ SLOPES), np.random.default_rng(5).random((7, 2))
    draws, (mean, variance) = known.draws(places, 400, 0), known.predict(places)
    np.testing.assert_allclose(draws.mean(axis=1), mean, atol=5.0 * np.sqrt(variance.max() / draws.shape[1]) + 1e-3)
    np.testing.assert_allclose(draws.std(axis=1), np.sqrt(variance), rtol=0.1, atol=1e-3)


def test_what_does_not_hold_is_refused():
    """Too few simulations, and noise: no index, one sentence each."""
    assert why_not(surrogate(lambda points: points @ SLOPES, 4)).startswith("4 simulations of 2 parameters, allowed")
    noise = np.random.default_rng(9).standard_normal(12)
    found = sensitivity_table(calibrated(surrogate(lambda points: noise)))
    assert len(found) == 1 and "no better than by their mean" in found["reason"][0]


def test_left_out_simulations_are_predicted():
    """The share explained of a smooth response is near 1, and that of the fit without the simulation itself."""
    known = surrogate(lambda points: points @ SLOPES)
    assert known.left_out_share == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(
    ("case", "name"),
    [
        ("calibration", "calibration_sensitivity"),
        ("sliding_sample", "regression_sensitivity"),
        ("sliding_sample", "search_sensitivity"),
    ],
)
def test_all_figures_of_indices_become_interactive(case, name):
    """Two bars of each factor with their intervals, a panel per response; one that is refused has none."""
    known = sensitivity_table(calibrated(surrogate(lambda x: x @ SLOPES)))
    table = pd.concat([known, refused("discharge_time_s", "too few simulations")], ignore_index=True)
    drawn = drawn_chart(products_of(find_case(case))[name], table)
    assert names(drawn) == ["alone", "with interactions"]
    assert [panel["title"] for panel in drawn["panels"]] == [known["response"].iloc[0].replace("_", " ")]
    for entry, column in zip(names(drawn), ("first", "total"), strict=True):
        assert values(drawn, entry) == [pytest.approx(known[column].tolist(), rel=SIX_DIGITS)]
