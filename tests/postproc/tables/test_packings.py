"""A line per setting instead of per run: means over packings, intervals, and what figures say of them."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.tables.packings import (
    MIXED,
    first_packings,
    over_packings,
    packings_remark,
    relative_wear_of_settings,
    shown_remark,
)
from bulkwear.postproc.tables.summary import rows_to_show, runs_of_rows

ROUNDING = 1e-12


@pytest.fixture
def summary():
    """R9 in two packings, whose convex samples wear e^-1 and e^-2 of plain ones, and R5 in one, at 0.1."""
    ratios = [("R9", "R9", 1, np.exp(-1.0)), ("R9-2", "R9", 2, np.exp(-2.0)), ("R5", "R5", 1, 0.1)]
    rows = [
        {"run": f"{row}_{surface}", "row": row, "setting": setting, "packing": packing, "surface": surface}
        | {"wear_over_plain": value, "base": 0.75 * value, "bumps": 0.25 * value, "regime": f"{setting}{packing % 2}"}
        for row, setting, packing, ratio in ratios
        for surface, value in (("convex", ratio), ("plain", 1.0))
    ]
    return pd.DataFrame(rows)


def test_a_setting_is_one_line(summary):
    """Its mean is geometric, its interval Student's on one degree of freedom, and parts still add up to it."""
    table = over_packings(summary, "wear_over_plain", parts=("base", "bumps")).set_index(["setting", "surface"])
    convex = table.loc["R9", "convex"]
    assert convex["wear_over_plain"] == pytest.approx(np.exp(-1.5), rel=ROUNDING)
    reach = stats.t.ppf(0.975, 1) * 0.5
    ends = np.exp([-1.5 - reach, -1.5 + reach])
    assert convex[["interval_low", "interval_high"]].tolist() == pytest.approx(ends, rel=ROUNDING)
    assert convex["base"] + convex["bumps"] == pytest.approx(convex["wear_over_plain"], rel=ROUNDING)
    assert convex["packings"] == 2 and convex["regime"] == MIXED
    alone = table.loc["R5", "convex"]
    assert alone["wear_over_plain"] == pytest.approx(0.1) and alone["regime"] == "R51"
    assert alone[["interval_low", "interval_high"]].isna().all()
    assert "run" not in table and "packing" not in table


def test_relative_wear_leaves_out_plain_samples_and_rows_without_a_twin(summary):
    """What has no plain sample in the same packing has no relative wear."""
    lost = summary.assign(wear_over_plain=summary["wear_over_plain"].mask(summary["row"] == "R9-2"))
    table = relative_wear_of_settings(lost)
    assert table[["setting", "surface", "packings"]].to_numpy().tolist() == [["R9", "convex", 1], ["R5", "convex", 1]]
    assert relative_wear_of_settings(summary.assign(wear_over_plain=np.nan)).empty


def test_shown_rows_are_first_packings_of_settings_that_wear_least(summary):
    """The lowest mean comes first, not the lowest packing; studies without plain runs show their first row."""
    assert rows_to_show(summary, 1) == ["R5"]
    assert rows_to_show(summary, 5) == ["R5", "R9"]
    assert rows_to_show(summary.assign(wear_over_plain=np.nan), 1) == ["R9"]
    assert runs_of_rows(summary, ["R9"]) == ["R9_convex", "R9_plain"]
    assert first_packings(summary)["row"].unique().tolist() == ["R9", "R5"]
    chosen = summary[summary["row"] != "R9"]
    assert first_packings(chosen)["row"].unique().tolist() == ["R9-2", "R5"]


def test_figures_say_what_their_bars_are(summary):
    """How many packings, and where there is one that its scatter is unknown, and nothing else."""
    assert packings_remark(pd.Series([1, 1])) == UNKNOWN
    assert packings_remark(pd.Series([3, 3])) == "bars of error: 95 % intervals of the mean over 3 packings"
    mixed = packings_remark(pd.Series([1, 2, 3]))
    assert mixed.startswith("bars of error") and "2 to 3" in mixed and mixed.endswith(UNKNOWN)
    assert shown_remark(summary) == ["the first of 2 packings is shown"]
    assert shown_remark(summary[summary["packing"] == 1]) == []
