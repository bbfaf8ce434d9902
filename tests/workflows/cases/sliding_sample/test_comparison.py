"""Runs against their plain twins."""

import numpy as np
import pandas as pd
import pytest

from postproc.tables.summary import rows_to_show, runs_of_rows
from workflows.cases.sliding_sample.comparison import cycle_ratios, law_comparison, relative_wear_table, wear_split

RELATIVE = 1e-12  # rounding of one quotient


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
            "archard_volume_m3": volume[[2, 3, 0, 1]],
            "base_archard_volume_m3": (volume - bumps)[[2, 3, 0, 1]],
            "bump_archard_volume_m3": bumps[[2, 3, 0, 1]],
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
                "archard_volume_mm3": np.cumsum([0, *steps]),
            }
        )
        for run, surface, steps in runs
    ]
    return pd.concat(tables, ignore_index=True)


def test_split_adds_up_to_the_relative_wear(summary):
    """Base and bumps over plain add up to wear over plain; a plain sample is 1."""
    split = wear_split(summary)
    total = split["base_over_plain"] + split["bump_over_plain"]
    np.testing.assert_allclose(total, summary["wear_over_plain"], rtol=RELATIVE)


def test_laws_stand_side_by_side(summary):
    """The ratio of the laws is that of their volumes."""
    table = law_comparison(summary)
    np.testing.assert_allclose(table["finnie_over_archard"], 0.01, rtol=RELATIVE)
    np.testing.assert_allclose(table["archard_volume_mm3"], summary["archard_volume_m3"] * 1e9, rtol=RELATIVE)


def test_range_over_cycles():
    """Ratios are formed cycle by cycle from increments, not from sums."""
    found = cycle_ratios(history_of([1.0, 2.0, 3.0], [2.0, 2.0, 2.0]))
    assert found.loc[0, ["lowest_cycle_ratio", "highest_cycle_ratio"]].tolist() == [0.5, 1.5]


def test_cycles_of_other_lengths_are_compared_over_the_same_travel():
    """A plain twin worn in other cycles is interpolated: the same wear per travel is a ratio of one throughout."""
    history = history_of([1.0, 2.0, 3.0], [1.0, 1.0, 4.0])
    convex = history["surface"] == "convex"
    history.loc[convex, ["travel_mm", "archard_volume_mm3"]] = [[0, 0], [5, 0.5], [20, 2.0], [30, 6.0]]
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
