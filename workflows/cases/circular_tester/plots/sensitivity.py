"""The figure of which published numbers each setting of a circular wear tester reaches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from bulkwear.postproc.plots.style import LARGEST_HEIGHT, SMALLEST_FONT, new_figure

FARTHEST = 2.0  # doublings from the nearest value that agrees at which colours end
DARK = 0.6  # -, of FARTHEST: from there on text is white
SHOWN = ("value", "over", "reached", "packings")  # columns of the table
MISSING = "-"  # in place of a value
CHARACTERS = 48  # bold ones that fit side by side in a line of cells
TWO_LINES = 0.75  # -, size of words of two lines, broken at an underscore
LOOK: dict[str, Any] = {"fontsize": 8.0, "ha": "center", "va": "center"}  # of the text of cells


def reached_by_setting(
    table: pd.DataFrame,
    settings: Mapping[str, Mapping[str, str]],
    changes: Mapping[str, Mapping[str, str]],
    remarks: Sequence[str],
) -> Figure:
    """Draw a line per published number and a column per setting: the value, coloured by how far it is off; below, what
    the settings are and how many numbers they reach.

    table: as from `sensitivity.sensitivity_table`; settings, changes: {pair: {factor: value}}, of all that is varied,
    and of what differs from the reference
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    axes = figure.subplots()
    keys, pairs = list(dict.fromkeys(table["key"])), list(dict.fromkeys(table["pair"]))
    cells = {name: table.pivot(index="key", columns="pair", values=name).loc[keys, pairs] for name in SHOWN}
    reached, known = cells["reached"].eq(True), cells["value"].notna()
    off = np.log2(cells["over"].to_numpy(float))
    norm = TwoSlopeNorm(0.0, -FARTHEST, FARTHEST)
    picture = axes.imshow(np.clip(off, -FARTHEST, FARTHEST), cmap="RdBu_r", norm=norm, aspect="auto")
    for line, column in np.ndindex(off.shape):
        value, there = cells["value"].iloc[line, column], reached.iloc[line, column]
        colour = "white" if abs(off[line, column]) > DARK * FARTHEST else "black"
        word, weight = MISSING if np.isnan(value) else f"{value:.3g}", "bold" if there else "normal"
        axes.text(column, line, word, color=colour, fontweight=weight, **_fitting(word, len(pairs)))
        if there:
            axes.add_patch(Rectangle((column - 0.47, line - 0.44), 0.94, 0.88, fill=False, linewidth=0.8))
    said = table.drop_duplicates("key").set_index("key").loc[keys]
    names = [f"{row.quantity}: {_published(row)}" for row in said.itertuples()]
    varied = list(dict.fromkeys(factor for pair in pairs for factor in changes[pair]))
    below = {
        "reached, of how many": {pair: f"{reached[pair].sum()}/{known[pair].sum()}" for pair in pairs},
        "packings": {pair: f"{cells['packings'][pair].max():g}" for pair in pairs},
        **{name: {pair: settings[pair][name] for pair in pairs} for name in varied},
    }
    _lines_below(axes, below, changes, len(keys))
    axes.set_yticks(range(len(keys) + len(below)), [*names, *below], fontsize=LOOK["fontsize"])
    axes.set_xticks([])
    axes.tick_params(length=0)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    ticks = np.arange(-FARTHEST, FARTHEST + 1)
    bar = figure.colorbar(picture, ax=axes, ticks=ticks, pad=0.01, fraction=0.03)
    bar.ax.set_yticklabels([f"{2.0**tick:g}" for tick in ticks], fontsize=LOOK["fontsize"])
    bar.set_label("Over the nearest value that agrees (-)", fontsize=SMALLEST_FONT)
    return figure


def _published(row: pd.Series) -> str:
    """Return the values that agree with a published number, without it."""
    unit = "" if row.unit == "-" else row.unit
    return f"{row.published.partition(' (published')[0].removesuffix(unit).strip()} {unit}".strip()


def _fitting(word: str, columns: int) -> dict[str, Any]:
    """Return the look of a word that fits in a cell of so many columns."""
    lines = word.split("\n")
    share = min(1.0 if len(lines) == 1 else TWO_LINES, CHARACTERS / columns / max(map(len, lines)))
    return LOOK | {"fontsize": share * LOOK["fontsize"]}


def _lines_below(
    axes: Axes, lines: Mapping[str, Mapping[str, str]], changes: Mapping[str, Mapping[str, str]], first: int
) -> None:
    """Write lines of words under the cells; what differs from the reference is bold, and so is the first line."""
    for number, (name, words) in enumerate(lines.items()):
        for column, (pair, word) in enumerate(words.items()):
            changed = number == 0 or name in changes[pair]
            look = {"color": "black", "fontweight": "bold"} if changed else {"color": "#8a8a8a"}
            broken = word.replace("_", "_\n")
            axes.text(column, first + number, broken, **look, **_fitting(broken, len(words)))
    axes.set_ylim(first + len(lines) - 0.5, -0.5)
    axes.axhline(first - 0.5, color="black", linewidth=0.8)
