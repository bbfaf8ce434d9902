"""An interactive figure made of tables and of a `Chart`: what plotly draws, and the entries of its legend."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from fnmatch import fnmatchcase
from textwrap import wrap
from typing import Any

import pandas as pd

from bulkwear.postproc.plots.chart import BARS, LEVELS, LINES, Axis, Chart, Layer, Panel
from bulkwear.postproc.plots.legend import Legend, plain, telling
from bulkwear.postproc.plots.traces import Trace, traces_of

Tables = Mapping[str, pd.DataFrame]
FROM_ZERO = 0.5  # -, least over largest value, up to which an axis begins at zero
LONGEST_LINE = 38  # characters at an axis: more do not fit on a phone
RUN, SHARED_BY_RUNS = "run", ("row", "setting", "surface")  # columns
BESIDE = 0.5  # of the unit of an axis: how far a level reaches beside a single place


def plotted(chart: Chart, tables: Tables) -> dict[str, Any] | None:
    """Return {"panels": [{"title", "data", "layout"}], "entries": [as `Look`], "sift": [words]}, ready for JSON; `meta`
    of a trace is its word of the sift, `of` whose its values are.

    tables: by the keys of layers, "" the figure's own; layers of tables that are not there are left out. None where
    the figure's own table has not all columns of the chart, or no rows.
    """
    own = tables[""]
    if own.empty or not chart.columns() <= set(own):
        return None
    legend = Legend(chart)
    values = list(dict.fromkeys(own[chart.split].dropna())) if chart.split else [None]
    made = [_panel(chart, panel, value, tables, legend) for value in values for panel in chart.panels]
    panels = [panel for panel in made if panel]
    shown = {trace["legendgroup"] for panel in panels for trace in panel["data"]}
    entries = [asdict(look) for look in legend.looks.values() if look.name in shown]
    sifted = list(dict.fromkeys(trace["meta"] for panel in panels for trace in panel["data"] if trace.get("meta")))
    return {"panels": panels, "entries": entries, "sift": sifted if len(sifted) > 1 else []} if panels else None


def _panel(chart: Chart, panel: Panel, value: Any, tables: Tables, legend: Legend) -> dict[str, Any] | None:
    """Return the traces and axes of a panel for a value of the split; None where it has nothing to show."""
    axes = panel.x, chart.axes.get(str(value), panel.y)
    layers = list(_layers(panel.layers, tables, chart.split, value))
    words = _places_in_words(layers)
    data = [
        trace
        for layer, table, rows in layers
        if layer.kind != LEVELS
        for trace in _curves(layer, table, rows, axes, legend, words, chart.sift)
    ]
    if not data:
        return None
    reach = _reach(data, words)
    for layer, table, rows in layers:
        if layer.kind == LEVELS:
            data += _levels(layer, table, rows, axes, legend, reach)
    for name, height in panel.levels.items():
        level = pd.DataFrame({"level": [height]})
        data += _levels(Layer(LEVELS, "level", name=name, published=True), level, level, axes, legend, reach)
    split = legend.words(chart.split, value) if value is not None else ""
    title = ": ".join(filter(None, (split, panel.title)))
    return {"title": title, "data": data, "layout": _layout(axes, data, words, chart.stacked)}


def _layers(
    layers: Sequence[Layer], tables: Tables, split: str, value: Any
) -> Iterator[tuple[Layer, pd.DataFrame, pd.DataFrame]]:
    """Yield layers with their table and those of its rows that are drawn; a pattern of columns makes one of each."""
    for layer in layers:
        if layer.table not in tables:
            continue
        table = tables[layer.table]
        for each in _spelled(layer, table):
            column = each.split or split
            rows = table[table[column] == value] if column in table else table
            for name, wanted in each.only.items():
                rows = rows[rows[name].isin(_listed(wanted))]
            for name, unwanted in each.but.items():
                rows = rows[~rows[name].isin(_listed(unwanted))]
            if rows[_valued(each, rows)].notna().any():
                yield each, table, rows


def _valued(layer: Layer, rows: pd.DataFrame) -> str:
    """Return the column of a layer's values: y, or x of bars that lie."""
    return layer.y if layer.kind == LEVELS or pd.api.types.is_numeric_dtype(rows[layer.y]) else layer.along[0]


def _spelled(layer: Layer, table: pd.DataFrame) -> list[Layer]:
    """Return a layer of every column that its pattern fits, named by what the star stands for."""
    if "*" not in layer.y:
        return [layer]
    start, _, end = layer.y.partition("*")
    fitting = [str(name) for name in table if fnmatchcase(str(name), layer.y)]
    names = {name: plain(name.removeprefix(start).removesuffix(end)) for name in fitting}
    return [replace(layer, y=name, name=" ".join(filter(None, (layer.name, names[name])))) for name in fitting]


def _listed(values: Any) -> list[Any]:
    return list(values) if isinstance(values, (list, tuple, set)) else [values]


def _places_in_words(layers: Sequence[tuple[Layer, pd.DataFrame, pd.DataFrame]]) -> bool:
    """Return whether places along x are words: of bars that stand, of several columns, of columns of words."""
    for layer, _, rows in layers:
        if layer.kind != LEVELS and pd.api.types.is_numeric_dtype(rows[layer.y]):
            one = len(layer.along) == 1 and pd.api.types.is_numeric_dtype(rows[layer.along[0]])
            if layer.kind == BARS or not one:
                return True
    return False


def _curves(
    layer: Layer,
    table: pd.DataFrame,
    rows: pd.DataFrame,
    axes: tuple[Axis, Axis],
    legend: Legend,
    words: bool,
    sift: str,
) -> Iterator[Trace]:
    """Yield the traces of a layer: one curve for each group and what tells its curves apart."""
    group = telling(layer, table, legend.chart)
    keys = list(dict.fromkeys([*group, *layer.curve]))
    used = [*keys, *layer.along, layer.y, *filter(None, (layer.low, layer.high, layer.spread))]
    rows = rows[rows[layer.y].notna()].drop_duplicates(list(dict.fromkeys(used)))
    for key, curve in rows.groupby(keys, sort=False) if keys else [((), rows)]:
        values = dict(zip(keys, key, strict=True))
        look = legend.look(layer, {name: values[name] for name in group}, layer.said or axes[1].title)
        more = [legend.words(name, values[name]) for name in layer.curve if name not in group]
        told = {"meta": legend.words(sift, values[sift])} if sift in values else {}
        told |= {} if layer.published else _whose(curve)
        yield from (trace | told for trace in traces_of(layer, curve, axes, look, [look.name, *more], words))


def _whose(curve: pd.DataFrame) -> dict[str, dict[str, list[str | None]]]:
    """Return whose the values of a curve are: names of runs, else of what several have; of each value, or of all. None
    where they are no run's.
    """
    names = [RUN] if RUN in curve else [name for name in SHARED_BY_RUNS if name in curve]
    words = {name: [None if pd.isna(each) else str(each) for each in curve[name]] for name in names}
    return {"of": {name: each if len(set(each)) > 1 else each[:1] for name, each in words.items()}} if words else {}


def _reach(data: Sequence[Trace], words: bool) -> list[Any]:
    """Return the ends of what is drawn along x, between which levels go."""
    every = [value for trace in data for value in trace["x"] if value is not None]
    if words:
        found = list(dict.fromkeys(every))
        return [found[0], found[-1]] if len(found) > 1 else found
    low, high = min(every), max(every)
    return [low, high] if high > low else [low - BESIDE, high + BESIDE]


def _levels(
    layer: Layer, table: pd.DataFrame, rows: pd.DataFrame, axes: tuple[Axis, Axis], legend: Legend, reach: list[Any]
) -> Iterator[Trace]:
    """Yield a line right across for every value."""
    group = telling(layer, table, legend.chart)
    for _, row in rows.drop_duplicates([*group, layer.y]).dropna(subset=[layer.y]).iterrows():
        look = legend.look(layer, {name: row[name] for name in group}, layer.said or axes[1].title)
        line = pd.DataFrame([row] * len(reach)).infer_objects().assign(reach=reach)
        kind = LINES if len(reach) > 1 else "points"
        drawn = replace(layer, kind=kind, x="reach", band=layer.band and len(reach) > 1)
        for trace in traces_of(drawn, line, axes, look, [look.name], isinstance(reach[0], str)):
            yield trace | ({"mode": "lines"} if kind == LINES else {})


def _in_order(places: list[str]) -> list[str]:
    """Return places in words in the order of the table, those that are numbers by size."""
    return sorted(places, key=float) if all(map(_is_number, places)) else places


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


def _layout(axes: tuple[Axis, Axis], data: Sequence[Trace], words: bool, stacked: bool) -> dict[str, Any]:
    """Return the axes of a panel; from zero on, where no value is below and some are near it."""
    found = {}
    for name, axis in zip(("x", "y"), axes, strict=True):
        values = [value for trace in data for value in trace[name] if value is not None]
        of_words = bool(values) and isinstance(values[0], str)
        kind = {"type": "category" if of_words else "log" if axis.log else "linear"}
        if of_words:
            kind |= {"categoryorder": "array", "categoryarray": _in_order(list(dict.fromkeys(values)))}
            kind |= {"autorange": "reversed"} if name == "y" else {}
        elif values and not axis.log and 0.0 <= min(values) <= FROM_ZERO * max(values):
            kind |= {"rangemode": "tozero"}
        found[f"{name}axis"] = {"title": {"text": "<br>".join(wrap(axis.label, LONGEST_LINE))}, **kind}
    return found | {"barmode": "stack" if stacked else "group"}
