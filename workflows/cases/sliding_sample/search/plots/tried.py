"""Drawings of a search: its record, and the surrogate about the best pattern."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import OTHER_COLOUR, PATTERN_COLOUR, PUBLISHED, facet_columns, new_figure
from bulkwear.workflows.report.text import name_and_unit

OVER_PLAIN = "Wear over plain (-)"
LIKELY = 0.5  # -, chance of enough being left, below which a prediction is dotted
BAND, HEIGHT, HEIGHT_OF_SLICES = 0.25, 4.2, 5.0
REACH = {"fmt": "none", "elinewidth": 0.9, "capsize": 3}


def record(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw wear over plain of each pattern as simulated and as predicted; table: `search.record.record_table`."""
    figure = new_figure(remarks, HEIGHT)
    axes = figure.subplots()
    places = np.arange(len(table), dtype=float)
    told = table["predicted"].notna().to_numpy()
    middle = table["predicted"].to_numpy(float)
    reach = np.abs(table[["predicted_low", "predicted_high"]].to_numpy(float).T - middle)
    if told.any():
        look = {"color": OTHER_COLOUR, "marker": "_", "linestyle": "none", "elinewidth": 4.0, "alpha": 0.5}
        axes.errorbar(places[told] - 0.2, middle[told], reach[:, told], label="predicted before", **look)
    simulated = table["wear_over_plain"].to_numpy(float)
    ends = np.abs(table[["interval_low", "interval_high"]].to_numpy(float).T - simulated)
    known = np.isfinite(ends).all(axis=0)
    if known.any():
        axes.errorbar(places[known], simulated[known], ends[:, known], ecolor=PATTERN_COLOUR, **REACH)
    enough = (table["enough_left"] == "yes").to_numpy()
    for which, face, label in ((enough, PATTERN_COLOUR, "simulated"), (~enough, "white", "too little left")):
        if which.any():
            look = {"marker": "o", "linestyle": "none", "color": PATTERN_COLOUR, "markerfacecolor": face}
            axes.plot(places[which], simulated[which], label=label, **look)
    axes.axhline(1.0, label="plain", **PUBLISHED)
    axes.set_ylim(0.0, 1.1 * max(1.0, simulated.max()))
    axes.set_xticks(places, table["setting"], rotation=90)
    axes.set_xlabel("Pattern")
    axes.set_ylabel(OVER_PLAIN)
    axes.grid(axis="x", visible=False)
    figure.legend(loc="outside upper center", ncols=4)
    return figure


def slices(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw predicted wear over plain along each factor; table: as from `search.results.slices`."""
    figure = new_figure(remarks, HEIGHT_OF_SLICES)
    names = list(dict.fromkeys(table["factor"]))
    columns = facet_columns(len(names))
    grid = figure.subplots(-(-len(names) // columns), columns, sharey=True, squeeze=False)
    for spare in grid.ravel()[len(names) :]:
        spare.remove()
    for name, axes in zip(names, grid.ravel(), strict=False):
        own = table[table["factor"] == name]
        axes.fill_between(own["value"], own["predicted_low"], own["predicted_high"], color=PATTERN_COLOUR, alpha=BAND)
        likely = own["chance_enough_left"] >= LIKELY
        axes.plot(own["value"], own["predicted"].where(likely), color=PATTERN_COLOUR)
        axes.plot(own["value"], own["predicted"], color=PATTERN_COLOUR, linestyle=":")
        axes.axvline(own["best"].iloc[0], color=OTHER_COLOUR, linewidth=0.9)
        axes.set_xlabel("{} ({})".format(*name_and_unit(name)).capitalize())
    for axes in grid[:, 0]:
        axes.set_ylabel(OVER_PLAIN)
    return figure
