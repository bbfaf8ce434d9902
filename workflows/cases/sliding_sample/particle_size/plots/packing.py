"""Packings: contacts per particle and porosity by layer of a container, and of a bed ahead of a sample and behind."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from postproc.plots.style import LARGEST_HEIGHT, OTHER_COLOUR, SMALLEST_FONT, new_figure

STATES = {"loose": "loose", "dense": "shaken", "difference": "shaken minus loose"}
QUANTITIES = {"coordination_number": "Contacts of a particle (-)", "porosity": "Porosity (-)"}
WHOLE = "porosity_whole_particles"
BED_STATES = {"before": ("#0072B2", "o"), "after": ("#D55E00", "s")}
BED_NAMES = {"before": "ahead of the sample", "after": "behind it"}
MARKS = {"above": "^", "below": "v", "about": "D"}
RANGE_COLOUR = "#e5e5e5"
MARKERS = "osD^v<>P"


def scale_colours(scales: Sequence[float]) -> dict[float, tuple]:
    """Return a colour for every particle scale, from dark (small) to light; also told apart by their markers."""
    shades = mpl.colormaps["viridis"]
    return {scale: shades(0.85 * k / max(len(scales) - 1, 1)) for k, scale in enumerate(sorted(scales))}


def packing_profiles(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw coordination number and porosity against height (mm): loose, shaken, and their difference, by scale.

    table: as from `analysis.packing.loose_and_dense`, with particle_scale and height_mm
    published: state, quantity, relation (above, below), value and source, drawn as grey ranges
    """
    scales = sorted(set(table["particle_scale"]))
    colours = scale_colours(scales)
    figure = new_figure(remarks, LARGEST_HEIGHT)
    grid = figure.subplots(len(QUANTITIES), len(STATES), sharey=True)
    for row, (quantity, label) in zip(grid, QUANTITIES.items(), strict=True):
        for axes, (state, name) in zip(row, STATES.items(), strict=True):
            shown = published[(published["state"] == state) & (published["quantity"] == quantity)]
            _range(axes, shown)
            for k, scale in enumerate(scales):
                one = table[(table["state"] == state) & (table["particle_scale"] == scale)]
                drawn = {"color": colours[scale], "marker": MARKERS[k % len(MARKERS)], "markersize": 4}
                axes.plot(one[quantity], one["height_mm"], linewidth=1.0, label=f"scale {scale:g}", **drawn)
                if quantity == "porosity":
                    axes.plot(one[WHOLE], one["height_mm"], ":", color=colours[scale], linewidth=0.8, label="_whole")
            axes.set_xlabel(label)
            axes.set_title(name, loc="left", fontsize=SMALLEST_FONT, pad=2)
        row[0].set_ylabel("Height (mm)")
        row[0].set_ylim(bottom=0.0)
    handles = grid[0, 0].get_legend_handles_labels()[0]
    handles.append(Line2D([], [], color="black", linestyle=":", label="particles whole"))
    if not published.empty:
        source = published["source"].iloc[0].partition(",")[0]
        handles.append(Line2D([], [], color=RANGE_COLOUR, linewidth=8, label=source))
    figure.legend(handles=handles, loc="outside upper center", ncols=min(len(handles), 6))
    return figure


def _range(axes: Axes, published: pd.DataFrame) -> None:
    """Shade what is published: the range between its bounds, if it has both."""
    bounds = published.set_index("relation")["value"]
    if {"above", "below"} <= set(bounds.index):
        axes.axvspan(bounds["above"], bounds["below"], color=RANGE_COLOUR, zorder=0)


def bed_packing(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw coordination number and porosity of a bed against particle scale, ahead of a sample and behind it.

    table: particle_scale, state (before, after), coordination_number, porosity and porosity_whole_particles
    published: state, scale_from, scale_to, quantity, relation, value and source; drawn as bounds with a direction
    """
    figure = new_figure(remarks)
    panels = figure.subplots(1, len(QUANTITIES))
    for axes, (quantity, label) in zip(panels, QUANTITIES.items(), strict=True):
        for state, (shade, marker) in BED_STATES.items():
            one = table[table["state"] == state].sort_values("particle_scale")
            drawn = {"color": shade, "label": BED_NAMES[state]}
            axes.plot(one["particle_scale"], one[quantity], marker=marker, markersize=5, **drawn)
            if quantity == "porosity":
                axes.plot(one["particle_scale"], one[WHOLE], ":", color=shade, label="_whole")
        for _, bound in published[published["quantity"] == quantity].iterrows():
            shade = BED_STATES[bound["state"]][0]
            drawn = {
                "marker": MARKS[bound["relation"]],
                "linestyle": "-",
                "markerfacecolor": "white",
                "label": "_bound",
            }
            ends = [bound["scale_from"], bound["scale_to"]]
            axes.plot(ends, [bound["value"]] * 2, color=shade, linewidth=0.8, markersize=7, **drawn)
        axes.set(xlabel="Particle scale (-)", ylabel=label)
    handles = panels[0].get_legend_handles_labels()[0]
    handles.append(Line2D([], [], color="black", linestyle=":", label="particles whole"))
    if not published.empty:
        source = published["source"].iloc[0].partition(",")[0]
        for relation in dict.fromkeys(published["relation"]):
            drawn = {"marker": MARKS[relation], "markerfacecolor": "white", "color": OTHER_COLOUR, "linewidth": 0.8}
            handles.append(Line2D([], [], label=f"{source}: {relation}", **drawn))
    figure.legend(handles=handles, loc="outside upper center", ncols=min(len(handles), 5))
    return figure
