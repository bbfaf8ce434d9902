"""Entries of the legend of an interactive figure: what they are called, and how they look."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from numbers import Number
from typing import Any

import pandas as pd

from bulkwear.postproc.plots import style
from bulkwear.postproc.plots.chart import Chart, Layer

LETTERS, GREY = "var(--ink)", "var(--soft)"  # colours that follow the page's light or dark
SYMBOLS = ("circle", "square", "diamond", "triangle-up", "cross", "triangle-down", "star", "x")
SURFACE = "surface"  # column whose values have the house's colours


@dataclass(frozen=True)
class Look:
    """An entry of the legend; kind of its layer, dash and symbol as plotly calls them."""

    name: str
    kind: str
    colour: str
    dash: str
    symbol: str


@dataclass
class Legend:
    """The entries that a chart has so far; the palette is given out in the order in which they come, to what others
    found as well only if ours of the same group has its colour."""

    chart: Chart
    looks: dict[str, Look] = field(default_factory=dict)
    taken: dict[str, str] = field(default_factory=dict)  # colour by what is told apart
    symbols: dict[str, str] = field(default_factory=dict)

    def look(self, layer: Layer, values: Mapping[str, Any], fallback: str) -> Look:
        """Return the entry of a layer's rows; values: of the columns of its group; fallback: its name without any."""
        group = ", ".join(self.words(column, value) for column, value in values.items())
        name = ", ".join(filter(None, (group, layer.name))) or fallback
        if name not in self.looks:
            colour = self._colour(layer, values, group or name, name)
            symbol = self._symbol(group or name, colour)
            hollow = "-open" if layer.published else ""
            dash = "dash" if layer.published or layer.dashed else "solid"
            self.looks[name] = Look(name, layer.kind, colour, dash, f"{symbol}{hollow}")
        return self.looks[name]

    def words(self, column: str, value: Any) -> str:
        """Return how a value of a column is called; a number comes with the name of its column."""
        if str(value) in self.chart.names:
            return self.chart.names[str(value)]
        if isinstance(value, Number) and not isinstance(value, bool):
            return f"{self.chart.names.get(column, plain(column))} {value:g}"
        return plain(value)

    def _colour(self, layer: Layer, values: Mapping[str, Any], key: str, name: str) -> str:
        first = str(next(iter(values.values()), ""))
        given = self.chart.colours.get(name) or self.chart.colours.get(first)
        if given:
            return _themed(getattr(style, given))
        if SURFACE in values:
            return _themed(style.colour(values[SURFACE]))
        if layer.published and key not in self.taken:
            return LETTERS
        if key not in self.taken:
            used = {look.colour for look in self.looks.values()}
            free = [colour for colour in style.SERIES_COLOURS if _themed(colour) not in used]
            self.taken[key] = (free or style.SERIES_COLOURS)[0 if free else len(self.taken) % len(style.SERIES_COLOURS)]
        return _themed(self.taken[key])

    def _symbol(self, key: str, colour: str) -> str:
        """Return a symbol that no other entry of the colour has, as long as there are some."""
        if key not in self.symbols:
            others = sum(look.colour == colour for look in self.looks.values())
            self.symbols[key] = SYMBOLS[others % len(SYMBOLS)]
        return self.symbols[key]


def telling(layer: Layer, table: pd.DataFrame, chart: Chart) -> list[str]:
    """Return the columns of a layer's group that tell its rows apart, or whose values the chart has words for; the
    first one if none does and the layer has no name.
    """
    worded = set(chart.names)
    several = [name for name in layer.group if table[name].nunique() > 1 or worded & set(map(str, table[name]))]
    return several or ([] if layer.name else list(layer.group[:1]))


def plain(value: Any) -> str:
    """Return a value as a word for people."""
    return str(value).replace("_", " ")


def _themed(colour: str) -> str:
    return {style.OTHER_COLOUR: GREY, "black": LETTERS}.get(colour, colour)
