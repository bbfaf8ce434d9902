"""Figures of what moves the wear of a convex sample in coarse particles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import BLUE, ORANGE, OTHER_COLOUR, new_figure

LINE_HEIGHT = 0.19  # inches
LEGEND_AND_REMARKS = 2.4  # inches
CURVES_HEIGHT = 5.0  # inches
COLUMNS, LONG = 3, 40  # of a legend, one less where a label has more letters
SOURCE, SOURCE_COLOUR = "Yan 2022, Eq 4.14, 4.15", "#009E73"
SHADES = (
    "black",
    BLUE,
    OTHER_COLOUR,
    ORANGE,
    "#56B4E9",
    "#CC79A7",
    "#E69F00",
    "#882255",
    "#999933",
)  # of candidates, the reference first
LINE_STYLES = ("-", ":", "-.")  # of the candidates that have the first shades, of the next ones
MARKERS = ("D", "o", "^", "s", "v", "P", "X", "<", ">")
APART = 0.03  # -, of a particle scale: intervals of candidates do not cover each other
KINDS = {  # what the source says of a thing -> words, colour, marker
    "": ("the study with the source's pair", "black", "D"),
    "open": ("left open by the source", BLUE, "o"),
    "ours": ("a choice of the simulation", OTHER_COLOUR, "^"),
    "published": ("published, changed to see what it does", ORANGE, "s"),
}


def ratio_by_candidate(table: pd.DataFrame, source: Mapping[int, float], remarks: Sequence[str]) -> Figure:
    """Draw wear over plain of every candidate with its interval, where there is one; a panel per particle scale.

    table: candidate, kind (of KINDS), particle_scale, wear_over_plain, ratio_low, ratio_high (NaN: not known); the
        first line of a scale is the reference
    source: the source's ratio by particle scale
    """
    names = list(dict.fromkeys(table["candidate"]))
    figure = new_figure(remarks, LEGEND_AND_REMARKS + LINE_HEIGHT * len(names))
    scales = list(dict.fromkeys(table["particle_scale"]))
    panels = figure.subplots(1, len(scales), sharey=True, squeeze=False)[0]
    for axes, scale in zip(panels, scales, strict=True):
        rows = table[table["particle_scale"] == scale]
        axes.axvline(1.0, color="#a0a0a0", linewidth=0.8)
        first = rows["wear_over_plain"].iloc[0]
        axes.axvline(first, color="black", linewidth=0.8, linestyle=":", label="as the first line")
        axes.axvline(source[scale], color=SOURCE_COLOUR, linewidth=1.4, linestyle="--", label=SOURCE)
        for kind, (words, shade, marker) in KINDS.items():
            some = rows[rows["kind"] == kind]
            if some.empty:
                continue
            places = [names.index(name) for name in some["candidate"]]
            value, low, high = (some[name].to_numpy() for name in ("wear_over_plain", "ratio_low", "ratio_high"))
            axes.hlines(places, low, high, color=shade, linewidth=0.8)
            axes.plot(value, places, marker, color=shade, markersize=5.0, label=words)
        largest = np.nanmax([source[scale], *rows["wear_over_plain"], *rows["ratio_high"]])
        axes.set(xlim=(0.0, 1.08 * largest))
        axes.set_title(f"scale {scale:g}", loc="left")
        axes.grid(axis="y", visible=False)
    # below each panel the words would meet
    panels[0].set_xlabel("Wear, convex over plain (-)", loc="left")
    panels[0].set_yticks(range(len(names)), names)
    panels[0].set_ylim(len(names) - 0.5, -0.5)
    _legend(figure, panels)
    return figure


def ratio_by_scale(table: pd.DataFrame, source: Mapping[float, float], remarks: Sequence[str]) -> Figure:
    """Draw wear over plain against the particle scale, a line per candidate of several scales, beside the source's.

    table: candidate, particle_scale, wear_over_plain, ratio_low, ratio_high (NaN: not known); source: the source's
    ratio by particle scale
    """
    figure = new_figure(remarks, CURVES_HEIGHT)
    axes = figure.subplots()
    axes.axhline(1.0, color="#a0a0a0", linewidth=0.8)
    axes.plot(list(source), list(source.values()), "--", color=SOURCE_COLOUR, linewidth=1.8, label=SOURCE)
    curves = [(name, rows) for name, rows in table.groupby("candidate", sort=False) if len(rows) > 1]
    for number, (name, rows) in enumerate(curves):
        rows, look = rows.sort_values("particle_scale"), {"color": SHADES[number % len(SHADES)], "linewidth": 1.1}
        place = rows["particle_scale"] + APART * (number - 0.5 * (len(curves) - 1))
        marker, line = MARKERS[number % len(MARKERS)], LINE_STYLES[number // len(SHADES) % len(LINE_STYLES)]
        axes.plot(place, rows["wear_over_plain"], marker, linestyle=line, label=name, **look)
        axes.vlines(place, rows["ratio_low"], rows["ratio_high"], **look)
    axes.set(xlabel="Particle scale (-)", ylabel="Wear, convex over plain (-)", ylim=(0.0, None))
    _legend(figure, [axes])
    return figure


def _legend(figure: Figure, panels: Sequence[Axes]) -> None:
    """Name each line once, whichever panel has it."""
    named = {label: line for axes in panels for line, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    columns = COLUMNS - any(len(label) > LONG for label in named)
    figure.legend(named.values(), named, loc="outside upper center", ncols=columns)
