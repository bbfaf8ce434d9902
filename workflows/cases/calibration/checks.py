"""Checks of the tables of a calibration against its boxes and ranges, before any solver starts.

They come before those of the case, which tell what a table lacks: a file that is not there, a column, a number or a
response that is none. Such cells say nothing here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from bulkwear.postproc.flow.bulk_test import RESPONSES
from bulkwear.workflows.cases.calibration import boxes
from bulkwear.workflows.cases.calibration.box_checks import LEAST_FLOOR_DIAMETERS, at_most, enough
from bulkwear.workflows.config.layers import read_csv_rows
from bulkwear.workflows.config.published_tables import FOLDER
from bulkwear.workflows.config.run_checks import NO_VALUES, Check, CheckedRun, Fault, reaches
from bulkwear.workflows.engine.project import current_project

NAMES = {"measured": "response", "simulated_before": "row"}  # table of calibration.*: its column of names
OUR_PAIRS = ("found_first", "recommended")  # names that a calibration gives to pairs of its own
TIMES_FLOWING = (
    10.0  # -, of an estimated discharge time, either way. Published for one slot: 1 to 2.3 (gravel_pairs.csv)
)
STEEPEST = 1.0  # -, slope of what stays above an opening, for the least that flows out; heaps of calibrations were less
ANGLES = {
    "shear_angle_deg": "fill_height",
    "draw_down_shear_angle_deg": "fill_height",
    "repose_angle_deg": "lower_height",
}
STRAIGHT_UP = 90.0  # degrees
WALL_ANGLE, WALL_FRICTION = "wall_friction_angle_deg", "wall_material.contact.sliding_friction"


class MeasuredRow(NamedTuple):
    """A row of the table of measured responses that a test of the study simulates."""

    line: int
    test: str
    response: str
    value: float
    deviation: float


def _path(run: CheckedRun, key: str) -> Path | None:
    """Return the file that calibration.<key> names, None where there is none."""
    project, name = current_project(), run.settings["calibration"][key]
    return project.file(str(FOLDER / name)) if name in project.names(str(FOLDER), ".csv") else None


def _rows(run: CheckedRun, key: str) -> list[tuple[int, dict[str, str]]]:
    """Return (line in the file, {column: text}) of every row of the table that calibration.<key> names."""
    path = _path(run, key)
    return [] if path is None else read_csv_rows(path, current_project().folder)[1]


def _number(text: str | None) -> float:
    """Return the number that a cell holds, NaN where it holds none."""
    return float(pd.to_numeric(text or None, errors="coerce"))


def _simulated(run: CheckedRun) -> list[MeasuredRow]:
    """Return the measured responses that tests of the study simulate."""
    test_of = {name: test for test in run.settings["calibration"]["tests"] for name in RESPONSES[test]}
    return [
        MeasuredRow(line, test_of[name], name, _number(cells.get("value")), _number(cells.get("deviation")))
        for line, cells in _rows(run, "measured")
        if (name := cells.get("response", "")) in test_of
    ]


# ---------------------------------------------------------------- measured responses


def names_have_no_blanks(run: CheckedRun) -> Fault | None:
    """Columns, responses and rows of the tables have no blanks beside their names, which are a part of them."""
    for key, column in NAMES.items():
        if (path := _path(run, key)) is None:
            continue
        read_csv_rows(path, current_project().folder)
        table = pd.read_csv(path)
        for place, found in (("its header has", list(table)), ("it has", list(table.get(column, [])))):
            if wrong := next((name for name in found if isinstance(name, str) and name != name.strip()), None):
                return f"calibration.{key}", f"a table without blanks beside the names; {place} {wrong!r}"
    return None


def deviations_are_of_values(run: CheckedRun) -> Fault | None:
    """A deviation, and a discrepancy of the model, is smaller than the value that it is of: else nothing is told."""
    for line, cells in _rows(run, "measured"):
        for column in ("deviation", "model_discrepancy"):
            if _number(cells.get(column)) >= _number(cells.get("value")) > 0.0:
                found = f"{column} {cells[column]} of {cells.get('response')} {cells['value']}"
                return "calibration.measured", f"in it a {column} below the value; its line {line} has {found}"
    return None


def slopes_can_be_measured(run: CheckedRun) -> Fault | None:
    """A measured slope is long enough in its box for its angle to be measured there."""
    for row in (row for row in _simulated(run) if row.response in ANGLES):
        key, section = ANGLES[row.response], run.parameters[row.test]
        run_out = LEAST_FLOOR_DIAMETERS * run.parameters["particle"]["median_diameter_m"]
        most = math.degrees(math.atan(section[f"{key}_m"] / run_out))
        if row.value > most and not reaches(most, row.value):
            why = f"a steeper slope of {row.test}.{key}_mm is shorter than six particle diameters"
            allowed = f"in it {row.response} of at most {at_most(most)}: {why}; its line {row.line} has {row.value:g}"
            return "calibration.measured", allowed
    return None


def lower_box_holds_heap(run: CheckedRun) -> Fault | None:
    """The lower box of a draw-down test holds the heap of what flows through a slot, as steep as it was measured, or
    level; else it dams the slot, as an arch does.
    """
    if boxes.DRAW_DOWN not in run.settings["calibration"]["tests"]:
        return None
    test = boxes.test_of(run.parameters, boxes.DRAW_DOWN, {}, 0)
    rows = {row.response: row for row in _simulated(run)}
    stays = _slope(rows.get("draw_down_shear_angle_deg"), 1.0, STEEPEST)
    least, level = _heap_height(test, stays, _slope(rows.get("repose_angle_deg"), -1.0, 0.0))
    if test["box"]["opening"] != boxes.SLOT or reaches(test["box"]["lower_height_m"], least):
        return None
    dam = "what" if least == level else "the heap, as steep as the measured repose_angle_deg, of what"
    return "draw_down.lower_height_mm", f"at least {enough(1e3 * least)}: in a lower box {dam} flows out dams the slot"


def _slope(row: MeasuredRow | None, deviations: float, otherwise: float) -> float:
    """Return the slope (-) of a measured angle so many deviations on, another one where none was measured."""
    angle = row.value + deviations * row.deviation if row else math.nan
    return math.tan(math.radians(angle)) if 0.0 < angle < STRAIGHT_UP else otherwise


def _heap_height(test: Mapping[str, Any], stays: float, heap: float) -> tuple[float, float]:
    """Return how high (m) what flows through a slot lies in the lower box at the slot's edges, and how high if level.

    stays, heap: slopes (-) of what stays on both sides of the slot, and of the heap under it
    """
    length, height, opening = test["box"]["length_m"], test["box"]["fill_height_m"], boxes.opening_length(test)
    side = (length - opening) / 2.0
    foot = min(side, height / stays)
    flows = length * height - 2.0 * stays * foot * (side - foot / 2.0)  # m2 across
    level, rise = flows / length, heap * length / 4.0
    peak = level + rise if level >= rise else math.sqrt(heap * flows)  # it reaches the walls, or it does not
    return max(level, peak - heap * opening / 2.0), level


def discharge_is_of_the_opening(run: CheckedRun) -> Fault | None:
    """A measured discharge time is one that the opening may have, and no longer than what is simulated."""
    rest = run.parameters["rest"]
    for row in (row for row in _simulated(run) if row.response == "discharge_time_s"):
        expected = boxes.discharge_time(boxes.test_of(run.parameters, boxes.DRAW_DOWN, {}, 0))
        low, high = expected / TIMES_FLOWING, expected * TIMES_FLOWING
        if row.value < low or row.value > high:
            why = f"draw_down.opening_mm lets the filling out in about {expected:.2g} s"
            allowed = f"in it {row.response} from {enough(low)} to {at_most(high)}: {why}"
            return "calibration.measured", f"{allowed}; its line {row.line} has {row.value:g}"
        least = row.value + rest["calm_checks"] * rest["check_interval_s"]
        if rest["longest_s"] < least and not reaches(rest["longest_s"], least):
            told = f"line {row.line} of {run.settings['calibration']['measured']} has {row.response} {row.value:g}"
            return "rest.longest_s", f"at least {enough(least)}: {told}, after which rest is looked for"
    return None


def range_holds_wall_friction(run: CheckedRun) -> Fault | None:
    """The friction of a wall is looked for up to what its measured angle needs: no wall gives a larger one."""
    sought: dict[str, Any] = {each["name"]: each for each in run.settings["calibration"]["parameters"]}
    for row in (row for row in _simulated(run) if row.response == WALL_ANGLE and WALL_FRICTION in sought):
        least = math.tan(math.radians(row.value - row.deviation))
        high = sought[WALL_FRICTION]["high"]
        if high < least and not reaches(high, least):
            told = f"line {row.line} of {run.settings['calibration']['measured']} has {row.response} {row.value:g}"
            allowed = f"{WALL_FRICTION} up to {enough(least)} or more: {told}"
            return "calibration.parameters", f"{allowed}; its high is {high:g}"
    return None


# ---------------------------------------------------------------- pairs that others simulated


def pairs_are_numbers(run: CheckedRun) -> Fault | None:
    """The table of pairs has its parameters by their whole names, and in their columns and those of responses numbers
    or nothing; the pair that is compared has no name of the calibration's own.
    """
    key, calibration = "calibration.simulated_before", run.settings["calibration"]
    names = {each["name"].rpartition(".")[2]: each["name"] for each in reversed(calibration["parameters"])}
    numbers = {*names.values(), *(name for found in RESPONSES.values() for name in found)}
    for line, cells in _rows(run, "simulated_before"):
        for column, text in cells.items():
            if column in names:
                return key, f"a table with the column {names[column]}; it has {column}"
            if column in numbers and text not in ("", *NO_VALUES) and math.isnan(_number(text)):
                return key, f"a table with numbers or nothing in the column {column}; its line {line} has {text}"
    if calibration["compared_pair"] in OUR_PAIRS:
        allowed = f"another name than {' and '.join(OUR_PAIRS)}, which the calibration gives to pairs of its own"
        return "calibration.compared_pair", allowed
    return None


TABLE_CHECKS: tuple[Check, ...] = (
    names_have_no_blanks,
    deviations_are_of_values,
    slopes_can_be_measured,
    lower_box_holds_heap,
    discharge_is_of_the_opening,
    range_holds_wall_friction,
    pairs_are_numbers,
)
