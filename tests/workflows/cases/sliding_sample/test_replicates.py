"""Scatter between replicates: geometric means, intervals from one scatter for all settings, tables per setting."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from workflows.cases.sliding_sample.replicates import (
    NO_REPLICATES,
    by_setting,
    mean_of_replicates,
    replicate_intervals,
    replicate_remark,
    with_intervals,
)

ROUNDING = 1e-9
TRIALS = 400
SURE = 4.0  # standard deviations of a count of trials


def test_intervals_of_known_replicates():
    """exp(-1, 0, 1) and two equal runs: variance 2 / 3 of the logarithm on three degrees of freedom, by hand."""
    values = [*np.exp([-1.0, 0.0, 1.0]), 5.0, 5.0, 7.0, np.nan]
    table = replicate_intervals(["A", "A", "A", "B", "B", "C", "D"], values).set_index("setting")
    assert table["runs"].to_dict() == {"A": 3, "B": 2, "C": 1}
    assert table["mean"].to_dict() == pytest.approx({"A": 1.0, "B": 5.0, "C": 7.0}, rel=ROUNDING)
    assert table["deviation"].tolist() == pytest.approx([np.sqrt(2.0 / 3.0)] * 3, rel=ROUNDING)
    reach = stats.t.ppf(0.975, 3) * np.sqrt(2.0 / 3.0)
    assert table.loc["B", "high"] == pytest.approx(5.0 * np.exp(reach / np.sqrt(2.0)), rel=ROUNDING)
    assert table.loc["C", "low"] == pytest.approx(7.0 * np.exp(-reach), rel=ROUNDING)


def test_without_replicates_there_is_no_interval():
    """Single runs have their own value and nothing more."""
    table = replicate_intervals(["A", "B"], [1.0, 2.0])
    assert table["mean"].tolist() == pytest.approx([1.0, 2.0])
    assert table[["low", "high", "deviation"]].isna().all(axis=None)


def test_intervals_hold_the_truth_as_often_as_they_say():
    """Of 400 studies of log-normal runs, 95 % of the intervals of a setting of two hold its true mean."""
    rng = np.random.default_rng(5)
    settings = np.repeat(["A", "B", "C"], 2)
    held = 0
    for _ in range(TRIALS):
        table = replicate_intervals(settings, np.exp(rng.normal(0.0, 0.2, 6)))
        held += int(table["low"][0] < 1.0 < table["high"][0])
    assert abs(held - 0.95 * TRIALS) < SURE * np.sqrt(TRIALS * 0.95 * 0.05)


@pytest.fixture
def relative():
    """Relative wear of R1 twice and of R2 once."""
    return pd.DataFrame(
        {
            "row": ["R1-1", "R1-2", "R2"],
            "surface": "convex",
            "wear_over_plain": [0.5, 0.5, 0.8],
            "equivalent_size_ratio": [0.7, 0.7, 0.3],
            "lowest_cycle_ratio": [0.4, 0.45, 0.7],
            "highest_cycle_ratio": [0.6, 0.65, 0.9],
        }
    )


def test_a_setting_is_one_line(relative):
    """Replicates become one bar with the mean and the widest range; the remark tells how many there are."""
    table = by_setting(relative, {"R1-1": "R1", "R1-2": "R1", "R2": "R2"})
    assert table["row"].tolist() == ["R1", "R2"]
    assert table["replicates"].tolist() == [2, 1]
    assert table.loc[0, ["lowest_cycle_ratio", "highest_cycle_ratio"]].tolist() == [0.4, 0.65]
    assert table["interval_high"].tolist() == pytest.approx([0.5, 0.8])  # replicates that agree leave no scatter
    assert replicate_remark(table) == "1 of 2 rows repeated with other packings; bars: 95 % interval of the mean"
    alone = by_setting(relative, {row: row for row in relative["row"]})
    assert alone["interval_low"].isna().all()
    assert replicate_remark(alone) == NO_REPLICATES


def test_means_are_surface_by_surface():
    """Convex and plain replicates are averaged, and scatter, each for themselves."""
    runs = pd.DataFrame(
        {
            "run": ["a", "b", "c", "d"],
            "row": ["R1-1", "R1-1", "R1-2", "R1-2"],
            "surface": ["convex", "plain"] * 2,
            "regime": "continuous",
            "relative_wear": [0.4, 1.0, 0.6, 1.0],
        }
    )
    settings = {"R1-1": "R1", "R1-2": "R1"}
    means = mean_of_replicates(runs, settings)
    assert means[["row", "surface", "relative_wear"]].to_numpy().tolist() == [
        ["R1", "convex", 0.5],
        ["R1", "plain", 1.0],
    ]
    assert means["regime"].tolist() == ["continuous", "continuous"]
    mixed = mean_of_replicates(
        runs.assign(regime=["continuous", "continuous", "discontinuous", "continuous"]), settings
    )
    assert mixed["regime"].tolist() == ["undecided", "continuous"]
    table = with_intervals(runs, settings).set_index("surface")
    assert table.loc["plain", "interval_low"] == pytest.approx(1.0)
    assert table.loc["convex", "interval_low"] < 0.4
    assert table["replicates"].tolist() == [2, 2]
