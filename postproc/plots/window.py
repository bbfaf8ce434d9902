"""A window that travels with the sample beside a bed as long as the travel: wear along the travel, mean and cost."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.figure import Figure

from postproc.plots.style import COLOURS, OTHER_COLOUR, SMALLEST_FONT, new_figure

SHADES = ("black", COLOURS["plain"], COLOURS["convex"], OTHER_COLOUR)  # of the beds, the full one first
MILLIMETRES = 1000.0
ROOM = 1.2  # -, of the panels over the largest mean


def wear_side_by_side(work: pd.DataFrame, table: pd.DataFrame, block: float, remarks: Sequence[str]) -> Figure:
    """Draw the sliding work per metre of each block of travel, and mean with standard error against what it costs.

    work: columns surface, bed, block (1, 2, ...), sliding_work_J; block: m, its length
    table: a row per surface and bed: sliding_work_J_per_m, standard_error_J_per_m and cheaper_in_particle_steps, which
        is 1 for the full bed
    """
    surfaces = list(dict.fromkeys(table["surface"]))
    figure = new_figure(remarks, 2.0 + 2.4 * len(surfaces))
    panels = figure.subplots(len(surfaces), 2, squeeze=False, width_ratios=(2, 1), sharey="row")
    for (along, means), surface in zip(panels, surfaces, strict=True):
        rows = table[table["surface"] == surface]
        for (_, row), shade in zip(rows.iterrows(), SHADES, strict=False):
            one = work[(work["surface"] == surface) & (work["bed"] == row["bed"])]
            travel = MILLIMETRES * block * (one["block"] - 0.5)
            along.plot(travel, one["sliding_work_J"] / block, color=shade, marker="o", markersize=3.0, label=row["bed"])
            means.errorbar(
                row["cheaper_in_particle_steps"],
                row["sliding_work_J_per_m"],
                row["standard_error_J_per_m"],
                color=shade,
                marker="o",
                capsize=3.0,
            )
        along.set(ylim=(0.0, ROOM * rows["sliding_work_J_per_m"].max()), xlabel="Travel after the run-in (mm)")
        along.set_title(f"Sliding work on the {surface} sample (J/m)", loc="left", fontsize=SMALLEST_FONT)
        means.set(xlabel="Cheaper in particle steps (-)")
        means.set_title("Mean, standard error", loc="left", fontsize=SMALLEST_FONT)
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return figure
