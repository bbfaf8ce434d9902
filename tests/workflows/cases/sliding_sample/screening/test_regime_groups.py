"""Settings by flow regime: groups of rows, relative wear, forces, rows in detail, published rows."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from bulkwear.workflows.cases.sliding_sample import charts
from bulkwear.workflows.cases.sliding_sample.evaluation import CONTINUOUS, DISCONTINUOUS, UNDECIDED
from bulkwear.workflows.cases.sliding_sample.screening.regime_groups import (
    by_group,
    force_by_group,
    gradients_by_group,
    groups_of_rows,
    of_published_rows,
    published_rows_in_detail,
    regime_remarks,
    rows_in_detail,
    wear_by_group,
)

ROUNDING = 1e-12


@pytest.fixture
def regimes():
    """R1 and R3 are continuous, R2 is discontinuous over its convex sample although not over the plain one."""
    rows = [("R1", CONTINUOUS, CONTINUOUS), ("R2", DISCONTINUOUS, CONTINUOUS), ("R3", CONTINUOUS, CONTINUOUS)]
    return pd.DataFrame(
        [
            {"run": f"{row}_{surface}", "row": row, "setting": row, "packing": 1, "surface": surface, "regime": regime}
            | {"steady": surface == "plain"}
            for row, *found in rows
            for surface, regime in zip(("convex", "plain"), found, strict=True)
        ]
    )


@pytest.fixture
def summary(regimes):
    """Wear per metre 1, 2, 4, 8, 2, 4 e-9 m3/m over different travels; a quarter of it on bumps of convex runs."""
    travel = np.array([1.0, 1.0, 0.5, 0.5, 1.0, 1.0])
    volume = 1e-9 * np.array([1.0, 2.0, 4.0, 8.0, 2.0, 4.0]) * travel
    bumps = np.where(regimes["surface"] == "convex", 0.25, 0.0) * volume
    return regimes[["run", "row", "setting", "packing", "surface"]].assign(
        travel_m=travel,
        worn_volume_m3=volume,
        base_worn_volume_m3=volume - bumps,
        pattern_worn_volume_m3=bumps,
        mean_normal_force_N=5.0,
        wear_over_plain=[0.5, 1.0, 0.5, 1.0, 0.5, 1.0],
    )


def test_a_row_is_in_the_group_of_its_convex_run(regimes, summary):
    """The plain twin goes with its row; continuous rows come first; a plain run alone has its own."""
    table = by_group(summary, regimes)
    assert table["row"].tolist() == ["R1", "R1", "R3", "R3", "R2", "R2"]
    assert table["regime"].tolist() == [CONTINUOUS] * 4 + [DISCONTINUOUS] * 2
    plain = regimes[regimes["surface"] == "plain"]
    assert groups_of_rows(plain).to_dict() == plain.set_index("row")["regime"].to_dict()
    assert set(by_group(summary, regimes.head(0))["regime"]) == {UNDECIDED}


def test_packings_of_different_regimes_are_undecided(regimes):
    """A row whose packings do not flow alike is in no group, though each of them is."""
    other = regimes.assign(row=regimes["row"] + "-2", regime=CONTINUOUS)
    found = groups_of_rows(pd.concat([regimes, other], ignore_index=True))
    assert found[["R2", "R2-2"]].tolist() == [UNDECIDED] * 2
    assert found[["R1", "R3-2"]].tolist() == [CONTINUOUS] * 2


BED = {"velocity": 0.5, "thickness": 0.02, "width": 0.1, "bulk_density": 2000.0}


def test_relative_wear_is_per_length_within_the_group(regimes, summary):
    """The largest of each group has 1 whatever its travel, and base and bumps add up (Eq 3.10); wear rates are per mass
    flow: 1e-9 m3 worn while 2 kg/s pass are 0.5 mm3 s/kg (Eq 3.11).
    """
    beds = dict.fromkeys(summary["run"], BED)
    table = wear_by_group(summary, regimes, beds)
    assert charts.WEAR_BY_REGIME.columns() <= set(table)
    table = table.set_index(["setting", "surface"])
    expected = [0.25, 0.5, 0.5, 1.0, 0.5, 1.0]
    assert table.index.get_level_values("setting").tolist() == ["R1", "R1", "R3", "R3", "R2", "R2"]
    np.testing.assert_allclose(table["relative_wear"], expected, rtol=ROUNDING)
    total = table["base_relative_wear"] + table["bump_relative_wear"]
    np.testing.assert_allclose(total, table["relative_wear"], rtol=ROUNDING)
    assert table.loc[("R2", "convex"), "bump_relative_wear"] == pytest.approx(0.125, rel=ROUNDING)
    assert table.loc[("R1", "convex"), "wear_rate_mm3_s_per_kg"] == pytest.approx(0.5, rel=ROUNDING)
    assert table.loc[("R2", "plain"), "wear_rate_mm3_s_per_kg"] == pytest.approx(2.0, rel=ROUNDING)


def test_intervals_are_scaled_with_the_wear(regimes, summary):
    """Two packings, one wearing e times as much: Student's interval of ln, over the largest mean of the group."""
    more = summary.assign(row=summary["row"] + "-2", run=summary["run"] + "-2", packing=2)
    more["worn_volume_m3"] *= np.e
    both = pd.concat([summary, more], ignore_index=True)
    beds = dict.fromkeys(both["run"], BED)
    twice = pd.concat([regimes, regimes.assign(row=regimes["row"] + "-2")], ignore_index=True)
    found = wear_by_group(both, twice, beds).set_index(["setting", "surface"]).loc[("R1", "convex")]
    reach = stats.t.ppf(0.975, 1) * 0.5
    assert found["relative_wear"] == pytest.approx(0.25, rel=ROUNDING)
    ends = 0.25 * np.exp([-reach, reach])
    assert found[["interval_low", "interval_high"]].tolist() == pytest.approx(ends, rel=1e-9)
    force = force_by_group(both, twice)
    assert charts.FORCE_BY_REGIME.columns() <= set(force)
    assert force["packings"].unique().tolist() == [2]
    assert force[["mean_normal_force_N", "interval_low", "interval_high"]].to_numpy() == pytest.approx(5.0)


def test_gradients_have_the_group_of_their_row(regimes):
    """Runs that wear evenly have one gradient all along, and the regime of their row's convex run."""
    tables = [
        pd.DataFrame({**run, "travel_mm": [0.0, 10.0, 20.0], "worn_volume_mm3": np.array([0.0, 1.0, 2.0]) * (k + 1)})
        for k, run in enumerate(regimes[["run", "row", "surface"]].to_dict("records"))
    ]
    table = gradients_by_group(pd.concat(tables, ignore_index=True), regimes)
    np.testing.assert_allclose(table.loc[table["run"] == "R2_plain", "relative_gradient"], 4.0 / 6.0, rtol=ROUNDING)
    assert charts.WEAR_GRADIENT.columns() <= set(table)
    assert table.groupby("row")["regime"].first().to_dict() == {"R1": CONTINUOUS, "R2": DISCONTINUOUS, "R3": CONTINUOUS}


def test_rows_in_detail(regimes, summary):
    """Preferred rows first if the study has them, then the lowest relative wear of each regime."""
    lower = summary.assign(wear_over_plain=[0.9, 1.0, 0.8, 1.0, 0.3, 1.0])
    assert rows_in_detail(lower, regimes) == ["R3", "R2"]
    assert rows_in_detail(lower, regimes, ["R1"]) == ["R1", "R3"]
    assert rows_in_detail(lower, regimes, ["R9"], most=3) == ["R3", "R2", "R1"]


def test_published_rows_under_own_names():
    """A published row stands under every row of the same factors; rows that the study does not have are left out."""
    published = pd.DataFrame({"row": ["R5", "R5", "R2"], "value": [1.0, 2.0, 3.0]})
    table = of_published_rows(published, {"A": "R5", "B": "R5"})
    assert table["row"].tolist() == ["A", "A", "B", "B"]
    assert of_published_rows(published, {}).empty
    assert published_rows_in_detail({"x": "R2", "y": "R7", "z": "R5"}) == ["z", "x"]


def test_unsteady_flow_is_said(regimes):
    """Figures by regime tell how many runs are not shown to be steady, and nothing where all are."""
    assert regime_remarks(regimes) == ["regimes of 3 of 6 runs are of a flow not shown to be steady"]
    assert regime_remarks(regimes.assign(steady=True)) == []
