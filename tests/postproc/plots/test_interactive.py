"""Interactive figures: what plotly draws is what the table holds, in the look of the house."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.plots import style
from bulkwear.postproc.plots.chart import BARS, LEVELS, LINES, POINTS, Axis, Chart, Layer, Panel, one_panel
from bulkwear.postproc.plots.interactive import plotted
from bulkwear.postproc.plots.legend import GREY, LETTERS
from bulkwear.postproc.plots.traces import MOST_MARKS, WITHOUT_END

TRAVEL, VOLUME, PART, LIFE = Axis("Travel", "mm"), Axis("Volume", "mm³"), Axis("Part"), Axis("Life", "h")


def runs():
    """Two runs of a convex and one of a plain sample, of three points each."""
    rows = {"travel_mm": [0.0, 5.0, 10.0], "volume_m3": [0.0, 1e-9, 2e-9]}
    names = (("R1", "convex", "R1_convex"), ("R2", "convex", "R2_convex"), ("R1", "plain", "R1_plain"))
    tables = [pd.DataFrame(rows).assign(setting=a, surface=b, run=c) for a, b, c in names]
    return pd.concat(tables, ignore_index=True)


def of_runs(**more):
    layer = Layer(LINES, "volume_m3", "travel_mm", group=("surface",), curve=("setting", "run"), factor=1e9)
    return one_panel(TRAVEL, VOLUME, layer, **more)


def traces(found, panel=0):
    return found["panels"][panel]["data"]


def test_curves_are_those_of_the_table():
    """A curve for every run in the unit of the axis, an entry for every surface in its colour; JSON takes it."""
    found = plotted(of_runs(), {"": runs()})
    assert [trace["y"] for trace in traces(found)] == [[0.0, 1.0, 2.0]] * 3
    assert [trace["x"] for trace in traces(found)] == [[0.0, 5.0, 10.0]] * 3
    assert [trace["legendgroup"] for trace in traces(found)] == ["convex", "convex", "plain"]
    assert {each["name"]: each["colour"] for each in found["entries"]} == {
        name: style.colour(name) for name in ("convex", "plain")
    }
    assert found["panels"][0]["layout"]["yaxis"]["title"]["text"] == "Volume (mm³)"
    json.dumps(found, allow_nan=False)


def test_values_know_whose_they_are():
    """By the run where a curve has one, else by what runs share: once for a whole curve, or value by value."""
    assert [trace["of"] for trace in traces(plotted(of_runs(), {"": runs()}))] == [
        {"run": [name]} for name in ("R1_convex", "R2_convex", "R1_plain")
    ]
    ends = runs().query("travel_mm == 10").drop(columns="run")
    layer = Layer(BARS, "volume_m3", "setting", group=("surface",))
    convex, plain = traces(plotted(one_panel(PART, VOLUME, layer), {"": ends}))
    assert convex["of"] == {"setting": ["R1", "R2"], "surface": ["convex"]}
    assert plain["of"] == {"setting": ["R1"], "surface": ["plain"]}
    measured = ends.assign(run=["R1_convex", None, "R1_plain"])
    assert traces(plotted(one_panel(PART, VOLUME, layer), {"": measured}))[0]["of"] == {"run": ["R1_convex", None]}
    theirs = one_panel(PART, VOLUME, replace(layer, published=True))
    assert not any("of" in trace for trace in traces(plotted(theirs, {"": ends})))


def test_the_pointer_tells_run_place_value_and_unit():
    """All of them stand in what is shown at a point; markup in a name stays a name."""
    table = runs().replace({"run": {"R1_convex": "R1 <b>"}})
    shown = traces(plotted(of_runs(), {"": table}))[0]["hovertemplate"]
    assert shown.startswith("<b>convex, R1, R1 &lt;b&gt;</b><br>Travel: %{x:")
    assert "} mm<br>Volume: %{y:" in shown and "%{customdata} mm³<extra></extra>" in shown


def test_the_sift_tells_curves_apart_by_another_column():
    """Every curve has its word; one word alone is no choice."""
    found = plotted(of_runs(sift="setting"), {"": runs()})
    assert found["sift"] == ["R1", "R2"]
    assert [trace["meta"] for trace in traces(found)] == ["R1", "R2", "R1"]
    one = plotted(of_runs(sift="setting"), {"": runs().query("setting == 'R1'")})
    assert one["sift"] == []


def test_intervals_reach_to_their_ends():
    """Bars of error end at low and high, half of them in a spread; what has none has no bar and says nothing."""
    table = pd.DataFrame({"row": ["A", "B"], "value": [2.0, 3.0], "low": [1.5, np.nan], "high": [4.0, np.nan]})
    layer = Layer(POINTS, "value", "row", low="low", high="high")
    (trace,) = traces(plotted(one_panel(PART, VOLUME, layer), {"": table}))
    assert trace["error_y"]["array"] == [2.0, None] and trace["error_y"]["arrayminus"] == [0.5, None]
    assert trace["customdata"] == [" (1.5 to 4)", ""]
    spread = Layer(POINTS, "value", "row", spread="half")
    (trace,) = traces(plotted(one_panel(PART, VOLUME, spread), {"": table.assign(half=0.5)}))
    assert trace["error_y"]["array"] == trace["error_y"]["arrayminus"] == [0.5, 0.5]


def test_a_band_goes_round_its_line():
    """The field runs along low ends and back along high ones, is switched with the line, and is not pointed at."""
    table = pd.DataFrame(
        {"x": [0.0, 1.0, 2.0], "y": [1.0, 2.0, 3.0], "low": [0.0, 1.0, np.nan], "high": [2.0, 3.0, 4.0]}
    )
    layer = Layer(LINES, "y", "x", low="low", high="high", band=True)
    field, line = traces(plotted(one_panel(TRAVEL, VOLUME, layer), {"": table}))
    assert (field["x"], field["y"]) == ([0.0, 1.0, 1.0, 0.0], [0.0, 1.0, 3.0, 2.0])
    assert field["hoverinfo"] == "skip" and field["legendgroup"] == line["legendgroup"]
    assert "error_y" not in line


def test_lives_lie_and_may_have_no_end():
    """Bars of a column of words lie, first part on top; an interval without an end stops past the longest."""
    table = pd.DataFrame(
        {"part": ["belt_liner", "wall"], "life": [10.0, 40.0], "low": [8.0, 30.0], "high": [15.0, np.inf]}
    )
    layer = Layer(BARS, "part", "life", low="low", high="high")
    found = plotted(one_panel(LIFE, PART, layer), {"": table})
    (bar,) = traces(found)
    assert bar["orientation"] == "h" and bar["y"] == ["belt liner", "wall"] and bar["x"] == [10.0, 40.0]
    assert bar["error_x"]["array"] == pytest.approx([5.0, WITHOUT_END * 40.0 - 40.0])
    assert bar["customdata"][1] == " (30 to no end)"
    assert found["panels"][0]["layout"]["yaxis"]["autorange"] == "reversed"


def test_what_others_found_is_set_apart():
    """It comes from a table of its own, dashed or hollow, in the colour of letters, or of ours of the same group;
    levels go right across. Without that table the rest is drawn."""
    theirs = pd.DataFrame({"at": [10.0], "found": [1.5], "surface": ["plain"], "of": ["R1"]})
    look = {"table": "theirs", "name": "Yan", "published": True}
    point, level = Layer(POINTS, "found", "at", **look), Layer(LEVELS, "found", group=("surface",), **look)
    chart = Chart((Panel(TRAVEL, VOLUME, (of_runs().panels[0].layers[0], point, level), levels={"limit": 2.0}),))
    found = plotted(chart, {"": runs(), "theirs": theirs})
    entries = {each["name"]: each for each in found["entries"]}
    assert entries["Yan"]["colour"] == LETTERS and entries["Yan"]["symbol"].endswith("-open")
    assert [trace["x"] for trace in traces(found)[-2:]] == [[0.0, 10.0]] * 2
    assert [trace["y"] for trace in traces(found)[-2:]] == [[1.5, 1.5], [2.0, 2.0]]
    assert {entries[name]["dash"] for name in ("Yan", "limit")} == {"dash"}
    assert [each["name"] for each in plotted(chart, {"": runs()})["entries"]] == ["convex", "plain", "limit"]


def test_a_published_curve_has_the_colour_of_ours():
    """Of the same group; it is dashed."""
    table = pd.DataFrame({"scale": [1, 2], "wear": [1.0, 2.0], "curve": ["base", "bumps"]})
    ours, theirs = (
        Layer(LINES, "wear", "scale", group=("curve",), **more)
        for more in ({}, {"table": "theirs", "name": "Yan", "published": True})
    )
    found = plotted(one_panel(TRAVEL, VOLUME, ours, theirs), {"": table, "theirs": table})
    assert [(each["name"], each["colour"], each["dash"]) for each in found["entries"]] == [
        (f"{curve}{source}", colour, dash)
        for source, dash in (("", "solid"), (", Yan", "dash"))
        for curve, colour in (("base", style.BLUE), ("bumps", style.ORANGE))
    ]


def test_panels_are_split_with_their_own_units():
    """A panel for each value, published numbers of the same value in it by the column that stands for it."""
    table = pd.DataFrame({"measure": ["a", "b"], "x": [1.0, 1.0], "y": [2.0, 3.0]})
    theirs = pd.DataFrame({"quantity": ["b"], "value": [4.0]})
    level = Layer(LEVELS, "value", table="theirs", split="quantity", name="Yan", published=True)
    axes = {"b": Axis("Force", "N")}
    chart = one_panel(TRAVEL, VOLUME, Layer(POINTS, "y", "x"), level, split="measure", axes=axes)
    found = plotted(chart, {"": table, "theirs": theirs})
    titles = [(each["title"], each["layout"]["yaxis"]["title"]["text"]) for each in found["panels"]]
    assert titles == [("a", "Volume (mm³)"), ("b", "Force (N)")]
    assert [len(traces(found, k)) for k in range(2)] == [1, 2]


def test_a_pattern_of_columns_makes_a_layer_of_each():
    """They are called by what the star stands for."""
    table = pd.DataFrame({"t": [0.0, 1.0], "power_drum_kW": [1.0, 2.0], "power_screw_kW": [3.0, 4.0]})
    found = plotted(
        one_panel(TRAVEL, Axis("Power", "kW"), Layer(LINES, "power_*_kW", "t", name="power of")), {"": table}
    )
    assert [each["name"] for each in found["entries"]] == ["power of drum", "power of screw"]


def test_rows_are_chosen_and_rows_left_out():
    """By values of columns."""
    table = pd.DataFrame({"t": [0.0, 1.0, 2.0], "v": [1.0, 2.0, 3.0], "packing": [0, 1, 2]})
    layers = Layer(LINES, "v", "t", only={"packing": 0}), Layer(LINES, "v", "t", but={"packing": (0, 2)}, name="b")
    assert [trace["x"] for trace in traces(plotted(one_panel(TRAVEL, VOLUME, *layers), {"": table}))] == [[0.0], [1.0]]


def test_colours_are_those_of_the_style():
    """Entries may name one; grey and black are those of the page's light or dark."""
    table = pd.DataFrame({"row": ["A"], "base": [1.0], "all": [2.0]})
    layers = [Layer(BARS, name, "row", name=name) for name in ("base", "all")]
    chart = one_panel(PART, VOLUME, *layers, colours={"base": "BASE_COLOUR", "all": "OTHER_COLOUR"}, stacked=True)
    found = plotted(chart, {"": table})
    assert [each["colour"] for each in found["entries"]] == [style.BASE_COLOUR, GREY]
    assert found["panels"][0]["layout"]["barmode"] == "stack"


def test_long_curves_have_no_marks():
    """Marks would hide them."""
    for count, mode in ((MOST_MARKS, "lines+markers"), (MOST_MARKS + 1, "lines")):
        table = pd.DataFrame({"x": np.arange(count), "y": np.arange(count)})
        assert traces(plotted(one_panel(TRAVEL, VOLUME, Layer(LINES, "y", "x")), {"": table}))[0]["mode"] == mode


def test_a_table_without_the_columns_has_no_chart():
    """Nor has an empty one: the picture stands alone."""
    assert plotted(of_runs(), {"": runs().drop(columns="travel_mm")}) is None
    assert plotted(of_runs(), {"": runs()[:0]}) is None
