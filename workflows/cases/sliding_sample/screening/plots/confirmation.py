"""The figure of a confirmation: predicted intervals against simulated runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from postproc.plots.style import MARKERS, OTHER_COLOUR, SMALLEST_FONT, colour, new_figure, scaled
from postproc.tables.summary import PLAIN
from workflows.cases.sliding_sample.screening.confirmation import interval_reach

ROOM = 1.05  # -, of the largest value on the axis


def confirmation(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the predicted wear per metre (mm3/m) of each best design with its interval, and what the runs wear.

    table: as from `analysis.confirmation.confirmation_table`.
    """
    figure = new_figure(remarks, 2.6 + 0.7 * len(table))
    axes = figure.subplots()
    lines = -np.arange(len(table), dtype=float)
    drawn = {"fmt": "D", "color": OTHER_COLOUR, "markerfacecolor": "white", "capsize": 5}
    label = "predicted, with the interval of one run (95 %)"
    axes.errorbar(table["predicted_mm3_per_m"], lines, xerr=interval_reach(table), label=label, **drawn)
    for surface, column in (("convex", "simulated_mm3_per_m"), (PLAIN, "plain_mm3_per_m")):
        marks = {"color": colour(surface), "markersize": 8, "linestyle": "", "label": f"simulated, {surface}"}
        axes.plot(table[column], lines, MARKERS[surface], zorder=3, **marks)
    for place, inside, ratio in zip(lines, table["inside"], table["over_predicted"], strict=True):
        words = f"{'inside' if inside else 'outside'}, {ratio:.2f} of the prediction"
        axes.text(1.0, place + 0.18, words, transform=axes.get_yaxis_transform(), ha="right", fontsize=SMALLEST_FONT)
    largest = float(table.filter(like="mm3_per_m").max(axis=None))
    unit, ticks = scaled("mm³/m", largest)
    axes.set_xlim(0.0, ROOM * largest)
    axes.xaxis.set_major_formatter(ticks)
    axes.set_xlabel(f"Wear per length of travel ({unit})")
    axes.set_yticks(lines, table["row"])
    axes.set_ylim(lines[-1] - 0.5, 0.5)
    axes.set_ylabel("Best design for")
    figure.legend(loc="outside upper center", ncols=3)
    return figure
