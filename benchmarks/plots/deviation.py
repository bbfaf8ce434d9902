"""How far numerical choices change a result: a panel per choice, changes with intervals, the limit that matters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from postproc.plots.style import BLUE, ORANGE, OTHER_COLOUR, SMALLEST_FONT, new_figure

PERCENT = 100.0


@dataclass(frozen=True)
class Panel:
    """A choice: its axis, the rows of `benchmarks.deviation.changes`, and values worth a line, by name."""

    label: str
    changes: pd.DataFrame
    marked: Mapping[str, float] = field(default_factory=dict)


def deviation_figure(panels: Sequence[Panel], quantity: str, limit: float, remarks: Sequence[str]) -> Figure:
    """Draw the change of a quantity (%) over the values of each choice, both limits (-) and the marked values."""
    figure = new_figure(remarks, 4.2)
    for axes, panel in zip(figure.subplots(1, len(panels), sharey=True, squeeze=False)[0], panels, strict=True):
        rows = panel.changes.dropna(subset=["change"])
        change, low, high = (PERCENT * rows[name].to_numpy() for name in ("change", "change_low", "change_high"))
        reach = np.nan_to_num([change - low, high - change])
        axes.axhspan(-PERCENT * limit, PERCENT * limit, color=OTHER_COLOUR, alpha=0.15, linewidth=0.0)
        axes.errorbar(rows["value"], change, reach, marker="o", markersize=4.0, capsize=2.0, color=BLUE)
        for (name, value), style in zip(panel.marked.items(), ("--", ":", "-."), strict=False):
            axes.axvline(value, color=ORANGE, linestyle=style, linewidth=1.0, label=name)
        for value in panel.changes.loc[panel.changes["failed"] > 0, "value"]:
            axes.axvline(value, color="black", linewidth=0.6, label="a run failed")
        axes.set(xscale="log", xlabel=panel.label)
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(FuncFormatter(lambda value, _: ""))
        if panel.marked:
            axes.legend(loc="best", fontsize=SMALLEST_FONT)
    figure.axes[0].set_ylabel(f"Change of {quantity} (%)")
    return figure
