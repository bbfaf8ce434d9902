"""Height and leading face of a mill's lifters against hours of operation."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from bulkwear.postproc.plots.style import SMALLEST_FONT, label_all, new_figure
from bulkwear.workflows.cases.equipment.plots.curves import setting_colour

FIGURE_HEIGHT = 4.6  # inches
TOP_MARGIN = 0.1  # -, of the height of a panel, so that markers and caps of intervals are clear of its end
NONE_FOUND = "No part that turns has lifters."
DRAWN = {"height_mm": "Height (mm)", "leading_face_angle_deg": "Leading face (degrees)"}


def lifter_profiles(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw height and leading face angle of the lifters of each part with their 95 % intervals, a column per part.

    table: setting, part, operation_h and the columns DRAWN, each with its ends _low and _high (NaN where the scatter is
    unknown)
    """
    figure = new_figure(remarks, FIGURE_HEIGHT)
    parts, settings = (list(dict.fromkeys(table[name])) for name in ("part", "setting"))
    grid = figure.subplots(len(DRAWN), max(len(parts), 1), sharex=True, sharey="row", squeeze=False)
    for column, part in enumerate(parts or [NONE_FOUND]):
        of_part = table[table["part"] == part]
        for axes, name in zip(grid[:, column], DRAWN, strict=True):
            for setting in settings:
                _course(axes, of_part[of_part["setting"] == setting], name, settings)
        if len(parts) != 1:
            grid[0, column].set_title(part.replace("_", " "), loc="left", fontsize=SMALLEST_FONT)
    for axes, words in zip(grid[:, 0], DRAWN.values(), strict=True):
        axes.set_ylabel(words)
        axes.margins(y=TOP_MARGIN)
        axes.set_ylim(bottom=0.0)
    label_all(figure, True, "Operation (h)", "")
    if len(settings) > 1:
        handles, labels = grid[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=min(len(settings), 4))
    return figure


def _course(axes: Axes, rows: pd.DataFrame, name: str, settings: Sequence[str]) -> None:
    """Draw a column of a setting's table against its hours."""
    ends = [rows[name] - rows[f"{name}_low"], rows[f"{name}_high"] - rows[name]]
    setting = rows["setting"].iloc[0] if len(rows) else ""
    look = {"color": setting_colour(settings, setting), "capsize": 2.5, "markersize": 3.5, "linewidth": 1.4}
    axes.errorbar(rows["operation_h"], rows[name], yerr=ends, fmt="o-", label=setting, **look)
    axes.xaxis.set_major_locator(MaxNLocator(6))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.6g}"))
