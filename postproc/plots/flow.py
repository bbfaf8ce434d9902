"""Figures of the bed's flow over samples: measures along the travel by regime, and profiles of the motion by layer."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from postproc.analysis.comparison import PLAIN
from postproc.plots.style import LARGEST_HEIGHT, SMALLEST_FONT, colour, new_figure

LAYER = 5.0  # mm, of the published profiles, whose particles have their real size
PANELS = {  # column of a profile -> its quantity in the published table and the label of the axis
    "velocity_m_per_s": ("velocity", "Velocity with the sample (m/s)"),
    "sideways_ratio": ("sideways_ratio", "Sideways velocity\nover that with the sample (-)"),
    "upward_ratio": ("upward_ratio", "Upward velocity\nover that with the sample (-)"),
    "angular_speed_deg_per_s": ("angular_speed", "Angular speed (°/s)"),
}
STYLES = {"central": ("-", "o"), "side": ("--", "^")}
FILLS = {"central": "white", "side": "#c9c9c9"}  # of published marks
PUBLISHED_MARKS = {"about": "D", "below": "<", "above": ">"}
STRONG, FAINT = 1.4, 0.8  # pt, curves of convex and of plain samples
END_ROOM = 0.08  # -, of the travel, for the names at the ends of curves
LEAST_STEP = 0.045  # -, of the axis, between two names


def along_travel(
    table: pd.DataFrame, column: str, label: str, window: tuple[float, float] | None, remarks: Sequence[str]
) -> Figure:
    """Draw a measure of every run against travel (mm), a panel per regime; convex runs strong, plain ones faint.

    table: run, row, surface, regime, travel_mm and the column; label: of the measure's axis, with its unit
    window: steady window of the source (mm), shaded as far as the travel reaches; None to leave it out
    """
    regimes = list(dict.fromkeys(table["regime"]))
    figure = new_figure(remarks, LARGEST_HEIGHT)
    panels = figure.subplots(1, len(regimes), sharex=True, sharey=True, squeeze=False)[0]
    end = float(table["travel_mm"].max())
    for axes, regime in zip(panels, regimes, strict=True):
        shown = table[table["regime"] == regime]
        for run, curve in shown.groupby("run", sort=False):
            surface = curve["surface"].iloc[0]
            drawn = {"color": colour(surface), "linewidth": FAINT if surface == PLAIN else STRONG, "label": run}
            axes.plot(curve["travel_mm"], curve[column], "--" if surface == PLAIN else "-", **drawn)
        if window is not None and window[0] < end:
            axes.axvspan(window[0], min(window[1], end), color="#eeeeee", zorder=0)
        axes.set_title(regime, loc="left", fontsize=SMALLEST_FONT)
        axes.set_xlabel("Travel (mm)")
        axes.set_xlim(0.0, (1.0 + END_ROOM * len(regimes)) * end)
    panels[0].set_ylabel(label)
    panels[0].set_ylim(bottom=min(0.0, float(table[column].min())))
    for axes, regime in zip(panels, regimes, strict=True):
        _name_ends(axes, table[(table["regime"] == regime) & (table["surface"] != PLAIN)], column)
    surfaces = list(dict.fromkeys(table["surface"]))
    handles = [
        Line2D([], [], color=colour(name), linestyle="--" if name == PLAIN else "-", label=name) for name in surfaces
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))
    return figure


def _name_ends(axes: Axes, table: pd.DataFrame, column: str) -> None:
    """Write the rows' names at the ends of their curves, moved apart where they would overlap."""
    ends = table.groupby("row", sort=False)[["travel_mm", column]].last().dropna().sort_values(column)
    low, high = axes.get_ylim()
    place = -np.inf
    for row, (travel, value) in ends.iterrows():
        place = max(value, place + LEAST_STEP * (high - low))
        axes.text(travel, place, f" {row}", fontsize=SMALLEST_FONT, va="center", clip_on=False)


def profiles(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw profiles of the motion over and beside samples against height (mm): velocities, ratios, angular speed.

    table: surface, zone (central and side), height_mm and the columns of PANELS, of one design row
    published: surface, zone, layer (of 5 mm), quantity, relation, value and source of the same row; may be empty
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    panels = figure.subplots(2, 2, sharey=True).ravel()
    for axes, (column, (quantity, label)) in zip(panels, PANELS.items(), strict=True):
        for (surface, zone), curve in table.groupby(["surface", "zone"], sort=False):
            if zone in STYLES:
                line, mark = STYLES[zone]
                drawn = {"color": colour(surface), "markersize": 4, "label": f"{surface} {zone}"}
                axes.plot(curve[column], curve["height_mm"], line, marker=mark, **drawn)
        for _, point in published[published["quantity"] == quantity].iterrows():
            height = (point["layer"] - 0.5) * LAYER
            drawn = {"color": colour(point["surface"]), "markerfacecolor": FILLS[point["zone"]], "markersize": 8}
            axes.plot(point["value"], height, PUBLISHED_MARKS[point["relation"]], zorder=3, **drawn)
        axes.set_xlabel(label)
        axes.axvline(0.0, color="#888888", linewidth=0.6)
    for axes in panels[::2]:
        axes.set_ylabel("Height above\nthe floor (mm)")
    panels[0].set_ylim(bottom=0.0)
    _profile_legend(figure, list(dict.fromkeys(table["surface"])), published)
    return figure


def _profile_legend(figure: Figure, surfaces: Sequence[str], published: pd.DataFrame) -> None:
    handles = [Line2D([], [], color=colour(name), label=name) for name in surfaces]
    names = {"central": "over the sample", "side": "beside it"}
    for zone, (line, mark) in STYLES.items():
        handles.append(Line2D([], [], color="black", linestyle=line, marker=mark, markersize=4, label=names[zone]))
    meaning = {"about": "", "below": " (at most)", "above": " (at least)"}
    source = "" if published.empty else published["source"].iloc[0].partition(",")[0]
    for relation in (relation for relation in meaning if (published["relation"] == relation).any()):
        drawn = {"marker": PUBLISHED_MARKS[relation], "linestyle": "", "color": "black", "markerfacecolor": "white"}
        handles.append(Line2D([], [], label=f"{source}{meaning[relation]}", **drawn))
    if (published["zone"] == "side").any():
        drawn = {"marker": "s", "linestyle": "", "color": "black", "markerfacecolor": FILLS["side"]}
        handles.append(Line2D([], [], label=f"grey: {source}, beside it", **drawn))
    figure.legend(handles=handles, loc="outside upper center", ncols=min(len(handles), 4))
