"""Figures of the bed's flow over samples: measures along the travel by regime, and profiles of the motion by layer."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.plots.style import LARGEST_HEIGHT, MAP, OTHER_COLOUR, SMALLEST_FONT, colour, marker, new_figure
from bulkwear.workflows.cases.sliding_sample.screening.profile_numbers import LAYER

PANELS = {  # column of a profile -> its quantity in the published table and the label of the axis
    "velocity_m_per_s": ("velocity", "Velocity with\nthe sample (m/s)"),
    "sideways_ratio": ("sideways_ratio", "Sideways velocity over\nthat with the sample (-)"),
    "upward_ratio": ("upward_ratio", "Upward velocity over\nthat with the sample (-)"),
    "averaged_angular_velocity_deg_per_s": ("averaged_angular_velocity", "Averaged angular velocity (°/s)"),
}
ANGULAR = "averaged_angular_velocity_deg_per_s"
VELOCITIES = tuple(name for name in PANELS if name != ANGULAR)
STYLES = {"central": ("-", "o"), "side": ("--", "^")}
FILLS = {"central": "white", "side": "#c9c9c9"}  # of published marks
PUBLISHED_MARKS = {"about": "D", "below": "<", "above": ">"}
STRONG, FAINT = 1.4, 0.8  # pt, curves of patterned and of plain samples
END_ROOM = 0.1  # -, of the travel, for the names at the ends of curves
HEIGHT_ROOM = 0.1  # -, of a profile's height, above its highest mark
SMOOTHED_SHARE = 0.1  # -, of the travel, over which curves that scatter are averaged
LIGHTEST = 0.85  # -, of the map, of a curve on white
FEW_VALUES = 6  # up to which a curve shows each of its values as a mark
LEADER = 0.02  # -, of the axis, from the end of a curve to its name
LEAST_STEP = 0.045  # -, of the axis, between two names


def along_travel(
    table: pd.DataFrame,
    column: str,
    label: str,
    window: tuple[float, float] | None,
    remarks: Sequence[str],
    published: pd.DataFrame | None = None,
    smoothed: bool = False,
) -> Figure:
    """Draw a measure of every run against travel (mm), a panel per regime; patterned runs strong, each row in a colour,
    plain ones faint.

    table: run, row, surface, regime, travel_mm and the column; label: of the measure's axis, with its unit
    window: steady window of the source (mm), shaded as far as the travel reaches; None to leave it out
    published: `of` (the regime), value and source of what is published of the measure, drawn as lines; None without
    smoothed: draw means over a SMOOTHED_SHARE of the travel, which tell curves apart that scatter
    """
    regimes = list(dict.fromkeys(table["regime"]))
    table = _smooth(table, column) if smoothed else table
    colours = _row_colours(table)
    figure = new_figure(remarks, LARGEST_HEIGHT)
    panels = figure.subplots(1, len(regimes), sharex=True, sharey=True, squeeze=False)[0]
    end = float(table["travel_mm"].max())
    for axes, regime in zip(panels, regimes, strict=True):
        shown = table[table["regime"] == regime]
        for run, curve in shown.groupby("run", sort=False):
            surface = curve["surface"].iloc[0]
            shade = colours.get(curve["row"].iloc[0], OTHER_COLOUR) if surface != PLAIN else colour(surface)
            drawn = {"color": shade, "linewidth": FAINT if surface == PLAIN else STRONG, "label": run}
            drawn |= {"marker": marker(surface), "markersize": 3.0} if len(curve) <= FEW_VALUES else {}
            axes.plot(curve["travel_mm"], curve[column], "--" if surface == PLAIN else "-", **drawn)
        for value in [] if published is None else published.loc[published["of"] == regime, "value"]:
            axes.axhline(value, color="black", linestyle=":", linewidth=STRONG)
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
    several = len(colours) > 1
    handles = [
        Line2D([], [], color=colour(name), linestyle="--", label=name)
        if name == PLAIN
        else Line2D([], [], color=OTHER_COLOUR if several else colour(name), label=name)
        for name in surfaces
    ]
    if published is not None and published["of"].isin(regimes).any():
        handles.append(Line2D([], [], color="black", linestyle=":", label=published["source"].iloc[0]))
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))
    return figure


def _row_colours(table: pd.DataFrame) -> dict[str, object]:
    """Return the colour of the patterned run of each row: that of its surface where there is one row."""
    patterned = table[table["surface"] != PLAIN]
    rows = list(dict.fromkeys(patterned["row"]))
    if len(rows) == 1:
        return {rows[0]: colour(patterned["surface"].iloc[0])}
    return dict(zip(rows, colormaps[MAP](np.linspace(0.0, LIGHTEST, len(rows))), strict=True))


def _smooth(table: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return a table with means of a column over a SMOOTHED_SHARE of each run's rows."""
    means = table.groupby("run", sort=False)[column].transform(
        lambda values: values.rolling(max(round(SMOOTHED_SHARE * len(values)), 1), center=True, min_periods=1).mean()
    )
    return table.assign(**{column: means})


def _name_ends(axes: Axes, table: pd.DataFrame, column: str) -> None:
    """Write the rows' names at the ends of their curves, moved apart where they would overlap."""
    ends = table.groupby("row", sort=False)[["travel_mm", column]].last().dropna().sort_values(column)
    low, high = axes.get_ylim()
    away = LEADER * float(np.ptp(axes.get_xlim()))
    places = _apart(ends[column].to_numpy(), LEAST_STEP * (high - low), high)
    for (row, (travel, value)), place in zip(ends.iterrows(), places, strict=True):
        line = {"color": "#888888", "linewidth": 0.5, "label": "_leader", "clip_on": False}
        axes.plot([travel, travel + away], [value, place], **line)
        axes.text(travel + away, place, f" {row}", fontsize=SMALLEST_FONT, va="center", clip_on=False)


def _apart(values: np.ndarray, step: float, highest: float) -> np.ndarray:
    """Return places for names of rising values, at least a step apart and none above the highest, near their values."""
    count = np.arange(len(values))
    places = step * count + np.maximum.accumulate(values - step * count)  # up, until each is a step above the last
    return np.minimum(places, highest - step * count[::-1])


def velocity_profiles(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw velocity with the sample, sideways and upward ratio against height (mm), a line of panels per design row.

    table: as from `flow_history.row_profiles`, in display units
    published: row, surface, zone, layer (of 5 mm), quantity, relation, value and source; may be empty
    """
    rows = list(dict.fromkeys(table["row"]))
    figure = new_figure(remarks, LARGEST_HEIGHT)
    grid = figure.subplots(len(rows), len(VELOCITIES), sharey="row", squeeze=False)
    for panels, row in zip(grid, rows, strict=True):
        for axes, column in zip(panels, VELOCITIES, strict=True):
            _profile(axes, column, table[table["row"] == row], published[published["row"] == row])
            axes.set_title(row, loc="left", fontsize=SMALLEST_FONT, pad=2)
        panels[0].set_ylabel("Height (mm)")
        panels[0].set_ylim(bottom=0.0)
    for axes, column in zip(grid[-1], VELOCITIES, strict=True):
        axes.set_xlabel(PANELS[column][1])
    _profile_legend(figure, table, published, VELOCITIES)
    return figure


def angular_velocity_profiles(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the magnitude of the averaged angular velocity (degrees per second) against height (mm), a panel per row.

    Arguments as above.
    """
    rows = list(dict.fromkeys(table["row"]))
    figure = new_figure(remarks)
    panels = figure.subplots(1, len(rows), squeeze=False)[0]
    for axes, row in zip(panels, rows, strict=True):
        _profile(axes, ANGULAR, table[table["row"] == row], published[published["row"] == row])
        axes.set_title(row, loc="left", fontsize=SMALLEST_FONT)
        axes.set_xlabel(PANELS[ANGULAR][1])
        axes.set_ylim(bottom=0.0)
    panels[0].set_ylabel("Height (mm)")
    _profile_legend(figure, table, published, (ANGULAR,))
    return figure


def _profile(axes: Axes, column: str, table: pd.DataFrame, published: pd.DataFrame) -> None:
    """Draw a quantity of one design row over its height, and what is published of it."""
    for (surface, zone), curve in table.groupby(["surface", "zone"], sort=False):
        if zone in STYLES:
            line, mark = STYLES[zone]
            drawn = {"color": colour(surface), "markersize": 4, "label": f"{surface} {zone}"}
            axes.plot(curve[column], curve["height_mm"], line, marker=mark, **drawn)
    for _, point in published[published["quantity"] == PANELS[column][0]].iterrows():
        height = (point["layer"] - 0.5) * LAYER
        drawn = {"color": colour(point["surface"]), "markerfacecolor": FILLS[point["zone"]], "markersize": 8}
        axes.plot(point["value"], height, PUBLISHED_MARKS[point["relation"]], zorder=3, clip_on=False, **drawn)
    axes.margins(y=HEIGHT_ROOM)
    axes.axvline(0.0, color="#888888", linewidth=0.6)


def _profile_legend(figure: Figure, table: pd.DataFrame, published: pd.DataFrame, columns: Sequence[str]) -> None:
    shown = published["row"].isin(table["row"]) & published["quantity"].isin([PANELS[name][0] for name in columns])
    published = published[shown]
    handles = [Line2D([], [], color=colour(name), label=name) for name in dict.fromkeys(table["surface"])]
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
