"""Steady windows of runs by two measures, beside a given window."""

import numpy as np
import pandas as pd
import pytest

from workflows.cases.sliding_sample.steady_table import MEASURES, steady_table

TRAVEL = np.arange(0.0, 1000.0, 10.0)
NAMES = {"row": "R1", "surface": "convex", "travel_mm": TRAVEL}


def wavy(mean):
    """A measure that alternates by 1 % about its mean."""
    return mean * (1.0 + 0.01 * (-1.0) ** np.arange(len(TRAVEL)))


@pytest.fixture
def table():
    """R1_convex becomes steady after 300 mm in its flow alone; R1_plain wears ever more."""
    flow = np.where(TRAVEL < 300.0, 0.1 * TRAVEL, wavy(30.0))
    along = [pd.DataFrame({"run": run, **NAMES, MEASURES[0]: flow}) for run in ("R1_convex", "R1_plain")]
    gradients = [
        pd.DataFrame({"run": "R1_convex", **NAMES, MEASURES[1]: wavy(0.5)}),
        pd.DataFrame({"run": "R1_plain", **NAMES, MEASURES[1]: TRAVEL}),
    ]
    return steady_table(pd.concat(along), pd.concat(gradients), (500.0, 900.0)).set_index(["run", "measure"])


def test_both_measures_must_be_steady(table):
    """Together they are steady from the later start on; where one drifts there is no such place."""
    assert table["steady"].tolist() == [True, True, True, False]
    assert 270.0 <= table.loc[("R1_convex", MEASURES[0]), "start_mm"] <= 320.0
    starts = table["common_start_mm"].groupby("run").first()
    assert starts["R1_convex"] == table.loc[("R1_convex", MEASURES[0]), "start_mm"]
    assert np.isnan(starts["R1_plain"])


def test_the_given_window_stands_beside(table):
    """Its mean is that of the values inside; a window that the travel does not fill has none."""
    assert table.loc[("R1_convex", MEASURES[0]), "published_mean"] == pytest.approx(30.0, rel=1e-3)
    line = pd.DataFrame({"run": "R1_convex", **NAMES, MEASURES[0]: 1.0, MEASURES[1]: 1.0})
    assert steady_table(line, line, (500.0, 1700.0))["published_mean"].isna().all()


def test_few_values_are_not_steady():
    """Of three values there is no window, and no claim."""
    line = pd.DataFrame({"run": "R1_convex", **NAMES, MEASURES[0]: 1.0, MEASURES[1]: 1.0})[:3]
    found = steady_table(line, line, (500.0, 900.0))
    assert found["steady"].tolist() == [False, False]
    assert found[["mean", "common_start_mm"]].isna().all(axis=None)
