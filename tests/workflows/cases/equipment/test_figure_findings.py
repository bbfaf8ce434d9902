"""Sentences on the figures of equipment say what their tables say."""

import pandas as pd
import pytest

from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.workflows.cases.equipment import figure_findings as findings

NAN = float("nan")
PARTS = {"setting": "plain", "part": ["back_liner", "wheel"]}
UNSURE = {"packings": 1, "coefficient_error": 0.0} | dict.fromkeys(("life_low_h", "life_high_h"), NAN)


def test_the_first_part_to_be_changed():
    """And the last one; parts that last for ever, and those that nothing is known of, are left out."""
    lives = pd.DataFrame(PARTS | {"life_h": [5200.0, 900.0]} | UNSURE)
    said = f"First the wheel is changed, after 900 h ({UNKNOWN})"
    assert findings.shortest_life(lives) == f"{said}; last the back liner, after 5,200 h."
    assert findings.shortest_life(lives.assign(life_h=[float("inf"), 900.0])) == f"{said}."
    assert findings.shortest_life(lives.assign(life_h=NAN)) == ""
    two = pd.concat([lives.assign(setting="fast", life_h=100.0), lives])
    assert findings.shortest_life(two).startswith("First the back liner of fast is changed, after 100 h")


def test_depth_of_the_deciding_place():
    """Mean of the packings at the end of what was simulated, not of what goes on from there."""
    rows = {"setting": "plain", "part": "liner", "packing": [0, 0, 0, 1], "operation_h": [0.0, 400.0, 900.0, 500.0]}
    depths = pd.DataFrame(rows | {"depth_mm": [0.0, 3.0, 8.0, 4.0], "simulated": [True, True, False, True]})
    assert findings.depth_reached(depths) == "At the deciding place the liner has lost 3.0 mm after 400 h."
    assert findings.depth_reached(depths.tail(1)) == ""


def test_the_fastest_place():
    """With its place and the mean over the area of its part; nothing wears where no rate is above 0."""
    place = {f"{axis}_mm": [100.0, 200.0, 300.0] for axis in "xyz"}
    rows = {"setting": "plain", "part": ["liner", "liner", "wheel"], "area_mm2": [1.0, 3.0, 1.0]}
    rates = pd.DataFrame(rows | place | {"pristine_mm_per_1000h": [6.0, 2.0, 1.0]})
    assert findings.fastest_place(rates) == (
        "The liner wears fastest as built, by 6.0 mm per 1,000 h at (100, 100, 100) mm of its drawing, 2.0 times the"
        " mean over its area."
    )
    assert " at (100, 0, -12.3) mm of" in findings.fastest_place(rates.assign(y_mm=-2e-15, z_mm=-12.34))
    assert findings.fastest_place(rates.assign(pristine_mm_per_1000h=0.0)) == "Nothing wears as built."


@pytest.mark.parametrize(
    ("how", "said"), [("simulated", "400 h;"), ("last rate goes on", "400 h (last rate goes on);")]
)
def test_the_thinnest_place(how, said):
    """At the last hours shown, of places that lose some; a thin edge that stays is none."""
    own = PARTS | {"patch": [0, 1], "how": how}
    built = pd.DataFrame(own | {"operation_h": 0.0, "least_remaining_mm": [15.0, 31.0]})
    rows = pd.concat([built, pd.DataFrame(own | {"operation_h": 400.0, "least_remaining_mm": [12.0, 30.0]})])
    edge = rows.iloc[[0, 2]].assign(patch=2, least_remaining_mm=1.0)
    both = pd.concat([rows, edge], ignore_index=True)
    least = f"The thinnest worn place has 12 mm left after {said} it is on the back liner."
    assert findings.thinnest_place(both) == least
    kept = findings.thinnest_place(both[both["operation_h"] == 0.0])
    assert kept.startswith("The thinnest place has 1.0 mm left as built")


def test_the_thinnest_place_of_a_design_that_wore_for_fewer_hours():
    """Each design counts at its own last hours."""
    own = {"part": "liner", "patch": 0, "how": "simulated"}
    rows = [("A", 0.0, 30.0), ("A", 5000.0, 5.0), ("B", 0.0, 30.0), ("B", 6000.0, 25.0)]
    table = pd.DataFrame(rows, columns=["setting", "operation_h", "least_remaining_mm"]).assign(**own)
    said = "The thinnest worn place has 5.0 mm left after 5,000 h; it is on the liner of A."
    assert findings.thinnest_place(table) == said


def test_impacts_and_pressure():
    """Powers by area; a part without any power is left out."""
    loads = {"area_mm2": [1.0, 3.0], "impact_power_W_per_m2": [2.0, 2.0], "sliding_power_W_per_m2": [6.0, 6.0]}
    rows = pd.DataFrame({"setting": "plain", "part": "liner"} | loads | {"pressure_Pa": [10.0, 1500.0]})
    said = "he highest mean pressure on a patch is 1,500 Pa."
    assert (
        findings.impact_share(rows) == f"Of the power of impacts and sliding, impacts have 25 % on the liner; t{said}"
    )
    assert findings.impact_share(rows.assign(impact_power_W_per_m2=0.0, sliding_power_W_per_m2=0.0)) == f"T{said}"


def test_sections_tell_what_is_removed_in_the_end():
    """Of each section the last shape; as built nothing is."""
    rows = {"section": [1, 1, 2], "setting": "plain", "part": ["liner", "liner", "wheel"]}
    lines = pd.DataFrame(rows | {"operation_h": [0.0, 400.0, 0.0], "depth_1_mm": [0.0, 2.0, 0.0], "depth_2_mm": 0.0})
    lines.loc[1, "depth_2_mm"] = 5.0
    assert findings.deepest_section(lines) == (
        "In the sections wear has removed up to 5.0 mm from the liner after 400 h and up to 0 mm from the wheel as"
        " built."
    )


def test_the_flow_in_the_end():
    """Means of the last quarter of the time over packings; what does not flow or move is not told."""
    rows = {"run": "A", "setting": "plain", "time_s": [0.0, 8.0, 10.0], "held_kg": [0.0, 30.0, 32.0]}
    series = pd.DataFrame(rows | {"out_t_per_h": [0.0, 5.0, 6.0], "power_wheel_kW": [9.0, 2.0, 2.0]})
    said = "In the last quarter of the time 31.0 kg are held"
    assert findings.held_and_power(series) == f"{said}, 5.50 t/h go out and the wheel gives 2.00 kW."
    assert findings.held_and_power(series.assign(out_t_per_h=0.0, power_wheel_kW=NAN)) == f"{said}."


def test_speeds_and_charges_by_phase():
    """Designs are named where there are several; a charge is told as built and as worn."""
    panels = pd.DataFrame({"setting": "plain", "phase": "as built", "speed_m_per_s": [1.0, 2.0]})
    tell = findings.speeds("speed_m_per_s", "Mean speed")
    assert tell(panels) == "Mean speed: as built 1.5 m/s, at most 2.0 m/s."
    assert "; fast, as built 1.5 m/s" in tell(pd.concat([panels, panels.assign(setting="fast")]))
    rows = {"setting": "plain", "phase": ["pristine", "pristine", "worn"], "shoulder_deg": [300.0, 302.0, 310.0]}
    assert findings.charge(pd.DataFrame(rows | {"toe_deg": 130.0})) == (
        "Shoulder and toe lie at: as built 301 (300 to 302 in 2 packings) and 130 degrees; as worn 310 and 130 degrees."
    )


def test_lifters_are_those_of_the_answers():
    """Of one shape there is nothing to compare."""
    table = pd.DataFrame({"setting": "plain", "part": "liner", "operation_h": [0.0, 4000.0], "height_mm": [65.0, 60.0]})
    ends = {f"{name}_{end}": NAN for name in ("height_mm", "leading_face_angle_deg") for end in ("low", "high")}
    table = table.assign(leading_face_angle_deg=[14.0, 21.0], **ends)
    assert "lean back by 14 degrees as built and 21 degrees after 4,000 h" in findings.lifters(table)
    assert findings.lifters(table.head(1)) == ""
