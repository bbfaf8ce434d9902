"""Tables of a calibration against its boxes and ranges: what would be found out after hours, or never, is refused."""

import math
import re

import numpy as np
import pytest
from scipy.optimize import brentq

from bulkwear.workflows.cases.calibration import boxes, case, checks
from bulkwear.workflows.config.design import ConfigError
from bulkwear.workflows.engine.project import Project
from tests.support.calibration_study import ROLLING, SLIDING, study

OWN = {"measured": "ore_tests.csv"}
HEAD = "response,value,deviation\n"
SHEAR = "shear_angle_deg,36,0.4\n"
PLACES = 20_001  # along a box, over which its profile is summed
SUMMED = 1e-3  # relative, of such a sum, and of the four digits in which a limit is named
WALL = "wall_material.contact.sliding_friction"


@pytest.fixture
def show(tmp_path, monkeypatch):
    """Let a table of config/published hold another text."""

    def shown(name, text):
        (tmp_path / "config/published").mkdir(parents=True)
        (tmp_path / "config/published" / name).write_text(text)
        for module in (case, checks):
            monkeypatch.setattr(module, "current_project", lambda: Project(tmp_path))

    return shown


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (f"response, value,deviation\n{SHEAR}", "without blanks beside the names; its header has ' value'"),
        (f"{HEAD}shear_angle_deg ,36,0.4\n", "without blanks beside the names; it has 'shear_angle_deg '"),
        (f"{HEAD}shear_angle_deg,36,inf\n", "a deviation below the value; its line 2 has deviation inf of shear_angle"),
        (
            f"{HEAD}{SHEAR}discharge_time_s,5.4,100\n",
            "a deviation below the value; its line 3 has deviation 100 of discharge_time_s 5.4",
        ),
        (
            "response,value,deviation,model_discrepancy\nshear_angle_deg,36,0.4,inf\n",
            "a model_discrepancy below the value; its line 2 has model_discrepancy inf",
        ),
        (
            f"{HEAD}shear_angle_deg,85,0.4\n",
            r"shear_angle_deg of at most 72\.3.: a steeper slope of shear_box\.fill_height_mm .*; its line 2 has 85",
        ),
        (
            f"{HEAD}{SHEAR}repose_angle_deg,87,1\n",
            r"repose_angle_deg of at most 82.*: a steeper slope of draw_down\.lower_height_mm .*; its line 3 has 87",
        ),
        (
            f"{HEAD}{SHEAR}discharge_time_s,3100,100\n",
            r"discharge_time_s from 0\.5474 to 54\.73: draw_down\.opening_mm lets .*; its line 3 has 3100",
        ),
        (f"{HEAD}\n{SHEAR}\ndischarge_time_s,3,3\n", "a deviation below the value; its line 5 has deviation 3"),
        (f"{HEAD}{SHEAR}discharge_time_s,0.09,0.01\n", r"discharge_time_s from 0\.5474.*; its line 3 has 0\.09"),
    ],
)
def test_what_no_simulation_can_reproduce_is_refused(show, text, words):
    """Nor is a deviation that leaves nothing told: with an infinite one all weights of the posterior are no numbers."""
    show("ore_tests.csv", text)
    with pytest.raises(ConfigError, match=rf"calibration\.measured is 'ore_tests\.csv'.*{words}"):
        study(fidelity="standard", calibration=OWN)


def test_what_no_test_simulates_may_be_anything(show):
    """A discharge time of another opening stands in the table, where the draw-down test is not among the tests."""
    show("ore_tests.csv", f"{HEAD}{SHEAR}discharge_time_s,3100,100\n")
    assert study(fidelity="quick", calibration=OWN).runs


def test_a_discharge_is_no_longer_than_what_is_simulated(show):
    """The test is given up before; the time that the refusal names is enough."""
    show("ore_tests.csv", f"{HEAD}{SHEAR}discharge_time_s,25,1\n")
    words = r"rest\.longest_s is 20.*allowed is at least 25\.1: line 3 of ore_tests\.csv has discharge_time_s 25"
    with pytest.raises(ConfigError, match=words):
        study(fidelity="standard", calibration=OWN)
    assert study(fidelity="standard", calibration=OWN, rest={"longest_s": 25.1}).runs


def heap_height_mm(test, stays_deg, heap_deg):
    """How high a heap of what flows through a slot lies at the slot's edges, by sums over the box's length."""
    box, opening = test["box"], boxes.opening_length(test)
    away = np.abs(np.linspace(-0.5, 0.5, PLACES) * box["length_m"])
    stays = np.clip(math.tan(math.radians(stays_deg)) * (away - opening / 2.0), 0.0, box["fill_height_m"])
    flows, slope = np.mean(box["fill_height_m"] - stays), math.tan(math.radians(heap_deg))
    peak = brentq(lambda top: np.mean(np.clip(top - slope * away, 0.0, None)) - flows, 0.0, 9.0)
    return 1e3 * (peak - slope * opening / 2.0)


@pytest.mark.parametrize(
    ("rows", "stays_deg", "heap_deg", "words"),
    [
        (
            "draw_down_shear_angle_deg,36,2\nrepose_angle_deg,33,3\n",
            38.0,
            30.0,
            "the heap, as steep as the measured repose_angle_deg, of",
        ),
        ("repose_angle_deg,41,1\n", 45.0, 40.0, "the heap, as steep as the measured repose_angle_deg, of"),
        ("discharge_time_s,5.4,0.1\n", 45.0, 0.0, "in a lower box what flows out dams the slot"),
    ],
)
def test_the_lower_box_holds_the_heap_that_was_measured(show, rows, stays_deg, heap_deg, words):
    """A heap that grows up to the slot ends the flow: then no slope is the measured one. What is named is enough."""
    show("ore_tests.csv", f"{HEAD}{SHEAR}{rows}")
    changes = {"fidelity": "standard", "calibration": OWN}
    test = boxes.test_of(study(**changes).runs[0].parameters, boxes.DRAW_DOWN, {}, 0)
    expected = heap_height_mm(test, stays_deg, heap_deg)
    told = rf"draw_down\.lower_height_mm is 60.*allowed is at least .*{words}"
    with pytest.raises(ConfigError, match=told) as refused:
        study(**changes, draw_down={"lower_height_mm": 60})
    least = float(re.search(r"at least ([\d.]+)", str(refused.value))[1])
    assert least == pytest.approx(expected, rel=SUMMED)
    assert study(**changes, draw_down={"lower_height_mm": least}).runs
    with pytest.raises(ConfigError, match=words):
        study(**changes, draw_down={"lower_height_mm": 0.999 * least})


def test_a_low_filling_makes_a_heap_that_reaches_no_wall(show):
    """Of the same slopes, in a box that is long for it."""
    show("ore_tests.csv", f"{HEAD}{SHEAR}repose_angle_deg,33,3\n")
    changes = {"fidelity": "standard", "calibration": OWN}
    low = {"fill_height_mm": 120, "fill_mass_kg_per_m": 84.3}
    test = boxes.test_of(study(**changes, draw_down=low).runs[0].parameters, boxes.DRAW_DOWN, {}, 0)
    with pytest.raises(ConfigError, match=r"draw_down\.lower_height_mm is 60") as refused:
        study(**changes, draw_down={**low, "lower_height_mm": 60})
    least = float(re.search(r"at least ([\d.]+)", str(refused.value))[1])
    assert least == pytest.approx(heap_height_mm(test, 45.0, 30.0), rel=SUMMED)


def test_a_range_of_wall_friction_reaches_its_angle(show):
    """No wall gives an angle whose tangent is above its friction, within one deviation of the measurement."""
    show("ore_tests.csv", f"{HEAD}wall_friction_angle_deg,31,1\n")
    ranges = [{"name": SLIDING, "low": 0.1, "high": 0.7}, {"name": WALL, "low": 0.1, "high": 0.3}]
    asked = {**OWN, "tests": ["wall_shear"], "parameters": ranges}
    words = rf"calibration\.parameters is .*{WALL} up to 0\.5774 or more: line 2 of ore_tests\.csv .* its high is 0\.3"
    with pytest.raises(ConfigError, match=words):
        study(calibration=asked)
    assert study(calibration={**asked, "parameters": [ranges[0], {**ranges[1], "high": 0.5774}]}).runs


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("row,sliding_friction\ncalibrated,0.4\nsize-test,0.2\n", f"the column {SLIDING}; it has sliding_friction"),
        (
            f"row,{SLIDING}\ncalibrated,0.4\nsize-test,0.2\nother,much\n",
            f"numbers or nothing in the column {SLIDING}; its line 4 has much",
        ),
        (
            f"row,{ROLLING},shear_angle_deg\ncalibrated,0.4,about 38\nsize-test,0.2,\n",
            "numbers or nothing in the column shear_angle_deg; its line 2 has about 38",
        ),
        (f"row,{SLIDING}\ncalibrated ,0.4\nsize-test,0.2\n", "without blanks beside the names; it has 'calibrated '"),
    ],
)
def test_pairs_that_a_page_cannot_show_are_refused(show, text, words):
    """Where a column is named otherwise, the material's own value was compared; text ended the page after hours."""
    show("ore_pairs.csv", text)
    with pytest.raises(ConfigError, match=rf"calibration\.simulated_before is 'ore_pairs\.csv'.*{words}"):
        study(calibration={"simulated_before": "ore_pairs.csv"})


@pytest.mark.parametrize("name", ["recommended", "found_first"])
def test_the_compared_pair_has_a_name_of_its_own(show, name):
    """Else it takes the place of the pair that the calibration found, under whose name it was repeated."""
    show("ore_pairs.csv", f"row,{SLIDING}\n{name},0.4\nsize-test,0.2\n")
    words = rf"calibration\.compared_pair is '{name}'.*another name than found_first and recommended"
    with pytest.raises(ConfigError, match=words):
        study(calibration={"simulated_before": "ore_pairs.csv", "compared_pair": name})
