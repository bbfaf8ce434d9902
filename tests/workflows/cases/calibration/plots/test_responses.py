"""Figures of a calibration show what their tables hold, with units and bands."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import PathCollection
from matplotlib.text import Annotation

from bulkwear.postproc.inference.problem import Measured
from bulkwear.postproc.plots.style import remarks_of
from bulkwear.workflows.cases.calibration.plots import responses as plots
from bulkwear.workflows.cases.calibration.responses import RECOMMENDED

NAMES = ["particle.contact.sliding_friction", "particle.contact.rolling_friction"]
REMARKS = ["particles at scale 5"]


def grid():
    """Two responses over five by five pairs."""
    line = np.linspace(0.1, 0.7, 5)
    x, y = (each.ravel() for each in np.meshgrid(line, line, indexing="ij"))
    table = pd.DataFrame(
        {NAMES[0]: x, NAMES[1]: y, "shear_angle_deg": 20.0 + 30.0 * x + 10.0 * y, "discharge_time_s": 5.0 + x}
    )
    return table.assign(shear_angle_deg_doubt=0.1, discharge_time_s_doubt=0.1)


def texts(figure):
    """All labels and titles of a figure and its axes."""
    whole = [figure.get_supxlabel(), figure.get_supylabel()]
    return whole + [
        text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel(), axes.get_title(loc="left"))
    ]


def test_response_maps_name_axes_and_units():
    """One map per response, its unit in the title, both parameters on the axes, remarks at the bottom."""
    simulations = grid().iloc[[3, 12]]
    published = pd.DataFrame({NAMES[0]: [0.21], NAMES[1]: [0.4], "shear_angle_deg": [35.7]})
    figure = plots.response_maps(
        grid(), simulations, {"shear_angle_deg": Measured(36.0, 0.4)}, published, NAMES, REMARKS
    )
    assert {"Shear angle, shear box (°)", "Discharge time (s)", "Sliding friction, particles (-)"} <= set(texts(figure))
    assert remarks_of(figure) == REMARKS[0]


def test_pairs_of_other_parameters_are_not_marked():
    """Where others varied no such parameter their pairs have no place on the map."""
    simulations, published = grid().iloc[[3, 12]], pd.DataFrame({NAMES[0]: [0.21], "shear_angle_deg": [35.7]})
    figure = plots.response_maps(grid(), simulations, {}, published, NAMES, REMARKS)
    for axes in figure.axes[:2]:
        marks = [len(each.get_offsets()) for each in axes.collections if isinstance(each, PathCollection)]
        assert sum(marks) == len(simulations)


def test_pairs_stand_beside_the_measured_band():
    """The band is the measured value within one deviation; each pair's mean stands in its place."""
    row = {"response": "shear_angle_deg", "measured": 36.0, "measured_deviation": 0.4, "simulated_uncertainty": 0.5}
    rows = [
        {**row, "pair": RECOMMENDED, "simulated": 36.2, "predicted": 36.0, "predicted_deviation": 0.3},
        {**row, "pair": "calibrated", "simulated": 33.0, "predicted": 33.1, "predicted_deviation": 0.3},
    ]
    figure = plots.pairs_against_bands(pd.DataFrame(rows), pd.Series({"shear_angle_deg": 35.7}), REMARKS)
    axes = figure.axes[0]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["recommended", "calibrated"]
    assert axes.patches[0].get_extents() is not None
    heights = {float(line.get_ydata()[0]) for line in axes.lines if len(line.get_ydata()) == 1}
    assert {36.2, 33.0, 35.7} <= heights


def test_family_marks_pairs_and_shares():
    """Both regions and both pairs are told in the legend, with the pairs' values."""
    line = np.linspace(0.1, 0.7, 6)
    x, y = (each.ravel() for each in np.meshgrid(line, line, indexing="ij"))
    table = pd.DataFrame(
        {"first": NAMES[0], "second": NAMES[1], "first_value": x, "second_value": y, "denser_share": abs(x + y - 0.8)}
    )
    pairs = {
        RECOMMENDED: dict(zip(NAMES, (0.3, 0.5), strict=True)),
        "calibrated": dict(zip(NAMES, (0.21, 0.4), strict=True)),
    }
    figure = plots.family(table, pd.DataFrame({NAMES[0]: [0.2], NAMES[1]: [0.3]}), pairs, REMARKS)
    said = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"50% of the posterior", "95% of the posterior", "calibrated\n(0.21, 0.40)"} <= set(said)


@pytest.mark.parametrize("varied", ["length", "width"])
def test_sizes_are_drawn_with_what_they_are_compared_with(varied):
    """A box that stands for both comparisons is drawn in both."""
    sizes = pd.DataFrame(
        {
            "row": ["a", "b"],
            "varied": ["length and width", varied],
            "length_mm": [200.0, 150.0],
            "width_mm": [53.0, 80.0],
            "mean": [31.0, 32.0],
            "deviation": [0.7, 0.7],
        }
    )
    before = pd.DataFrame({"length_mm": [200], "width_mm": [20], "shear_angle_deg": [31.2], "deviation_deg": [0.9]})
    figure = plots.box_sizes(sizes, before, REMARKS)
    drawn = {axes.get_xlabel().split()[0]: len(axes.lines[0].get_xdata()) for axes in figure.axes}
    assert drawn == {"Length": 2 if varied == "length" else 1, "Width": 2 if varied == "width" else 1}


def test_progress_shows_the_stopping_rule():
    """The share at every look against the dashed line of the rule; the information by response, in bits."""
    looks = pd.DataFrame({"test": ["shear_box"] * 2, "simulations": [8, 10], "surrogate_share": [0.8, 0.4]})
    information = pd.DataFrame({"response": ["shear_angle_deg"], "information_bits": [0.5]})
    figure = plots.progress_and_information(looks, 0.5, information, REMARKS)
    np.testing.assert_allclose(figure.axes[0].lines[0].get_ydata(), [0.8, 0.4])
    assert figure.axes[0].lines[1].get_ydata()[0] == 0.5
    ticks = figure.axes[0].get_xticks()
    np.testing.assert_array_equal(ticks, np.round(ticks))  # of simulations there are no halves
    assert "(bit)" in figure.axes[1].get_xlabel()


@pytest.mark.parametrize(("rolling", "below"), [(0.7, True), (0.5, False)])
def test_a_number_at_the_upper_end_stands_below_its_mark(rolling, below):
    """Where it would else lie on the title."""
    published = pd.DataFrame({NAMES[0]: [0.3], NAMES[1]: [rolling], "shear_angle_deg": [35.7]})
    figure = plots.response_maps(grid(), grid().iloc[[0]], {}, published, NAMES, REMARKS)
    (number,) = (text for text in figure.axes[0].texts if isinstance(text, Annotation))
    assert (number.xyann[1] < 0.0) is below and (number.get_va() == "top") is below


def test_marks_at_the_ends_of_the_range_are_whole_and_clear_of_numbers():
    """A mark on the border is not cut, one outside the range is not drawn, no contour's number lies on a mark."""
    simulations = grid().iloc[[0, 3, 12]]
    published = pd.DataFrame({NAMES[0]: [0.7, 0.9], NAMES[1]: [0.1, 0.4], "shear_angle_deg": [35.7, 30.0]})
    figure = plots.response_maps(grid(), simulations, {}, published, NAMES, REMARKS)
    drawn = figure.axes[0].collections
    marks = [each for each in drawn if isinstance(each, PathCollection)]
    assert all(not each.get_clip_on() for each in marks)
    places = np.vstack([each.get_offsets() for each in marks])
    assert len(places) == 4 and places[:, 0].max() == 0.7
    numbers = [text for text in figure.axes[0].texts if text.get_visible() and not isinstance(text, Annotation)]
    everything = [text for text in figure.axes[0].texts if not isinstance(text, Annotation)]
    distances = np.multiply(plots.CLEAR_OF_MARKS, np.ptp(grid()[NAMES].to_numpy(), axis=0))
    for text in numbers:
        assert not (np.abs(places - text.get_position()) < distances).all(axis=1).any()
    assert 0 < len(numbers) <= len(everything)
