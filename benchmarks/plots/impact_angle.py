"""How wear laws depend on the angle of impact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import SERIES_COLOURS, new_figure


def angle_curves(curves: pd.DataFrame, largest: Mapping[str, float], remarks: Sequence[str]) -> Figure:
    """Draw the volume of an impact over the largest one against the angle, with the angle of the largest marked.

    curves: angle_deg and a column per law; largest: {law: angle of its largest wear, degrees}
    """
    figure = new_figure(remarks, 3.8)
    axes = figure.subplots()
    for (law, angle), shade in zip(largest.items(), SERIES_COLOURS, strict=False):
        axes.plot(curves["angle_deg"], curves[law], color=shade, label=f"{law}, {angle:.0f}°")
        axes.plot([angle], [1.0], "o", color=shade, markersize=5, clip_on=False)
    axes.set(xlabel="Angle between path and wall (°)", ylabel="Volume of an impact over the largest (-)")
    axes.set(xlim=(0.0, 90.0), ylim=(0.0, 1.0), xticks=np.arange(0, 91, 15))
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper left", ncols=len(largest))
    return figure
