"""A window that travels with the sample beside a bed as long as the travel: wear along the travel, mean and cost."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.figure import Figure

from postproc.plots.style import BLUE, ORANGE, OTHER_COLOUR, SMALLEST_FONT, new_figure

SHADES = ("black", ORANGE, BLUE, "#009E73", OTHER_COLOUR)  # of the beds, the full one first
MILLIMETRES = 1000.0
ROOM = 1.2  # -, of the panels over the largest mean
NARROW = 0.15  # -, of the panel of ratios below and above 1, at least
PACKING_LINE = {"linewidth": 0.6, "alpha": 0.45}  # of a single packing


def wear_side_by_side(work: pd.DataFrame, table: pd.DataFrame, block: float, remarks: Sequence[str]) -> Figure:
    """Draw the sliding work per metre of each block of travel, thin for packings and thick for their mean, and wear
    over the full bed's with its interval against what it costs.

    work: columns surface, bed, seed, block (1, 2, ...), sliding_work_J; block: m, its length
    table: a row per surface and bed: wear_over_full, ratio_low, ratio_high (NaN: not known) and
        cheaper_in_particle_steps, which is 1 for the full bed
    """
    surfaces = list(dict.fromkeys(table["surface"]))
    figure = new_figure(remarks, 2.0 + 2.4 * len(surfaces))
    panels = figure.subplots(len(surfaces), 2, squeeze=False, width_ratios=(2, 1))
    for (along, ratios), surface in zip(panels, surfaces, strict=True):
        rows, here = table[table["surface"] == surface], work[work["surface"] == surface]
        for (_, row), shade in zip(rows.iterrows(), SHADES, strict=False):
            one = here[here["bed"] == row["bed"]].pivot(index="block", columns="seed", values="sliding_work_J") / block
            travel = MILLIMETRES * block * (one.index - 0.5)
            along.plot(travel, one, color=shade, **PACKING_LINE)
            along.plot(travel, one.mean(axis=1), color=shade, marker="o", markersize=3.0, label=row["bed"])
            reach = [[row["wear_over_full"] - row["ratio_low"]], [row["ratio_high"] - row["wear_over_full"]]]
            ratios.errorbar(
                row["cheaper_in_particle_steps"],
                row["wear_over_full"],
                None if row[["ratio_low", "ratio_high"]].isna().any() else reach,
                color=shade,
                marker="o",
                capsize=3.0,
            )
        along.set(ylim=(0.0, ROOM * here["sliding_work_J"].max() / block), xlabel="Travel after the run-in (mm)")
        along.set_title(f"Sliding work on the {surface} sample (J/m)", loc="left", fontsize=SMALLEST_FONT)
        furthest = max(NARROW, *(1.1 * abs(rows[name] - 1.0).max() for name in ("ratio_low", "ratio_high")))
        ratios.axhline(1.0, color=OTHER_COLOUR, linewidth=0.8)
        ratios.set(ylim=(1.0 - furthest, 1.0 + furthest), xlabel="Cheaper in particle steps (-)")
        ratios.set_title("Wear over that of the full bed (-)", loc="left", fontsize=SMALLEST_FONT)
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure
