"""Sentences on figures say what their tables say."""

import pandas as pd

from bulkwear.workflows.report import figure_findings as findings

RUNS = ["R9_convex", "R9_plain"]


def test_the_deepest_run_is_named_first():
    """With the depth of its most worn hundredth, and that of the least worn run."""
    depths = pd.DataFrame({"run": RUNS, "depth_um": [1.0, 3.0], "area_mm2": 1.0})
    assert findings.deepest_run(depths) == (
        "R9_plain wears deepest: a hundredth of its area by 3 µm or more, of R9_convex by 1 µm."
    )


def test_half_of_the_area_is_worn_deeper_than_a_depth():
    """The deepest level of which half of the area is worn deeper; none where less than half is worn at all."""
    curve = pd.DataFrame({"run": "A", "depth_um": [1.0, 2.0, 3.0], "area_share_percent": [90.0, 50.0, 10.0]})
    rest = curve.assign(run="B", area_share_percent=40.0)
    said = findings.depth_of_half(pd.concat([curve, rest]))
    assert said == "Half of A is worn deeper than 2 µm; half of B is worn hardly or not at all."


def test_last_cycles_count():
    """Wear of the end, mean over the runs of a surface."""
    history = pd.DataFrame(
        {
            "run": ["a", "a", "b", "b"],
            "surface": "convex",
            "travel_mm": [10.0, 20.0] * 2,
            "worn_volume_mm3": [1.0, 2.0, 2.0, 4.0],
        }
    )
    assert findings.total_wear(history) == "After 20 mm of travel convex samples 3 mm³ are worn, on average."


def test_updates_at_a_cap_are_counted():
    """Half of the steps reach their cap; where none does it is said; one of many is not none, all but one not all."""
    assert "In 50 %" in findings.largest_step(pd.DataFrame({"step_taken": [1.0, 0.2]}))
    assert findings.largest_step(pd.DataFrame({"step_taken": [0.2]})).startswith("No update")
    for ends, share in (([1.0, 0.2], "less than 1 %"), ([0.2, 1.0], "more than 99 %"), ([1.0, 1.0], "100 %")):
        steps = pd.DataFrame({"step_taken": [ends[0], *[ends[1]] * 399]})
        assert findings.largest_step(steps).startswith(f"In {share} of the updates")


def test_share_of_the_pattern():
    """A quarter of the wear; of plain samples alone there is none; without plain twins nothing is said."""
    split = pd.DataFrame({"wear_over_plain": [0.8, 1.0], "pattern_over_plain": [0.2, 0.0]})
    assert findings.share_of_pattern(split) == "Of the wear of patterned samples 25 % is on the pattern."
    assert findings.share_of_pattern(split.tail(1)) == "No sample has a pattern that wears."
    assert findings.share_of_pattern(split.head(1) * float("nan")) == ""


def test_forces_are_told_alike_along_the_travel_and_as_means():
    """Both forms of the table give one sentence."""
    along = pd.DataFrame({"surface": "plain", "vertical_force_N": [1.0, 3.0], "drag_force_N": [1.0, 1.0]})
    means = pd.DataFrame({"surface": "plain", "direction": ["vertical", "drag"], "mean_force_N": [2.0, 1.0]})
    said = "On average the bed loads plain samples with 2 N (vertical) and 1 N (drag)."
    assert findings.mean_forces(along) == said
    assert "2 N (vertical)" in findings.mean_forces(means) and "1 N (drag)" in findings.mean_forces(means)


def test_what_is_left_of_a_pattern():
    """Of the last frame; a plain sample has its depth told."""
    frames = pd.DataFrame({"run": "R9_convex", "bumps_left_percent": [100.0, 62.5], "largest_depth_um": [0.0, 8.0]})
    assert findings.pattern_in_film(frames) == "R9_convex keeps 62.5 % of its pattern."
    assert "8 µm" in findings.pattern_in_film(frames.assign(bumps_left_percent=float("nan")))


def test_the_solvers_measure_beside_the_law():
    """By surface, in per cent over the settings."""
    table = pd.DataFrame({"surface": ["convex", "convex", "plain"], "finnie_over_archard": [0.05, 0.1, 0.01]})
    said = "The solver's Finnie volume is, of that by the study's law,"
    assert findings.finnie_over_law(table) == f"{said} 5 to 10 % on convex samples and 1 % on plain samples."


def test_speeds_over_the_samples_shown():
    """Mean of the particles of each run; one that two views show counts once."""
    particles = pd.DataFrame({"run": ["A", "A", "B"], "speed_m_per_s": [0.1, 0.3, 0.4]})
    assert findings.particle_speeds(particles) == (
        "The particles shown pass the sample at 0.2 m/s over A and 0.4 m/s over B, on average."
    )
    views = pd.DataFrame({"run": "A", "view": ["side", "bottom", "side"], "id": [1, 1, 2]})
    views = views.assign(angular_speed_deg_per_s=[100.0, 100.0, 300.0])
    assert findings.particle_spins(views) == "The particles shown turn at 200 °/s over A, on average."


def test_large_depths_are_told_in_millimetres():
    """18 mm, without an exponent."""
    depths = pd.DataFrame({"run": ["A"], "depth_um": [18_234.0], "area_mm2": 1.0})
    assert findings.deepest_run(depths) == "A wears deepest: a hundredth of its area by 18 mm or more."
