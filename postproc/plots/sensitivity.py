"""Sobol indices as bars with their intervals, a panel per response."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import (
    BLUE,
    LARGEST_HEIGHT,
    ORANGE,
    OTHER_COLOUR,
    SMALLEST_FONT,
    facet_columns,
    new_figure,
)

BAR = 0.38  # of a factor's line
LINE = 0.5  # inches, of a factor
REASON_CHARACTERS = 44  # of a line that says why there are no bars
BARS = (("first", BLUE, "alone (first order)"), ("total", ORANGE, "with interactions (total)"))


def sensitivity_bars(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw first and total indices of each response; of one without indices stands why.

    table: response, factor, first, total, each with _low and _high, reason
    """
    panels = list(table.groupby("response", sort=False))
    columns = min(facet_columns(len(panels)), 2)
    rows = -(-len(panels) // columns)
    lines = max(len(part) for _, part in panels)
    figure = new_figure(remarks, min(LARGEST_HEIGHT, 1.2 + rows * (0.9 + LINE * lines)))
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, (response, part) in zip(grid, panels, strict=False):
        axes.set_title(response, loc="left", fontsize=SMALLEST_FONT)
        known = part.dropna(subset="total")
        if known.empty:
            _reason(axes, str(part["reason"].iloc[0]))
            continue
        _bars(axes, known)
    for axes in grid[len(panels) :]:
        axes.set_axis_off()
    drawn = next((axes for axes in grid if axes.get_legend_handles_labels()[0]), None)
    if drawn is not None:
        figure.legend(*drawn.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


def _bars(axes: Axes, known: pd.DataFrame) -> None:
    places = -np.arange(len(known), dtype=float)
    for (name, colour, label), shift in zip(BARS, (0.5 * BAR, -0.5 * BAR), strict=True):
        value = known[name].to_numpy()
        ends = np.abs(known[[f"{name}_low", f"{name}_high"]].to_numpy().T - value)
        ends = np.where(ends > 0.0, ends, np.nan)  # of a factor that the surrogate does not have
        look = {"ecolor": OTHER_COLOUR, "capsize": 2.5}
        axes.barh(places + shift, value, BAR, xerr=ends, color=colour, label=label, error_kw=look)
    axes.set_yticks(places, known["factor"])
    axes.axvline(0.0, color="black", linewidth=0.8)
    axes.set(xlabel="Part of the variance (-)", ylabel="Factor")


def _reason(axes: Axes, reason: str) -> None:
    words = fill(f"Not told: {reason}", REASON_CHARACTERS)
    axes.text(0.5, 0.5, words, ha="center", va="center", fontsize=SMALLEST_FONT)
    axes.set_axis_off()
