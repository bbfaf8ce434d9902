"""Figures of the flow draw their tables, with units and remarks."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.plots.style import colour, remarks_of
from bulkwear.workflows.cases.sliding_sample.plots import flow
from tests import REPOSITORY

REMARKS = ["particles at scale 2", "travel 160 mm of 1000 mm"]


@pytest.fixture
def velocities():
    """Two runs and a plain one along 100 mm, in two regimes."""
    travel = np.array([10.0, 50.0, 100.0])
    runs = [
        ("R5_convex", "R5", "convex", "continuous", 30.0),
        ("R9_convex", "R9", "convex", "continuous", 30.1),
        ("R5_plain", "R5", "plain", "continuous", 5.0),
        ("R2_convex", "R2", "convex", "discontinuous", 98.0),
    ]
    names = ["run", "row", "surface", "regime"]
    tables = [pd.DataFrame({**dict(zip(names, run, strict=False)), "travel_mm": travel, "eta": run[4]}) for run in runs]
    return pd.concat(tables, ignore_index=True)


@pytest.fixture
def profile():
    """Profiles of a row over and beside a convex and a plain sample."""
    parts = [
        pd.DataFrame(
            {
                "row": "R5",
                "surface": surface,
                "zone": zone,
                "height_mm": [5.0, 15.0],
                "velocity_m_per_s": [1.0, 0.5],
                "sideways_ratio": [0.1, 0.2],
                "upward_ratio": [0.0, 0.3],
                "averaged_angular_velocity_deg_per_s": [300.0, 100.0],
            }
        )
        for surface in ("convex", "plain")
        for zone in ("central", "side", "ahead")
    ]
    return pd.concat(parts, ignore_index=True)


def test_regimes_have_panels(velocities):
    """A panel per regime with its runs as tabled; rows are named at the ends, apart from each other."""
    figure = flow.along_travel(velocities, "eta", "Relative velocity (%)", (60.0, 1700.0), REMARKS)
    left, right = figure.axes
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["continuous", "discontinuous"]
    curves = {line.get_label(): line.get_ydata() for line in left.lines}
    assert {name for name in curves if name[0] != "_"} == {"R5_convex", "R9_convex", "R5_plain"}
    np.testing.assert_array_equal(curves["R9_convex"], [30.1] * 3)
    places = {text.get_text().strip(): text.get_position()[1] for text in left.texts}
    assert set(places) == {"R5", "R9"}
    assert places["R9"] - places["R5"] >= flow.LEAST_STEP * 90.0
    assert left.get_ylabel() == "Relative velocity (%)"
    assert left.get_xlabel() == "Travel (mm)"
    assert len(right.patches) == 1
    assert remarks_of(figure) == "; ".join(REMARKS)


def test_names_stay_below_the_top(velocities):
    """Five rows that end together at the top have names apart from each other, none above the axes."""
    top = pd.concat([velocities[:3].assign(row=f"R{k}", run=f"R{k}_convex", eta=98.0) for k in range(5)])
    (axes,) = flow.along_travel(top, "eta", "Relative velocity (%)", None, REMARKS).axes
    places = sorted(text.get_position()[1] for text in axes.texts)
    assert len(places) == 5
    assert np.diff(places).min() >= flow.LEAST_STEP * np.ptp(axes.get_ylim()) * (1.0 - 1e-9)
    assert places[-1] <= axes.get_ylim()[1]


def test_a_window_beyond_the_travel_is_left_out(velocities):
    """A steady window that the travel does not reach is not drawn."""
    figure = flow.along_travel(velocities, "eta", "Relative velocity (%)", (1000.0, 1700.0), REMARKS)
    assert all(len(axes.patches) == 0 for axes in figure.axes)


def test_published_values_are_lines_in_their_panel(velocities):
    """What is published of a regime is a line across its panel alone, named with its source."""
    published = pd.DataFrame(
        {"of": ["continuous", "continuous"], "value": [15.0, 70.0], "source": "Yan 2022, section 3"}
    )
    figure = flow.along_travel(velocities, "eta", "Relative velocity (%)", None, REMARKS, published)
    lines = [[line.get_ydata()[0] for line in axes.lines if line.get_linestyle() == ":"] for axes in figure.axes]
    assert lines == [[15.0, 70.0], []]
    assert figure.legends[0].get_texts()[-1].get_text() == "Yan 2022, section 3"


NOTHING = pd.DataFrame(columns=["row", "zone", "quantity", "relation"])


def test_profiles_over_and_beside(profile):
    """Panels with units per row; convex and plain, over and beside, as tabled; other zones are not drawn."""
    other = profile.assign(row="R2", velocity_m_per_s=0.2)
    figure = flow.velocity_profiles(pd.concat([profile, other], ignore_index=True), NOTHING, REMARKS)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["R5"] * 3 + ["R2"] * 3
    lines = [line for line in figure.axes[0].lines if len(line.get_xdata()) == 2 and line.get_label()[0] != "_"]
    assert {line.get_label() for line in lines} == {"convex central", "convex side", "plain central", "plain side"}
    np.testing.assert_array_equal(lines[0].get_xydata(), [[1.0, 5.0], [0.5, 15.0]])
    assert [axes.get_xlabel()[-5:] for axes in figure.axes[3:]] == ["(m/s)", "e (-)", "e (-)"]
    assert remarks_of(figure) == "; ".join(REMARKS)
    angular = flow.angular_velocity_profiles(profile, NOTHING, REMARKS)
    np.testing.assert_array_equal(angular.axes[0].lines[0].get_xydata(), [[300.0, 5.0], [100.0, 15.0]])
    assert angular.axes[0].get_xlabel() == "Averaged angular velocity (°/s)"


def test_published_profiles_are_overlaid(profile):
    """Every published number of R5 is drawn once, at the height of its layer, in the colour of its surface."""
    published = pd.read_csv(REPOSITORY / "config/published/screening_profiles.csv")
    figures = [draw(profile, published, REMARKS) for draw in (flow.velocity_profiles, flow.angular_velocity_profiles)]
    drawn = {
        (float(line.get_xdata()[0]), float(line.get_ydata()[0]), line.get_color())
        for figure in figures
        for axes in figure.axes
        for line in axes.lines
        if len(line.get_xdata()) == 1
    }
    of_row = published[published["row"] == "R5"]
    expected = {
        (value, 5.0 * layer - 2.5, colour(surface))
        for value, layer, surface in of_row[["value", "layer", "surface"]].itertuples(index=False)
    }
    assert drawn == expected
    labels = [text.get_text() for figure in figures for text in figure.legends[0].get_texts()]
    assert {"Yan 2022", "Yan 2022 (at most)", "Yan 2022 (at least)", "grey: Yan 2022, beside it"} <= set(labels)
