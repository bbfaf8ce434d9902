"""The height of a mill's lifters against hours of operation."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from bulkwear.postproc.plots.style import SMALLEST_FONT, facets, label_all, new_figure
from bulkwear.workflows.cases.equipment.plots.curves import setting_colour

FIGURE_HEIGHT = 3.4  # inches
NONE_FOUND = "No part that turns has lifters."


def lifter_heights(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the height (mm) of the lifters of each part with its 95 % interval, one panel per part.

    table: setting, part, operation_h, height_mm, height_mm_low, height_mm_high (NaN where the scatter is unknown)
    """
    figure = new_figure(remarks, FIGURE_HEIGHT)
    parts, settings = (list(dict.fromkeys(table[name])) for name in ("part", "setting"))
    for part, axes in facets(figure, parts or [NONE_FOUND]).items():
        for setting in settings:
            rows = table[(table["part"] == part) & (table["setting"] == setting)]
            low, high = rows["height_mm"] - rows["height_mm_low"], rows["height_mm_high"] - rows["height_mm"]
            look = {"color": setting_colour(settings, setting), "capsize": 2.5, "markersize": 3.5, "linewidth": 1.4}
            axes.errorbar(rows["operation_h"], rows["height_mm"], yerr=[low, high], fmt="o-", label=setting, **look)
        if len(parts) != 1:
            axes.set_title(part.replace("_", " "), loc="left", fontsize=SMALLEST_FONT)
        axes.set_ylim(bottom=0.0)
        axes.xaxis.set_major_locator(MaxNLocator(6))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.6g}"))
    label_all(figure, len(parts) > 1, "Operation (h)", "Height of the lifters (mm)")
    if len(settings) > 1:
        handles, labels = figure.axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=min(len(settings), 4))
    return figure
