"""Bars and points draw their tables, with units and remarks."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.plots.style import remarks_of
from bulkwear.workflows.cases.sliding_sample.plots import bars

REMARKS = ["particles at scale 2", "travel 160 mm of 1000 mm"]
RELATIVE = 1e-12  # rounding of heights and sums


@pytest.fixture
def split():
    """A convex run at 0.5 + 0.25 of its plain twin."""
    return pd.DataFrame(
        {
            "run": ["R9_convex", "R9_plain"],
            "surface": ["convex", "plain"],
            "base_over_plain": [0.5, 1.0],
            "pattern_over_plain": [0.25, 0.0],
        }
    )


def heights(container):
    """Heights of the bars of one colour."""
    return [bar.get_height() for bar in container]


def test_split_is_stacked_as_tabled(split):
    """Bump bars stand on base bars; both have the table's heights; the total is written above."""
    figure = bars.wear_split(split, REMARKS)
    base, bumps = figure.axes[0].containers
    assert heights(base) == split["base_over_plain"].tolist()
    assert heights(bumps) == split["pattern_over_plain"].tolist()
    assert [bar.get_y() for bar in bumps] == split["base_over_plain"].tolist()
    assert [text.get_text().strip() for text in figure.axes[0].texts] == ["0.75", "1.00"]
    assert "(-)" in figure.axes[0].get_ylabel()
    assert remarks_of(figure) == "; ".join(REMARKS)


def test_relative_wear_is_sorted_and_marked():
    """Lowest first, with the table's heights, ranges over the cycles and alpha_ER of the same row."""
    table = pd.DataFrame(
        {
            "row": ["R1", "R2", "R3"],
            "surface": "convex",
            "wear_over_plain": [1.2, 0.8, 1.0],
            "equivalent_size_ratio": [0.11, 0.22, 0.33],
            "lowest_cycle_ratio": [1.1, 0.7, np.nan],
            "highest_cycle_ratio": [1.4, 0.9, np.nan],
            "interval_low": np.nan,
            "interval_high": np.nan,
        }
    )
    published = pd.DataFrame(
        {"row": ["R2", "R1"], "relation": ["about", "above"], "value": [0.34, 1.0], "source": "Yan, x"}
    )
    figure = bars.relative_wear(table, published, REMARKS)
    axes = figure.axes[0]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["R2", "R3", "R1"]
    assert [patch.get_height() for patch in axes.patches] == [0.8, 1.0, 1.2]
    written = [text.get_text() for text in axes.texts]
    assert written == ["0.80", "0.22", "1.00", "0.33", "1.20", "0.11"]
    assert axes.get_ylim()[1] > 1.4
    segments = [segment for segment in axes.collections[0].get_segments() if segment.ndim == 2]
    ends = [segment[:, 1] for segment in segments if np.isfinite(segment).all()]
    np.testing.assert_allclose(ends, [[0.7, 0.9], [1.1, 1.4]], rtol=RELATIVE)
    marks = {line.get_label(): tuple(line.get_xydata()[0]) for line in axes.lines if line.get_label()[0] != "_"}
    assert marks == {"Yan": (0.0, 0.34), "Yan (at least)": (2.0, 1.0)}
    repeated = table.assign(interval_low=[1.15, np.nan, np.nan], interval_high=[1.25, np.nan, np.nan])
    drawn = bars.relative_wear(repeated, published[:0], REMARKS).axes[0].collections[0].get_segments()
    np.testing.assert_allclose([segment[:, 1] for segment in drawn], [[1.15, 1.25]], rtol=RELATIVE)
    assert remarks_of(figure) == "; ".join(REMARKS)


def test_laws_on_a_log_axis():
    """Both volumes are drawn as tabled in mm³ on a log axis; a volume of zero is left out, not drawn at a limit."""
    table = pd.DataFrame({"run": ["a", "b"], "worn_volume_mm3": [1.0, 2.0], "finnie_volume_mm3": [0.01, 0.0]})
    axes = bars.wear_law_comparison(table, REMARKS).axes[0]
    archard, finnie = (line.get_ydata() for line in axes.get_lines())
    np.testing.assert_array_equal(archard, table["worn_volume_mm3"])
    assert finnie[0] == 0.01
    assert np.isnan(finnie[1])
    assert axes.get_yscale() == "log"
    assert "(mm³)" in axes.get_ylabel()


def test_mean_forces_of_many_rows():
    """Means stand where their row is named, in N, bars from the low to the high percentile."""
    rows = [f"R{k}" for k in range(1, 5)]
    table = pd.DataFrame({"row": np.repeat(rows, 2), "surface": ["convex", "plain"] * 4})
    for name in ("vertical_force_N", "drag_force_N"):
        mean = np.arange(8.0) + 1.0
        table = table.assign(**{f"mean_{name}": mean, f"low_{name}": mean - 0.5, f"high_{name}": mean + 1.0})
    figure = bars.mean_forces(table, REMARKS)
    assert [axes.get_ylabel() for axes in figure.axes] == ["Vertical force (N)", "Drag force (N)"]
    assert [label.get_text() for label in figure.axes[1].get_xticklabels()] == rows
    for axes in figure.axes:
        convex, plain = (container.lines[0].get_ydata() for container in axes.containers)
        np.testing.assert_array_equal(convex, [1.0, 3.0, 5.0, 7.0])
        np.testing.assert_array_equal(plain, [2.0, 4.0, 6.0, 8.0])
        ends = axes.containers[0].lines[2][0].get_segments()[0][:, 1]
        np.testing.assert_allclose(ends, [0.5, 2.0], rtol=RELATIVE)
