"""Runs against their plain twins, and scatter between replicates: geometric means, one scatter for all settings."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from bulkwear.postproc.tables.summary import rows_to_show, runs_of_rows
from bulkwear.workflows.cases.sliding_sample.comparison import (
    NO_REPLICATES,
    by_setting,
    cycle_ratios,
    law_comparison,
    mean_of_replicates,
    relative_wear_table,
    replicate_intervals,
    replicate_remark,
    wear_split,
    with_intervals,
)

RELATIVE = 1e-12  # rounding of one quotient
ROUNDING = 1e-9
TRIALS = 400
SURE = 4.0  # standard deviations of a count of trials


@pytest.fixture
def summary():
    """Two rows: A wears 0.5 of its plain twin, B 1.5; A's plain wears 4 mm3, B's 2 mm3."""
    volume = np.array([2.0, 4.0, 3.0, 2.0]) * 1e-9
    bumps = np.array([1.5, 0.0, 0.5, 0.0]) * 1e-9
    return pd.DataFrame(
        {
            "run": ["B_convex", "B_plain", "A_convex", "A_plain"],
            "row": ["B", "B", "A", "A"],
            "surface": ["convex", "plain"] * 2,
            "worn_volume_m3": volume[[2, 3, 0, 1]],
            "base_worn_volume_m3": (volume - bumps)[[2, 3, 0, 1]],
            "pattern_worn_volume_m3": bumps[[2, 3, 0, 1]],
            "finnie_volume_m3": 0.01 * volume[[2, 3, 0, 1]],
            "wear_over_plain": [1.5, 1.0, 0.5, 1.0],
        }
    )


def history_of(*volumes):
    """Cumulative volumes of the convex and the plain run of row A over three cycles."""
    runs = zip(("A_convex", "A_plain"), ("convex", "plain"), volumes, strict=True)
    tables = [
        pd.DataFrame(
            {
                "run": run,
                "row": "A",
                "surface": surface,
                "cycle": range(4),
                "travel_mm": np.arange(4) * 10.0,
                "worn_volume_mm3": np.cumsum([0, *steps]),
            }
        )
        for run, surface, steps in runs
    ]
    return pd.concat(tables, ignore_index=True)


def test_split_adds_up_to_the_relative_wear(summary):
    """Base and bumps over plain add up to wear over plain; a plain sample is 1."""
    split = wear_split(summary)
    total = split["base_over_plain"] + split["pattern_over_plain"]
    np.testing.assert_allclose(total, summary["wear_over_plain"], rtol=RELATIVE)


def test_laws_stand_side_by_side(summary):
    """The ratio of the laws is that of their volumes."""
    table = law_comparison(summary)
    np.testing.assert_allclose(table["finnie_over_archard"], 0.01, rtol=RELATIVE)
    np.testing.assert_allclose(table["worn_volume_mm3"], summary["worn_volume_m3"] * 1e9, rtol=RELATIVE)


def test_range_over_cycles():
    """Ratios are formed cycle by cycle from increments, not from sums."""
    found = cycle_ratios(history_of([1.0, 2.0, 3.0], [2.0, 2.0, 2.0]))
    assert found.loc[0, ["lowest_cycle_ratio", "highest_cycle_ratio"]].tolist() == [0.5, 1.5]


def test_cycles_of_other_lengths_are_compared_over_the_same_travel():
    """A plain twin worn in other cycles is interpolated: the same wear per travel is a ratio of one throughout."""
    history = history_of([1.0, 2.0, 3.0], [1.0, 1.0, 4.0])
    convex = history["surface"] == "convex"
    history.loc[convex, ["travel_mm", "worn_volume_mm3"]] = [[0, 0], [5, 0.5], [20, 2.0], [30, 6.0]]
    found = cycle_ratios(history)
    np.testing.assert_allclose(found.loc[0, ["lowest_cycle_ratio", "highest_cycle_ratio"]].astype(float), 1.0)


def test_relative_wear_keeps_rows_without_history(summary):
    """Every run that is not plain has its line, with alpha_ER; a row without history has no range."""
    table = relative_wear_table(summary, history_of([1.0] * 3, [2.0] * 3), {"A_convex": 0.7, "B_convex": 0.3})
    assert table["run"].tolist() == ["B_convex", "A_convex"]
    assert table["equivalent_size_ratio"].tolist() == [0.3, 0.7]
    assert np.isnan(table["lowest_cycle_ratio"].iloc[0])
    assert table["lowest_cycle_ratio"].iloc[1] == 0.5


def test_shown_rows_are_those_that_wear_least(summary):
    """The lowest relative wear comes first; studies without plain runs show their first row."""
    assert rows_to_show(summary, 1) == ["A"]
    assert rows_to_show(summary, 5) == ["A", "B"]
    assert rows_to_show(summary.assign(wear_over_plain=np.nan), 1) == ["B"]
    assert runs_of_rows(summary, ["A"]) == ["A_convex", "A_plain"]


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
