"""Sentences on the figures of studies by flow regime say what their tables say."""

import pandas as pd

from bulkwear.workflows.cases.sliding_sample.screening import figure_findings as findings

NAN = float("nan")
ALONG = {"run": ["a"] * 3 + ["b"] * 3, "regime": ["continuous"] * 3 + ["discontinuous"] * 3}
ALONG |= {"travel_mm": [10.0, 20.0, 30.0] * 2}


def test_patterns_are_counted_by_their_intervals():
    """One wears surely less, one packing tells nothing but its number; plain twins do not count."""
    rows = {"setting": ["R1", "R2", "R2"], "surface": ["convex", "convex", "plain"], "packings": [3, 1, 3]}
    rows |= {"wear_over_plain": [0.8, 0.7, 1.0], "interval_low": [0.7, NAN, NAN], "interval_high": [0.9, NAN, NAN]}
    table = pd.DataFrame(rows)
    assert findings.pattern_over_plain(table) == (
        "1 of 2 patterns wear less than plain, 0 more, of 1 it cannot be said; lowest is R2 with 0.7 (one packing,"
        " scatter unknown) of the plain sample's wear."
    )
    sure = findings.pattern_over_plain(table.head(1))
    assert "0 more; lowest is R1 with 0.8 (95 % interval 0.7 to 0.9, 3 packings)" in sure
    assert findings.pattern_over_plain(table.tail(1)) == ""


def test_flow_and_wear_of_the_second_half_of_the_travel():
    """What is not known is left out; nothing is said where all of it is."""
    along = pd.DataFrame(ALONG | {"relative_velocity_percent": [99.0, 30.0, 40.0, 99.0, 90.0, NAN]})
    said = "ride along with 35 % (continuous) and 90 % (discontinuous) of the sample's velocity."
    assert findings.relative_velocity(along) == f"In the second half of the travel particles {said}"
    assert findings.relative_velocity(along.assign(relative_velocity_percent=NAN)) == ""
    gradient = findings.wear_gradient(pd.DataFrame(ALONG | {"relative_gradient": [1.0, 0.4, 0.6, 0.2, 0.1, 0.1]}))
    assert gradient.endswith("the wear gradient is 0.5 (continuous) and 0.1 (discontinuous) times the largest one.")
    assert findings.wear_gradient(pd.DataFrame(ALONG).assign(relative_gradient=NAN)) == ""


def test_the_lowest_layer_over_the_samples():
    """Not that beside them, nor higher ones; without a plain twin nothing is compared."""
    rows = {"row": "R5", "surface": ["convex", "plain", "convex", "convex"], "layer": [1, 1, 2, 1]}
    rows |= {"zone": ["central", "central", "central", "side"], "velocity_m_per_s": [0.2, 0.1, 9.0, 9.0]}
    profiles = pd.DataFrame(rows | {"averaged_angular_velocity_deg_per_s": [300.0, 200.0, 9.0, 9.0]})
    assert findings.bottom_velocities(profiles) == (
        "With the sample the lowest layer over it moves at 0.2 m/s (R5, convex) and 0.1 m/s (R5, plain)."
    )
    assert findings.bottom_spins(profiles) == (
        "Over the patterned sample the lowest layer turns 1.5 times as fast as over the plain one (R5)."
    )
    assert findings.bottom_spins(profiles.head(1)) == "" and findings.bottom_velocities(profiles.tail(1)) == ""


def test_wear_and_force_by_regime():
    """The least worn pattern beside its plain twin, where it has one; forces of both kinds of samples."""
    rows = {"setting": ["R1", "R2", "R2"], "surface": ["convex", "convex", "plain"], "regime": "continuous"}
    table = pd.DataFrame(rows | {"relative_wear": [0.5, 0.25, 0.4], "mean_normal_force_N": [10.0, 12.0, 8.0]})
    start = "Least wear of a pattern over the largest of its regime: R"
    assert findings.least_by_regime(table) == f"{start}2 in continuous flow (0.25, its plain twin 0.4)."
    assert findings.least_by_regime(table.head(1)) == f"{start}1 in continuous flow (0.5)."
    assert findings.forces_by_regime(table) == (
        "The bed presses on patterned samples with 10 to 12 N (continuous); on plain samples with 8 N (continuous)."
    )


def test_a_regression_says_what_holds_by_permutation():
    """The constant has no such p value; a model without terms tells no factor."""
    rows = {"term": ["1", "velocity", "pitch"], "coefficient": [-9.0, -0.52, 0.1]}
    table = pd.DataFrame(rows | {"p_value_permutation": [NAN, 0.01, 0.4]})
    assert findings.strongest_terms(table) == (
        "Strongest is velocity, -0.52 of ln wear (p 0.01 by permutation); 1 of 2 terms have p up to 0.05."
    )
    assert "no factor is told apart" in findings.strongest_terms(table.head(1))
    residuals = pd.DataFrame({"row": ["R1", "R2"], "residual": [0.1, -0.4]})
    assert findings.largest_residual(residuals) == "The model misses R2 most, by -0.4 of ln wear."


def test_contrasts_and_predictions():
    """Over the pseudo standard error, where there is one; the least of a surface; runs inside their interval."""
    table = pd.DataFrame({"term": ["pitch", "velocity"], "contrast": [0.1, -0.9], "pseudo_error": 0.3})
    said = "Largest is the contrast of velocity"
    assert findings.largest_contrast(table) == f"{said}, 3 times the pseudo standard error."
    assert findings.largest_contrast(table.assign(pseudo_error=0.0)) == f"{said}."
    grid = {"x": [1.0, 2.0, 1.0, 2.0], "y": [10.0, 10.0, 20.0, 20.0]}
    surface = pd.DataFrame({"x_factor": "velocity", "y_factor": "pitch", **grid})
    for wear, least in (
        ([0.9, 0.6, 0.5, 0.3], ", least at velocity 2 and pitch 20"),
        ([0.9, 0.9, 0.3, 0.3], ", least at pitch 20"),
        ([0.9] * 4, ""),
    ):
        said = findings.least_predicted(surface.assign(normalised_wear=wear))
        assert said == f"Predicted are {min(wear):g} to 0.9 of the largest wear{least}."
    runs = pd.DataFrame({"inside": [True, False], "over_predicted": [0.9, 1.6]})
    assert findings.confirmed(runs) == (
        "1 of 2 runs wear within the predicted interval; they wear 0.9 to 1.6 times the prediction."
    )
