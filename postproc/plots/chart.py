"""What an interactive figure shows of the table beside its picture, told in names of columns.

A `Chart` says nothing of pixels: `interactive.plotted` makes of it and of the tables what plotly draws.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

LINES, POINTS, BARS, LEVELS = "lines", "points", "bars", "levels"  # kinds of a layer


@dataclass(frozen=True)
class Axis:
    """What is measured along an axis: title, unit and whether it is logarithmic."""

    title: str
    unit: str = ""
    log: bool = False

    @property
    def label(self) -> str:
        """Return title and unit as they stand at an axis."""
        return f"{self.title} ({self.unit})" if self.unit else self.title


@dataclass(frozen=True)
class Layer:
    """Rows of a table that are drawn alike.

    kind: LINES, POINTS, BARS, or LEVELS, lines right across
    y: column of values, or a pattern with a star for several; words of horizontal bars
    x: column, or several whose words stand together; "" for LEVELS
    low, high: columns with the ends of an interval; spread: column with half of one
    band: whether intervals are fields beside a line and not bars of error
    group: columns whose values make an entry of the legend, each with its colour
    curve: further columns that tell the curves of an entry apart
    name: what an entry is called beside its group, or without one
    said: what a value is called, where that is not the title of its axis
    only, but: {column: values} of rows that are drawn, and of rows that are not
    table: key of another table, "" for the figure's own; split: its column that stands for that of the chart's split
    published: whether others found it: in the colour of letters, dashed or hollow
    dashed, thin: look of a line
    factor: values of the table times this are in the unit of the axis
    """

    kind: str
    y: str
    x: str | tuple[str, ...] = ""
    low: str = ""
    high: str = ""
    spread: str = ""
    band: bool = False
    group: tuple[str, ...] = ()
    curve: tuple[str, ...] = ()
    name: str = ""
    said: str = ""
    only: Mapping[str, Any] = field(default_factory=dict)
    but: Mapping[str, Any] = field(default_factory=dict)
    table: str = ""
    split: str = ""
    published: bool = False
    dashed: bool = False
    thin: bool = False
    factor: float = 1.0

    @property
    def along(self) -> tuple[str, ...]:
        """Return the columns of x."""
        return (self.x,) if isinstance(self.x, str) and self.x else tuple(self.x)


@dataclass(frozen=True)
class Panel:
    """One pair of axes with its layers; levels: {name: value} of straight lines right across."""

    x: Axis
    y: Axis
    layers: tuple[Layer, ...]
    title: str = ""
    levels: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Chart:
    """An interactive figure.

    split: column of which each value has the panels for itself; tables without it are in all of them
    axes: {value of split: axis of y}, where units differ
    sift: column by whose values curves are switched besides by the entries of the legend
    names: {value or column: words}, where underscores as blanks do not suffice
    colours: {entry of the legend, or value of its first column: name of a colour in `style`}; surfaces have the
        house's own, all others come in the order of its palette
    stacked: whether bars stand upon one another
    """

    panels: tuple[Panel, ...]
    split: str = ""
    sift: str = ""
    axes: Mapping[str, Axis] = field(default_factory=dict)
    names: Mapping[str, str] = field(default_factory=dict)
    colours: Mapping[str, str] = field(default_factory=dict)
    stacked: bool = False

    def columns(self) -> set[str]:
        """Return the columns that the figure's own table must have; patterns stand for any number of them."""
        layers = [layer for panel in self.panels for layer in panel.layers if not layer.table]
        named = {
            name
            for layer in layers
            for name in (*layer.along, layer.y, layer.low, layer.high, layer.spread, *layer.group, *layer.curve)
            if name and "*" not in name
        }
        filters = {name for layer in layers for name in (*layer.only, *layer.but)}
        return named | filters | set(filter(None, (self.split, self.sift)))


def one_panel(x: Axis, y: Axis, *layers: Layer, levels: Mapping[str, float] | None = None, **more: Any) -> Chart:
    """Return a chart of one pair of axes; levels as of a `Panel`, more as of a `Chart`."""
    return Chart((Panel(x, y, layers, levels=levels or {}),), **more)
