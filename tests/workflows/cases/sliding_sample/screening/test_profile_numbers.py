"""Single values of the source's profiles beside ours, by made-up profiles."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.statistics.verdicts import AGREES, OTHER_SIZE, UNSAID
from bulkwear.workflows.cases.sliding_sample.screening.profile_numbers import (
    COLUMNS,
    at_height,
    profile_values,
    profiles_beside_source,
)
from bulkwear.workflows.report.published import published_numbers
from bulkwear.workflows.report.sections import Section
from tests import PUBLISHED

SOURCE = pd.read_csv(PUBLISHED / "screening_profiles.csv")
SCALE = 2  # of our particles: layers of 10 mm
VELOCITIES = (1.5, 0.8, 0.6, 0.3)  # m/s, by layer


def profile(row, surface, zone, factor=1.0):
    """A profile of four layers, its other numbers in proportion to the velocity."""
    layers = np.arange(len(VELOCITIES))
    numbers = {column: factor * np.array(VELOCITIES) for column in COLUMNS.values()}
    places = {"run": f"{row}_{surface}", "row": row, "surface": surface, "zone": zone}
    return pd.DataFrame({**places, "layer": layers, "height_mm": (layers + 0.5) * 5.0 * SCALE, **numbers})


PROFILES = pd.concat(
    [profile(row, "convex", "central", 1.0 + 0.01 * packing) for packing, row in enumerate(("R5", "R5-2", "R5-3"))]
)
SETTINGS = {"R5": "R5", "R5-2": "R5", "R5-3": "R5", "R2": "R2"}


def test_a_height_is_that_of_the_layer_that_holds_it():
    """Layer 1 and 8 of 5 mm lie in the first and the fourth of 10 mm; above the last one there is none."""
    one = profile("R5", "convex", "central")
    assert [at_height(one, "velocity_m_per_s", height) for height in (2.5, 37.5)] == [1.5, 0.3]
    assert np.isnan(at_height(one, "velocity_m_per_s", 42.5))
    assert np.isnan(at_height(one[one["layer"] != 1], "velocity_m_per_s", 12.5))  # too few particles


def test_values_and_bounds_stand_beside_means_over_packings():
    """Of rows that were run alone; another surface or zone than ours is not computed; a bound has one end."""
    central = SOURCE[(SOURCE["zone"] == "central") & (SOURCE["quantity"] == "velocity")]
    beside = profiles_beside_source(PROFILES, SETTINGS, central).set_index("setting")
    names = ("convex, central, layer 1", "convex, central, layer 8", "plain, central, layer 1")
    assert list(beside.index) == [f"R5, {name}" for name in names]
    first, last = beside.loc["R5, convex, central, layer 1"], beside.loc["R5, convex, central, layer 8"]
    assert (first["computed_value"], last["computed_value"]) == pytest.approx((1.5 * 1.01, 0.3 * 1.01))
    assert first["computed_low"] < first["computed_value"] < first["computed_high"] and first["packings"] == 3
    plain = beside.loc["R5, plain, central, layer 1"]
    assert plain["published_high"] == 0.2 and np.isnan(plain["computed_value"])
    ratios = profiles_beside_source(PROFILES, SETTINGS, SOURCE[SOURCE["quantity"] == "upward_ratio"])
    assert ratios["margin"].tolist()[:2] == [0.05, 0.05]  # of 0.0 and 0.3, told to a tenth


def test_the_page_collects_them(tmp_path):
    """As findings with verdicts, named as in the list of what is not compared; nothing of a study without such rows."""
    (tmp_path / "flow").mkdir()
    PROFILES.to_csv(tmp_path / "flow" / "profiles.csv", index=False)
    pd.DataFrame(list(SETTINGS.items()), columns=["row", "setting"]).to_csv(tmp_path / "summary.csv", index=False)
    blocks = profile_values({"told": {"published_rows": {"R5": "R5", "R2": "R2"}}}, tmp_path)
    found = published_numbers([Section("Flow", blocks)]).set_index("finding")
    verdicts = found["verdict"].to_dict()
    assert verdicts["velocity, R5, convex, central, layer 1"] == AGREES
    assert verdicts["velocity, R5, convex, central, layer 8"] == OTHER_SIZE
    assert verdicts["velocity, R5, plain, central, layer 1"] == UNSAID
    assert not any("R2" in finding for finding in found.index)
    assert profile_values({"told": {"published_rows": {}}}, tmp_path) == []
