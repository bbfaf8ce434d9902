"""Published values beside what a study of equipment computes: names, units, differences."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.workflows.cases.equipment import comparison, flow_tables, life, life_tables, published, tables
from tests.workflows.cases.equipment.synthetic import SyntheticPart, SyntheticRun, write_study

PARTS = (SyntheticPart("liner", (1e-6, 5e-6), error=0.2), SyntheticPart("wheel", (4e-6,), power=100.0))
HOURS_PER_YEAR = 6000.0  # of the synthetic runs
TURNING = {"kind": "rotation", "speed_rad_per_s": -np.pi}
LIFTERS = pd.DataFrame(
    {
        **{"setting": "plain", "part": "wheel", "operation_h": [0.0, 100.0, 200.0], "packings": 2, "lifters": 8},
        **{"height_mm": [65.0, 60.0, 50.0], "height_mm_low": [65.0, 58.0, 46.0], "height_mm_high": [65.0, 62.0, 54.0]},
        **{"leading_face_angle_deg": [14.0, 20.0, 30.0], "leading_face_angle_deg_low": [14.0, 19.0, 28.0]},
        **{"leading_face_angle_deg_high": [14.0, 21.0, 32.0], "height_loss_mm_per_1000h": [np.nan, 50.0, 75.0]},
        **{"height_loss_mm_per_1000h_low": [np.nan, 40.0, 70.0], "height_loss_mm_per_1000h_high": [np.nan, 60.0, 80.0]},
    }
)
COLUMNS = ["study", "quantity", "value", "low", "high", "unit", "source", "note"]


def of_setting(setting, factors):
    """A run of each factor, of one setting."""
    runs = enumerate(factors, start=1)
    return [SyntheticRun(f"{setting}-{k}", PARTS, setting, k, factor=factor, pristine=8) for k, factor in runs]


@pytest.fixture(scope="module")
def numbers(tmp_path_factory):
    """The key numbers of a synthetic study of two designs and two packings by name and setting; its wheel turns."""
    folder = tmp_path_factory.mktemp("study")
    runs = [*of_setting("plain", (0.99, 1.01)), *of_setting("R9", (0.495, 0.505))]
    values = write_study(folder, runs)
    for each in values:
        each["parts"]["wheel"]["motion"] = TURNING
    read = tables.read_runs(values, folder)
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
        "lifters": LIFTERS,
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
        ("load_angle_worn", 32.5, "degrees"),
        ("lifter_height_wheel_pristine", 65.0, "mm"),
        ("lifter_height_wheel_worn", 50.0, "mm"),
        ("lifter_face_angle_wheel_pristine", 14.0, "degrees"),
        ("lifter_face_angle_wheel_worn", 30.0, "degrees"),
        ("lifter_height_loss_wheel", 75.0, "mm per 1,000 h"),
    ],
)
def test_numbers_by_name(numbers, quantity, value, unit):
    """A name tells quantity, part and shape; units stand beside it."""
    row = numbers[numbers["setting"] == "plain"].set_index("quantity").loc[quantity]
    assert row["value"] == pytest.approx(value, rel=1e-3) and row["unit"] == unit


def test_what_the_study_puts_in_is_marked(numbers):
    """Coefficients, speeds, and lifters as drawn; what the solver tells is not."""
    marked = set(numbers.loc[numbers["given"] == published.GIVEN, "quantity"])
    assert {"wear_coefficient_liner", "speed_wheel", "lifter_height_wheel_pristine"} <= marked
    assert not marked & {"lifter_height_wheel_worn", "life_liner", "toe_worn", "held_worn"}


def test_life_in_weeks_of_service(numbers):
    """The life in hours over those that a year has, of 52.18 weeks, with its interval."""
    table = numbers[numbers["setting"] == "plain"].set_index("quantity")
    hours, weeks = table.loc["life_liner"], table.loc["life_in_weeks_liner"]
    for name in ("value", "low", "high"):
        assert weeks[name] == pytest.approx(hours[name] / HOURS_PER_YEAR * 365.25 / 7.0)


def test_numbers_of_lifters_have_their_intervals(numbers):
    """Those of the table, at the row of the number."""
    row = numbers.set_index("quantity").loc["lifter_height_wheel_worn"]
    assert (row["low"], row["high"], row["packings"]) == (46.0, 54.0, 2)


@pytest.mark.parametrize(("rows", "left"), [(1, {"pristine"}), (2, {"pristine"})], ids=["never worn", "worn away"])
def test_lifters_that_are_not_there_have_no_numbers(rows, left):
    """Without updates there are none as worn, nor where the last update left no lifter."""
    lifters = LIFTERS.iloc[:rows].copy()
    lifters.loc[lifters.index[1:], lifters.columns[5:]] = np.nan
    found = published._lifters(lifters)
    assert {row["quantity"].removeprefix("lifter_height_wheel_") for row in found[::2]} == left
    assert not any("loss" in row["quantity"] for row in found)


@pytest.mark.parametrize(("toe", "shoulder", "angle"), [(128.0, 303.0, 35.5), (120.0, 10.0, 65.0)])
def test_load_angle(toe, shoulder, angle):
    """That of Kalala's toe and shoulder; a shoulder past 12 o'clock is still behind the toe."""
    charge = pd.DataFrame({"toe_deg": [toe], "shoulder_deg": [shoulder]})
    assert published._with_load_angle(charge)[published.LOAD_ANGLE].item() == pytest.approx(angle)


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


def test_a_value_that_is_published_of_some_settings_stands_beside_them_alone(numbers):
    """Of other settings it says nothing; without names it is beside all."""
    anchor = {"study": "s", "quantity": "speed_wheel", "value": 25.0, "low": np.nan, "high": np.nan, "unit": "rpm"}
    for named, beside in (("R9", ["R9"]), ("plain R9", ["plain", "R9"]), (np.nan, ["plain", "R9"]), ("R5", [""])):
        table = published.beside_anchors(pd.DataFrame([anchor | {"settings": named}]), numbers)
        assert sorted(table["setting"]) == sorted(beside) and "settings" not in table
