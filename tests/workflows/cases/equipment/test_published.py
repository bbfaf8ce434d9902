"""Published values beside what a study of equipment computes: names, units, differences."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.equipment import comparison, flow_tables, life, life_tables, published, tables
from tests.workflows.cases.equipment.synthetic import SyntheticPart, SyntheticRun, write_study

PARTS = (SyntheticPart("liner", (1e-6, 5e-6), error=0.2), SyntheticPart("wheel", (4e-6,), power=100.0))
HOURS_PER_YEAR = 6000.0  # of the synthetic runs
TURNING = {"kind": "rotation", "speed_rad_per_s": -np.pi}
COLUMNS = ["study", "quantity", "value", "low", "high", "unit", "source", "note"]


def of_setting(setting, factors):
    """A run of each factor, of one setting."""
    runs = enumerate(factors, start=1)
    return [SyntheticRun(f"{setting}-{k}", PARTS, setting, k, factor=factor, pristine=8) for k, factor in runs]


@pytest.fixture
def numbers(tmp_path):
    """The key numbers of a synthetic study of two designs and two packings by name and setting; its wheel turns."""
    runs = [*of_setting("plain", (0.99, 1.01)), *of_setting("R9", (0.495, 0.505))]
    values = write_study(tmp_path, runs)
    for each in values:
        each["parts"]["wheel"]["motion"] = TURNING
    read = tables.read_runs(values, tmp_path)
    lives = life.part_lives(read, {})
    charge = pd.DataFrame({"setting": "plain", "packing": [1, 2], "phase": "worn", "toe_deg": [120.0, 130.0]})
    found = {
        "life": life_tables.life_table(read, lives),
        "loads": tables.loads_table(read),
        "steel": life_tables.steel_table(read, lives),
        "remaining": life_tables.remaining_table(read, lives),
        "designs": comparison.designs_table(read, lives),
        "flow": flow_tables.flow_table(read),
        "charge": charge.assign(shoulder_deg=300.0),
    }
    return published.key_numbers(found, values)


@pytest.mark.parametrize(
    ("quantity", "value", "unit"),
    [
        ("power_W_wheel_pristine", 100.0, "W"),
        ("remaining_liner_after_300_h", 28.5, "mm"),
        ("worst_recession_liner_pristine", 5.0, "mm per 1,000 h"),
        ("wear_coefficient_liner", 6e-13, "1/Pa"),
        ("speed_wheel", 30.0, "rpm"),
        ("held_worn", 20.0, "kg"),
        ("out_pristine", 180.0, "t/h"),
        ("toe_worn", 125.0, "degrees"),
    ],
)
def test_numbers_by_name(numbers, quantity, value, unit):
    """A name tells quantity, part and shape; units stand beside it."""
    row = numbers[numbers["setting"] == "plain"].set_index("quantity").loc[quantity]
    assert row["value"] == pytest.approx(value, rel=1e-3) and row["unit"] == unit


def test_life_in_weeks_of_service(numbers):
    """The life in hours over those that a year has, of 52.18 weeks, with its interval."""
    table = numbers[numbers["setting"] == "plain"].set_index("quantity")
    hours, weeks = table.loc["life_liner"], table.loc["life_in_weeks_liner"]
    for name in ("value", "low", "high"):
        assert weeks[name] == pytest.approx(hours[name] / HOURS_PER_YEAR * 365.25 / 7.0)


def test_every_number_is_there_once(numbers):
    """No name stands twice for a setting."""
    assert not numbers.duplicated(["quantity", "setting"]).any()


def test_less_steel_than_the_first_design(numbers):
    """Half the rate is 50 % less, with its interval in the right order; the first design has no such number."""
    rows = numbers[numbers["quantity"] == "less_steel_lost_liner"]
    assert rows["setting"].tolist() == ["R9"]
    row = rows.iloc[0]
    assert row["value"] == pytest.approx(50.0) and row["low"] < 50.0 < row["high"]


def test_computed_beside_published(numbers):
    """Differences of values, place in ranges; another unit, or what is not computed, stands there without."""
    rows = [
        ["s", "speed_wheel", 25.0, np.nan, np.nan, "rpm", "someone", ""],
        ["s", "held_worn", np.nan, 25.0, 30.0, "kg", "", ""],
        ["s", "toe_worn", np.nan, 120.0, 130.0, "degrees", "", ""],
        ["s", "speed_wheel", 1.0, np.nan, np.nan, "rad/s", "", ""],
        ["s", "colour", 1.0, np.nan, np.nan, "-", "", ""],
    ]
    plain = numbers[numbers["setting"] == "plain"]
    table = published.beside_anchors(pd.DataFrame(rows, columns=COLUMNS), plain)
    assert table["difference_percent"].iloc[0] == pytest.approx(20.0)
    assert table["where"].tolist() == ["", published.BELOW, published.INSIDE, "", ""]
    assert table["computed_value"].notna().tolist() == [True, True, True, False, False]
