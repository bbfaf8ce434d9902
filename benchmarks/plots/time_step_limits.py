"""The figure of `benchmarks.time_step_limits`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import OTHER_COLOUR, SERIES_COLOURS, SMALLEST_FONT, new_figure

HEIGHT = 5.6  # inches
APART = 0.012  # -, time steps over Rayleigh time by which models are drawn beside one another
PERCENT = 100.0
MARKERS = ("o", "s", "^", "D")


def changes_by_model(
    found: Mapping[tuple[str, str, str], pd.DataFrame],
    names: Mapping[str, str],
    limit: float,
    remarks: Sequence[str],
) -> Figure:
    """Draw the change (%) over the time step, a panel per surface and response, a line per model, the limit in grey.

    found: by model, surface and response value (-), change, change_low and change_high (-); names: of the responses;
    limit: -
    """
    figure = new_figure(remarks, HEIGHT)
    models, surfaces = (list(dict.fromkeys(key[place] for key in found)) for place in (0, 1))
    panels = figure.subplots(len(names), len(surfaces), sharex=True, sharey="row", squeeze=False)
    for row, (response, name) in zip(panels, names.items(), strict=True):
        for axes, surface in zip(row, surfaces, strict=True):
            axes.axhspan(-PERCENT * limit, PERCENT * limit, color=OTHER_COLOUR, alpha=0.15, linewidth=0.0)
            for place, model in enumerate(models):
                of = found.get((model, surface, response))
                if of is None:
                    continue
                change, low, high = (PERCENT * of[key].to_numpy() for key in ("change", "change_low", "change_high"))
                reach = np.nan_to_num([change - low, high - change])
                look = {"color": SERIES_COLOURS[place], "marker": MARKERS[place], "markersize": 4.0, "capsize": 2.0}
                axes.errorbar(of["value"] + APART * place, change, reach, label=model, **look)
            axes.set_title(f"{surface} sample, {name}", loc="left", fontsize=SMALLEST_FONT)
        row[0].set_ylabel("Change (%)")
    for axes in panels[-1]:
        axes.set_xlabel("Time step over Rayleigh time (-)")
    figure.legend(*panels[0][0].get_legend_handles_labels(), loc="outside upper center", ncols=len(models))
    return figure
