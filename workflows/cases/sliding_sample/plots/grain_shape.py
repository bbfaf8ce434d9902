"""Wear against the rolling friction of spheres, with the level of clumps."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import new_figure
from bulkwear.workflows.cases.sliding_sample.grain_shape import FACTOR, SHAPE
from bulkwear.workflows.cases.sliding_sample.plots.bars import draw_intervals
from bulkwear.workflows.config.clumps import ROUND

SPHERES = "#0072B2"
CLUMPS = ("#D55E00", "#009E73", "#CC79A7", "#E69F00")
DASHES = ("--", "-.", ":", (0, (5, 1)))
PER_METRE, RATIO = "Wear per metre (mm³/m)", "Wear over plain (-)"


def wear_by_grain_shape(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw each measure of spheres against their rolling friction over that of the materials, of clumps as a level.

    table: as from `grain_shape.shape_table`
    """
    figure = new_figure(remarks, 4.2)
    measures = list(dict.fromkeys(table["measure"]))
    panels = figure.subplots(1, len(measures), squeeze=False)[0]
    for axes, measure in zip(panels, measures, strict=True):
        rows = table[table["measure"] == measure]
        spheres = rows[rows[SHAPE] == ROUND].sort_values(FACTOR)
        axes.plot(spheres[FACTOR], spheres["value"], "o-", color=SPHERES, label="spheres")
        draw_intervals(axes, spheres[FACTOR].to_numpy(), spheres["value"], spheres, SPHERES)
        clumps = rows[rows[SHAPE] != ROUND]
        for index, (_, row) in enumerate(clumps.iterrows()):
            look = {"color": CLUMPS[index % len(CLUMPS)], "linestyle": DASHES[index % len(DASHES)]}
            axes.axhline(row["value"], label=row["setting"], **look)
            axes.axhspan(row["interval_low"], row["interval_high"], color=look["color"], alpha=0.15, linewidth=0)
        axes.set(title=measure, xlabel="Rolling friction factor (-)", ylabel=RATIO if "over" in measure else PER_METRE)
        axes.set_ylim(bottom=0.0)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return figure
