"""What each wear update did, from wear.csv to a tidy table."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.tables.updates import drawn_in_log, update_summary, wear_updates

RELATIVE = 1e-12  # rounding of a few products, and of CSV text
WEAR = {
    "cycle": [1, 2, 3],
    "travel_m": [0.01, 0.03, 0.04],
    "worn_volume_m3": [2e-9, 4e-9, 0.0],
    "applied_volume_m3": [1e-9, 3e-9, 2e-9],
    "carried_volume_m3": [1e-9, 2e-9, 0.0],
    "largest_step_m": [2e-6, 1e-6, 1e-6],
    "step_limit_m": [2e-6, 4e-6, 4e-6],
    "step_demand": [3.0, 1.5, 0.2],
    "smallest_angle_deg": [30.0, 12.0, 20.0],
    "remeshed_faces": [0, 7, 5],
    "bad_faces_left": [0, 2, 0],
    "balance_error": [0.0, 1e-12, 3e-12],
}


@pytest.fixture
def updates(tmp_path):
    """The table of a design of one row, whose two runs have done the same."""
    (tmp_path / "design.csv").write_text(
        "run,row,setting,packing,surface\n1_convex,1,1,1,convex\n1_plain,1,1,1,plain\n"
    )
    pd.DataFrame(WEAR).to_csv(tmp_path / "wear.csv", index=False)
    return wear_updates(tmp_path / "design.csv", [tmp_path / "wear.csv"] * 2)


def test_shares_are_of_what_the_law_takes_in_the_cycle(updates):
    """Applied over the cycle's volume is 1 + carried before - carried after, over it; without wear none."""
    run = updates[updates["run"] == "1_convex"]
    assert run["applied_percent"].tolist()[:2] == pytest.approx([50.0, 75.0], rel=RELATIVE)
    assert run["carried_percent"].tolist()[:2] == pytest.approx([50.0, 50.0], rel=RELATIVE)
    assert run[["applied_percent", "carried_percent"]].iloc[2].isna().all()


def test_cycles_follow_each_other_along_the_travel(updates):
    """Each cycle begins where the one before it ends, the first at no travel; lengths are in mm, names text."""
    run = updates[updates["run"] == "1_plain"]
    np.testing.assert_allclose(run["cycle_start_mm"], [0.0, 10.0, 30.0], rtol=RELATIVE)
    np.testing.assert_allclose(run["travel_mm"], [10.0, 30.0, 40.0], rtol=RELATIVE)
    assert set(updates["row"]) == {"1"}


def test_steps_stand_against_their_caps(updates):
    """The step taken is over the largest cap of a node; the wanted one is as the wear step tells it."""
    run = updates[updates["run"] == "1_convex"]
    np.testing.assert_allclose(run["step_taken"], [1.0, 0.25, 0.25], rtol=RELATIVE)
    assert run["step_demand"].tolist() == WEAR["step_demand"]


def test_a_rigid_cap_is_no_division(tmp_path):
    """Where no node may move there is no share of the cap."""
    (tmp_path / "design.csv").write_text("run,row,setting,packing,surface\n1_plain,1,1,1,plain\n")
    pd.DataFrame({**WEAR, "step_limit_m": 0.0}).to_csv(tmp_path / "wear.csv", index=False)
    assert wear_updates(tmp_path / "design.csv", [tmp_path / "wear.csv"])["step_taken"].isna().all()


def test_summary_is_the_worst_of_all_packings(updates):
    """Of two packings: least applied, most carried, largest steps, smallest angle, all remeshed faces."""
    calm = updates.assign(packing=2, remeshed_faces=0, step_demand=0.1, smallest_angle_deg=33.0)
    summary = update_summary(pd.concat([updates, calm])).set_index("surface").loc["plain"]
    expected = {
        "applied_percent": 50.0,
        "carried_percent": 50.0,
        "step_demand": 3.0,
        "step_taken": 1.0,
        "smallest_angle_deg": 12.0,
        "remeshed_faces": 12,
        "bad_faces_left": 2,
        "balance_error": 3e-12,
    }
    assert summary[list(expected)].to_dict() == pytest.approx(expected, rel=RELATIVE)


def test_zero_has_no_place_on_a_log_axis():
    """What closes exactly is left out, everything else stays."""
    np.testing.assert_array_equal(drawn_in_log(pd.Series([0.0, 1e-12])), [np.nan, 1e-12])
