"""Tables of a calibration say what the posterior says."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.inference.loop import posterior
from bulkwear.postproc.inference.problem import Experiment, Measured, Parameter, Problem
from bulkwear.workflows.cases.calibration.responses import (
    family_table,
    information_table,
    interval_table,
    repeat_table,
    response_grid,
    statement_table,
)

NAMES = ["sliding", "rolling"]
ROUNDING = 1e-9  # of sums of shares


@pytest.fixture(scope="module")
def plane():
    """A calibration whose only response is the sum of both parameters, measured as 0.8 with deviation 0.05."""
    parameters = tuple(Parameter(name, 0.0, 1.0) for name in NAMES)
    problem = Problem(parameters, (Experiment("box", ("sum",), 4, 9),), {"sum": Measured(0.8, 0.05, 0.0)}, seed=3)
    table = pd.DataFrame(problem.spread_points(4), columns=NAMES)
    table["sum"], table["sum_uncertainty"] = table[NAMES].sum(axis=1), 1e-3
    return problem, table, posterior(problem, table)


def test_grid_holds_the_response(plane):
    """Over the grid the surrogate's mean is the response itself, here a plane."""
    problem, _, known = plane
    grid = response_grid(problem, known)
    np.testing.assert_allclose(grid["sum"], grid[NAMES].sum(axis=1), atol=0.03)  # of a range of 2
    assert (grid["sum_doubt"] >= 0.0).all()


def test_family_is_the_band(plane):
    """Pairs that give the measured sum are in the family, pairs four deviations off are not."""
    problem, _, known = plane
    family = family_table(problem, known)
    away = (family["first_value"] + family["second_value"] - 0.8).abs()
    assert (family.loc[away < 0.03, "denser_share"] < 0.95).all()
    assert (family.loc[away > 0.2, "denser_share"] > 0.95).all()
    assert family["density"].max() == pytest.approx(1.0, abs=ROUNDING)


def test_interval_of_one_parameter(plane):
    """On a line of equal density from (0, 0.8) to (0.8, 0) either parameter lies between 0 and 0.8."""
    problem, _, known = plane
    table = interval_table(problem, known, {"sliding": 0.3}).set_index("parameter")
    assert table.loc["sliding", "low"] == pytest.approx(0.02, abs=0.04)  # a fortieth of 0.8, and the band's width
    assert table.loc["sliding", "high"] == pytest.approx(0.80, abs=0.06)
    assert table.loc["sliding", "compared"] == 0.3 and np.isnan(table.loc["rolling", "compared"])


def repeats(values):
    """Simulations of one pair with several seeds."""
    return pd.DataFrame({"pair": "one", "sum": values, "sum_uncertainty": 0.02})


def test_mean_of_repeats():
    """Mean, standard deviation and standard error of the repeats; never less than the errors of measurement allow."""
    row = repeat_table(repeats([0.7, 0.8, 0.9]), ["sum", "never_simulated"]).iloc[0]
    assert (row["mean"], row["seeds"]) == (pytest.approx(0.8), 3)
    assert row["deviation"] == pytest.approx(0.1) and row["uncertainty"] == pytest.approx(0.1 / np.sqrt(3.0))
    assert repeat_table(repeats([0.7]), ["sum"]).iloc[0]["uncertainty"] == 0.02
    assert repeat_table(repeats([0.7, 0.7]), ["sum"]).iloc[0]["uncertainty"] == pytest.approx(0.02 / np.sqrt(2.0))


@pytest.mark.parametrize(
    ("simulated", "word"),
    [([0.84, 0.84], "inside"), ([0.82, 0.92], "within its uncertainty"), ([0.9, 0.9], "outside")],
)
def test_statements_tell_inside_from_outside(plane, simulated, word):
    """Inside is within one deviation measured; beyond it the simulated mean's own error may excuse it, or not."""
    problem, _, known = plane
    pairs = {"one": {"sliding": 0.4, "rolling": 0.44}}
    row = statement_table(problem, known, repeat_table(repeats(simulated), ["sum"]), pairs).iloc[0]
    assert row["inside"] == word
    assert row["deviations"] == pytest.approx((np.mean(simulated) - 0.8) / 0.05)
    assert row["predicted"] == pytest.approx(0.84, abs=0.03) and row["denser_share"] < 0.95


def test_measuring_the_same_again_tells_little(plane):
    """A response that made the family tells half a bit more: measured twice, its deviation falls by a root of 2."""
    problem, _, known = plane
    table = information_table(problem, known)
    assert list(table["response"]) == ["sum"]
    assert 0.3 < table["information_bits"].iloc[0] < 0.7
