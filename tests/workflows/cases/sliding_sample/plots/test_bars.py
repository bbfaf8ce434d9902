"""Bars and points of settings draw their tables, with units and remarks."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.plots.style import remarks_of
from bulkwear.workflows.cases.sliding_sample.plots import bars

REMARKS = ["particles at scale 2", "travel 160 mm of 1000 mm"]
RELATIVE = 1e-12  # rounding of heights and sums


@pytest.fixture
def split():
    """A convex sample at 0.5 + 0.25 of its plain twin, between 0.6 and 0.9."""
    return pd.DataFrame(
        {
            "setting": "R9",
            "surface": ["convex", "plain"],
            "wear_over_plain": [0.75, 1.0],
            "base_over_plain": [0.5, 1.0],
            "pattern_over_plain": [0.25, 0.0],
            "interval_low": [0.6, 1.0],
            "interval_high": [0.9, 1.0],
        }
    )


def ends_of(axes):
    """The ends of all intervals on an axis."""
    return [segment[:, 1].tolist() for bars in axes.collections for segment in bars.get_segments()]


def heights(container):
    """Heights of the bars of one colour."""
    return [bar.get_height() for bar in container]


def test_split_is_stacked_as_tabled(split):
    """Bump bars stand on base bars; both have the table's heights; the total is written above its interval."""
    figure = bars.wear_split(split, REMARKS)
    base, bumps, _ = figure.axes[0].containers
    assert ends_of(figure.axes[0]) == [[0.6, 0.9]]
    assert heights(base) == split["base_over_plain"].tolist()
    assert heights(bumps) == split["pattern_over_plain"].tolist()
    assert [bar.get_y() for bar in bumps] == split["base_over_plain"].tolist()
    assert [text.get_text().strip() for text in figure.axes[0].texts] == ["0.75", "1.00"]
    assert "(-)" in figure.axes[0].get_ylabel()
    assert remarks_of(figure) == "; ".join(REMARKS)


def test_relative_wear_is_sorted_and_marked():
    """Lowest first, with the table's heights and alpha_ER; an interval where one is known, and nothing elsewhere."""
    table = pd.DataFrame(
        {
            "setting": ["R1", "R2", "R3"],
            "surface": "convex",
            "wear_over_plain": [1.2, 0.8, 1.0],
            "equivalent_size_ratio": [0.11, 0.22, 0.33],
            "interval_low": [1.1, 0.7, np.nan],
            "interval_high": [1.4, 0.9, np.nan],
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
    np.testing.assert_allclose(ends_of(axes), [[0.7, 0.9], [1.1, 1.4]], rtol=RELATIVE)
    marks = {line.get_label(): tuple(line.get_xydata()[0]) for line in axes.lines if line.get_label()[0] != "_"}
    assert marks == {"Yan": (0.0, 0.34), "Yan (at least)": (2.0, 1.0)}
    wide = bars.relative_wear(table.assign(interval_high=[80.0, 0.9, np.nan]), published[:0], REMARKS).axes[0]
    assert 2.0 * 1.2 < wide.get_ylim()[1] < 5.0 * 1.2  # bars stay to be seen beside an interval without end
    alone = table.assign(interval_low=np.nan, interval_high=np.nan)
    assert ends_of(bars.relative_wear(alone, published[:0], REMARKS).axes[0]) == []
    assert remarks_of(figure) == "; ".join(REMARKS)


@pytest.mark.parametrize(("count", "angle"), [(bars.MOST_NUMBERS, 0.0), (bars.MOST_NUMBERS + 1, 90.0)])
def test_numbers_of_many_rows_stand_upright(count, angle):
    """Names and both numbers of a row, so that none covers its neighbour's."""
    told = {"surface": "convex", "wear_over_plain": 0.5, "equivalent_size_ratio": 0.4}
    table = pd.DataFrame(
        [{"setting": f"O{k}", **told, "interval_low": 0.4, "interval_high": 0.6} for k in range(count)]
    )
    axes = bars.relative_wear(table, pd.DataFrame(columns=["row", "relation", "value", "source"]), REMARKS).axes[0]
    shown = [*axes.texts, *axes.get_xticklabels()]
    assert len(shown) == 3 * count and {text.get_rotation() for text in shown} == {angle}


def test_laws_on_a_log_axis():
    """Both volumes are drawn as tabled in mm³ on a log axis; a volume of zero is left out, not drawn at a limit."""
    volumes = {"worn_volume_mm3": [1.0, 2.0], "finnie_volume_mm3": [0.01, 0.0], "finnie_over_archard": [0.01, np.nan]}
    ends = {"interval_low": [0.008, np.nan], "interval_high": [0.0125, np.nan]}
    table = pd.DataFrame({"setting": ["a", "b"], "surface": "convex", **volumes, **ends})
    axes = bars.wear_law_comparison(table, REMARKS).axes[0]
    archard, finnie, *_ = (line.get_ydata() for line in axes.get_lines())
    np.testing.assert_allclose(ends_of(axes)[-1], [0.008, 0.0125], rtol=RELATIVE)
    np.testing.assert_array_equal(archard, table["worn_volume_mm3"])
    assert finnie[0] == 0.01
    assert np.isnan(finnie[1])
    assert axes.get_yscale() == "log"
    assert "(mm³)" in axes.get_ylabel()


def test_mean_forces_of_many_settings():
    """Means stand where their setting is named, in N, bars from end to end of their intervals."""
    names = [f"R{k}" for k in range(1, 5)]
    table = pd.DataFrame({"setting": np.repeat(names, 2), "surface": ["convex", "plain"] * 4})
    mean = np.arange(8.0) + 1.0
    table = table.assign(mean_force_N=mean, interval_low=mean - 0.5, interval_high=mean + 1.0)
    table = pd.concat([table.assign(direction=name) for name in ("vertical", "drag")], ignore_index=True)
    figure = bars.mean_forces(table, REMARKS)
    assert [axes.get_ylabel() for axes in figure.axes] == ["Vertical force (N)", "Drag force (N)"]
    assert [label.get_text() for label in figure.axes[1].get_xticklabels()] == names
    for axes in figure.axes:
        convex, plain = (line.get_ydata() for line in axes.get_lines() if line.get_marker() in "os")
        np.testing.assert_array_equal(convex, [1.0, 3.0, 5.0, 7.0])
        np.testing.assert_array_equal(plain, [2.0, 4.0, 6.0, 8.0])
        np.testing.assert_allclose(ends_of(axes)[0], [0.5, 2.0], rtol=RELATIVE)
        low, high = axes.get_ylim()
        assert low == 0.0 and high - 9.0 > bars.ROOM_ABOVE * 9.0  # the highest mark is not cut


def test_long_names_stand_upright(split):
    """Six short names lie in a line; six of twelve characters would run into one another."""
    table = pd.concat([split.iloc[:1]] * bars.MANY, ignore_index=True)
    for setting, angle in (("R9", 0.0), ("tetrahedron", 90.0)):
        axes = bars.wear_split(table.assign(setting=setting), REMARKS).axes[0]
        assert {label.get_rotation() for label in axes.get_xticklabels()} == {angle}
