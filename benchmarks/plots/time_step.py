"""Where a pin in its groove begins to swing by itself: noise of its force and its work against the time step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import BLUE, ORANGE, OTHER_COLOUR, SMALLEST_FONT, new_figure

PANELS = {  # what is drawn and on which scale
    "force_deviation_over_load": ("Standard deviation of the vertical force, over the load (-)", "log"),
    "work_over_FL": ("Sliding work over F L (-)", "linear"),
}
SHADES = (OTHER_COLOUR, ORANGE, BLUE)  # of the grooves, shallowest first
LINES = ("-", "--")  # of the restitutions
MARKERS = ("o", "s")
ABOVE, APART = 1.3, 1.12  # -, of the largest value drawn: where pins that were thrown out are marked, and series apart


def time_step_limit(rides: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw both measures of PANELS against the time step over the closed form's limit.

    rides: a row per groove, restitution and time step: `groove`, `restitution`, `contacts`, `time_step_over_limit` and
        the columns of PANELS, NaN where the pin was thrown out
    """
    figure = new_figure(remarks, 4.4)
    for axes, (column, (title, scale)) in zip(figure.subplots(1, len(PANELS)), PANELS.items(), strict=True):
        top = ABOVE * rides[column].max()
        for (name, groove), shade in zip(rides.groupby("groove", sort=False), SHADES, strict=False):
            for (restitution, line), style, marker in zip(groove.groupby("restitution"), LINES, MARKERS, strict=False):
                legend = f"{name}: {line['contacts'].iloc[0]:.0f} contacts, restitution {restitution:g}"
                look = {"color": shade, "linestyle": style, "marker": marker, "markersize": 4.0}
                axes.plot(line["time_step_over_limit"], line[column], label=legend, **look)
                thrown = line.loc[line[column].isna(), "time_step_over_limit"]
                axes.plot(thrown, np.full(len(thrown), top), linestyle="none", marker="x", color=shade)
                top *= APART if thrown.size else 1.0
        axes.axvline(1.0, color="black", linewidth=0.8)
        axes.set(yscale=scale, xlabel="Time step over the stable one (-)")
        axes.set_title(title, loc="left", fontsize=SMALLEST_FONT)
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure
