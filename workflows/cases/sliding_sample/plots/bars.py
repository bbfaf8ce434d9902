"""Bars and points per setting: split of the wear, patterned over plain, laws and forces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.plots.style import (
    BASE_COLOUR,
    LARGEST_HEIGHT,
    OTHER_COLOUR,
    PATTERN_COLOUR,
    SMALLEST_FONT,
    colour,
    marker,
    new_figure,
)
from bulkwear.postproc.tables.summary import patterned_name

BAR_WIDTH = 0.38  # -, of the space of a row with two runs
MANY = 6  # settings and surfaces; from here on their names stand upright
MOST_NUMBERS = 14  # rows that have room for numbers of three digits beside one another; of more these stand upright
MOST_CHARACTERS = 64  # of all names in one line under an axis; longer ones stand upright
MOST_ROOM = 3.0  # -, of the highest bar; what intervals have beyond it is cut off
LIFT = 4  # pt, of a number above its bar
ERROR_BARS = {"elinewidth": 0.9, "capsize": 3}
PUBLISHED_MARKS_UPRIGHT = {"about": "D", "below": "v", "above": "^"}
MEANING = {"about": "", "below": " (at most)", "above": " (at least)"}
ROOM_ABOVE = 0.05  # -, of an axis that begins at nothing, over its highest mark
HEADROOM = 1.18  # -, of the highest bar, for the numbers above it
LAW_COLOUR, FINNIE_COLOUR = "#0072B2", "#CC79A7"


def _axis(axes: Axes, table: pd.DataFrame) -> np.ndarray:
    """Return the places of a table's lines on an axis with their settings and surfaces."""
    places = np.arange(len(table), dtype=float)
    names = [f"{row.setting} {row.surface}".replace("_", " ") for row in table.itertuples()]
    upright = len(names) > MANY or sum(map(len, names)) > MOST_CHARACTERS
    axes.set_xticks(places, names, rotation=90 if upright else 0)
    axes.set_xlim(-0.6, len(names) - 0.4)
    axes.grid(axis="x", visible=False)
    return places


def highest_shown(values: Sequence[float], ends: Sequence[float]) -> float:
    """Return what an axis must reach for its bars and their intervals, no more than MOST_ROOM of the highest bar."""
    return float(min(np.nanmax([*values, *ends]), MOST_ROOM * np.nanmax(values)))


def draw_intervals(
    axes: Axes, places: np.ndarray, values: pd.Series, table: pd.DataFrame, colour: str = "black"
) -> None:
    """Draw the intervals of values, one per line of a table, where they are known."""
    ends = table[["interval_low", "interval_high"]].to_numpy(dtype=float).T
    reach = np.clip([values - ends[0], ends[1] - values], 0.0, None)
    known = np.isfinite(reach).all(axis=0)
    if known.any():
        axes.errorbar(
            np.asarray(places)[known], values[known], reach[:, known], fmt="none", ecolor=colour, **ERROR_BARS
        )


def wear_split(split: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the wear on base and pattern, stacked, over the wear of the plain twin (dashed line at 1), with intervals.

    split: as from `comparison.wear_split`. Of many lines, plain samples (1 by definition) are left out.
    """
    if len(split) > MANY and (split["surface"] != PLAIN).any():
        split = split[split["surface"] != PLAIN].reset_index(drop=True)
    figure = new_figure(remarks, 4.2)
    axes = figure.subplots()
    places = _axis(axes, split)
    width = 0.5 if len(split) <= MANY else 0.7
    base, pattern = split["base_over_plain"], split["pattern_over_plain"]
    axes.bar(places, base, width, color=BASE_COLOUR, label="base")
    drawn = {"color": PATTERN_COLOUR, "hatch": "//", "edgecolor": "white", "label": "pattern"}
    axes.bar(places, pattern, width, bottom=base, **drawn)
    patterned = split[split["surface"] != PLAIN]
    draw_intervals(axes, places[patterned.index], patterned["wear_over_plain"], patterned)
    highest = highest_shown([1.0, *split["wear_over_plain"]], split["interval_high"])
    tops = np.fmin(np.fmax(split["wear_over_plain"], split["interval_high"]), highest).to_numpy()
    for place, height, value in zip(places, tops, split["wear_over_plain"], strict=True):
        if np.isfinite(value):
            look = {"rotation": 90 if len(split) > MANY else 0, "bbox": {"color": "white", "pad": 0.5}}
            above = {"xytext": (0, LIFT), "textcoords": "offset points", "ha": "center", "va": "bottom"}
            axes.annotate(f"{value:.2f}", (place, height), fontsize=SMALLEST_FONT, **above, **look)
    axes.axhline(1.0, color="black", linewidth=0.8, linestyle="--")
    axes.set_ylim(0.0, HEADROOM * highest)
    axes.set_ylabel("Wear volume over the plain sample's (-)")
    figure.legend(loc="outside upper center", ncols=2)
    return figure


def relative_wear(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw wear over plain per setting, lowest first, with its interval, and alpha_ER written in.

    table: as from `comparison.relative_wear_table`
    published: row (a setting), relation, value (-) and source; may be empty
    """
    figure = new_figure(remarks, 4.6)
    axes = figure.subplots()
    table = table.sort_values("wear_over_plain", kind="stable", ignore_index=True)
    ratio = table["wear_over_plain"]
    places = _axis(axes, table)
    turned = 90 if len(table) > MOST_NUMBERS else 0
    axes.set_xticks(places, table["setting"], rotation=turned)
    axes.bar(places, ratio, 0.7, color=[colour(surface) for surface in table["surface"]])
    draw_intervals(axes, places, ratio, table)
    top = HEADROOM * highest_shown([1.0, *ratio], table["interval_high"])
    shown = published[published["row"].isin(table["setting"])]
    if len(shown):
        _published_marks(axes, dict(zip(table["setting"], places, strict=True)), shown)
        figure.legend(loc="outside upper right", ncols=2)
    for place, value, size in zip(places, ratio, table["equivalent_size_ratio"], strict=True):
        axes.text(
            place,
            0.015 * top,
            f"{value:.2f}",
            ha="center",
            va="bottom",
            color="white",
            fontsize=SMALLEST_FONT,
            rotation=turned,
        )
        axes.text(place, 0.985 * top, f"{size:.2f}", ha="center", va="top", fontsize=SMALLEST_FONT, rotation=turned)
    axes.set_title(
        r"equivalent size ratio $\alpha_{ER}$ of each row in the line below", loc="left", fontsize=SMALLEST_FONT
    )
    axes.axhline(1.0, color="black", linewidth=0.8, linestyle="--")
    label = f"Wear volume, {patterned_name(table['surface'])} over plain (-)"
    axes.set(xlabel="Design row", ylabel=label, ylim=(0.0, top))
    return figure


def _published_marks(axes: Axes, places: Mapping[str, float], published: pd.DataFrame) -> None:
    """Draw published values and bounds at the places of their rows, each kind once in the legend."""
    for relation, points in published.groupby("relation", sort=False):
        words = f"{points['source'].iloc[0].partition(',')[0]}{MEANING[relation]}"
        across = [places[row] for row in points["row"]]
        drawn = {"color": "black", "markerfacecolor": "white", "markersize": 7, "linestyle": "", "label": words}
        axes.plot(across, points["value"], PUBLISHED_MARKS_UPRIGHT[relation], **drawn)


def wear_law_comparison(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the volume (mm3) by the study's law and by the solver's own Finnie model on a log axis, setting by setting.

    table: as from `comparison.law_comparison`; the interval at Finnie's volume is that of the ratio of the two. Volumes
    of zero are not drawn.
    """
    figure = new_figure(remarks, 4.2)
    axes = figure.subplots()
    places = _axis(axes, table)
    laws = (
        ("worn_volume_mm3", "the study's law, from the load ledger", "o", LAW_COLOUR),
        ("finnie_volume_mm3", "Finnie, the solver's own", "D", FINNIE_COLOUR),
    )
    for name, label, mark, drawn in laws:
        axes.plot(places, table[name].where(table[name] > 0.0), mark, color=drawn, markersize=7, label=label)
    between = {"color": OTHER_COLOUR, "linewidth": 0.6, "zorder": 0}
    axes.vlines(places, table["finnie_volume_mm3"], table["worn_volume_mm3"], **between)
    ends = ["finnie_over_archard", "interval_low", "interval_high"]
    ratio = table[ends].mul(table["worn_volume_mm3"], axis="index")
    draw_intervals(axes, places, ratio["finnie_over_archard"], ratio, FINNIE_COLOUR)
    axes.set_yscale("log")
    axes.set_ylabel("Wear volume (mm³)")
    axes.grid(axis="y", which="minor", color="#f0f0f0")
    figure.legend(loc="outside upper center", ncols=2)
    return figure


def mean_forces(summary: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw mean vertical and drag force (N) of each setting with intervals, for studies of many settings.

    summary: as from `history.force_summary`
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    panels = figure.subplots(2, 1, sharex=True)
    settings, surfaces = (list(dict.fromkeys(summary[name])) for name in ("setting", "surface"))
    for axes, direction in zip(panels, ("vertical", "drag"), strict=True):
        for index, surface in enumerate(surfaces):
            runs = summary[(summary["surface"] == surface) & (summary["direction"] == direction)]
            places = np.array([settings.index(name) for name in runs["setting"]]) + (index - 0.5) * BAR_WIDTH
            drawn = {"color": colour(surface), "label": surface if axes is panels[0] else None}
            axes.plot(places, runs["mean_force_N"], marker(surface), markersize=5, **drawn)
            draw_intervals(axes, places, runs["mean_force_N"], runs, colour(surface))
        axes.set_ylabel(f"{direction.capitalize()} force (N)")
        low, high = axes.get_ylim()
        axes.set_ylim(low := min(0.0, low), high + ROOM_ABOVE * (high - low))
    panels[1].set_xticks(range(len(settings)), settings)
    panels[1].set_xlabel("Design row")
    figure.legend(loc="outside upper center", ncols=len(surfaces))
    return figure
