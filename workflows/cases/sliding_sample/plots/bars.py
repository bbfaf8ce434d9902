"""Bars and points per run: split of the wear, patterned over plain, laws and forces."""

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
MANY_RUNS = 6  # from here on run names stand upright
SMALLEST_RANGE = 1e-6  # -, of the value: a single cycle has none
PUBLISHED_MARKS_UPRIGHT = {"about": "D", "below": "v", "above": "^"}
MEANING = {"about": "", "below": " (at most)", "above": " (at least)"}
HEADROOM = 1.18  # -, of the highest bar, for the numbers above it
LAW_COLOUR, FINNIE_COLOUR = "#0072B2", "#CC79A7"


def _run_axis(axes: Axes, runs: Sequence[str]) -> np.ndarray:
    places = np.arange(len(runs), dtype=float)
    rotation = 90 if len(runs) > MANY_RUNS else 0
    axes.set_xticks(places, [run.replace("_", " ") for run in runs], rotation=rotation)
    axes.set_xlim(-0.6, len(runs) - 0.4)
    axes.grid(axis="x", visible=False)
    return places


def wear_split(split: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw each run's wear on base and pattern, stacked, over the wear of its plain run (dashed line at 1).

    split: as from `comparison.wear_split`. Of many runs, plain ones (1 by definition) are left out.
    """
    if len(split) > MANY_RUNS and (split["surface"] != PLAIN).any():
        split = split[split["surface"] != PLAIN].reset_index(drop=True)
    figure = new_figure(remarks, 4.2)
    axes = figure.subplots()
    places = _run_axis(axes, split["run"])
    width = 0.5 if len(split) <= MANY_RUNS else 0.7
    axes.bar(places, split["base_over_plain"], width, color=BASE_COLOUR, label="base")
    axes.bar(
        places,
        split["pattern_over_plain"],
        width,
        bottom=split["base_over_plain"],
        color=PATTERN_COLOUR,
        label="pattern",
        hatch="//",
        edgecolor="white",
    )
    total = (split["base_over_plain"] + split["pattern_over_plain"]).to_numpy()
    for place, height in zip(places, total, strict=True):
        if np.isfinite(height):
            upright = 90 if len(split) > MANY_RUNS else 0
            axes.text(
                place,
                height,
                f" {height:.2f}",
                ha="center",
                va="bottom",
                fontsize=SMALLEST_FONT,
                rotation=upright,
                bbox={"color": "white", "pad": 0.5},
            )
    axes.axhline(1.0, color="black", linewidth=0.8, linestyle="--")
    axes.set_ylim(0.0, HEADROOM * np.nanmax([1.0, *total]))
    axes.set_ylabel("Wear volume over the plain sample's (-)")
    figure.legend(loc="outside upper center", ncols=2)
    return figure


def relative_wear(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw wear over plain per setting, lowest first, with its interval or else its range over the cycles, and
    alpha_ER written in.

    table: as from `comparison.by_setting`; published: row, relation, value (-) and source; may be empty
    """
    figure = new_figure(remarks, 4.6)
    axes = figure.subplots()
    table = table.sort_values("wear_over_plain", kind="stable")
    ratio = table["wear_over_plain"].to_numpy()
    places = _run_axis(axes, table["row"])
    axes.set_xticks(places, table["row"], rotation=0)
    axes.bar(places, ratio, 0.7, color=[colour(surface) for surface in table["surface"]])
    repeated = table["interval_low"].notna().any()
    ends = ("interval_low", "interval_high") if repeated else ("lowest_cycle_ratio", "highest_cycle_ratio")
    low, high = (table[name].to_numpy() for name in ends)
    spread = np.clip([ratio - low, high - ratio], 0.0, None)
    ranged = spread.sum(axis=0) > SMALLEST_RANGE * ratio
    axes.errorbar(
        places[ranged], ratio[ranged], spread[:, ranged], fmt="none", ecolor="black", elinewidth=0.8, capsize=3
    )
    top = HEADROOM * np.nanmax([1.0, *high, *ratio])
    shown = published[published["row"].isin(table["row"])]
    if len(shown):
        _published_marks(axes, dict(zip(table["row"], places, strict=True)), shown)
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
        )
        axes.text(place, 0.985 * top, f"{size:.2f}", ha="center", va="top", fontsize=SMALLEST_FONT)
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
    """Draw the volume (mm3) of each run by the study's law and by the solver's own Finnie model on a log axis.

    table: as from `comparison.law_comparison`. Volumes of zero are not drawn.
    """
    figure = new_figure(remarks, 4.2)
    axes = figure.subplots()
    places = _run_axis(axes, table["run"])
    laws = (
        ("worn_volume_mm3", "the study's law, from the load ledger", "o", LAW_COLOUR),
        ("finnie_volume_mm3", "Finnie, the solver's own", "D", FINNIE_COLOUR),
    )
    for name, label, mark, drawn in laws:
        axes.plot(places, table[name].where(table[name] > 0.0), mark, color=drawn, markersize=7, label=label)
    axes.vlines(
        places,
        table["finnie_volume_mm3"],
        table["worn_volume_mm3"],
        color=OTHER_COLOUR,
        linewidth=0.6,
        zorder=0,
    )
    axes.set_yscale("log")
    axes.set_ylabel("Wear volume (mm³)")
    axes.grid(axis="y", which="minor", color="#f0f0f0")
    figure.legend(loc="outside upper center", ncols=2)
    return figure


def mean_forces(summary: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw mean vertical and drag force (N) per run with the 10th to 90th percentile along the travel.

    summary: as from `history.force_summary`. For studies of many rows.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    panels = figure.subplots(2, 1, sharex=True)
    rows = list(dict.fromkeys(summary["row"]))
    surfaces = list(dict.fromkeys(summary["surface"]))
    for axes, name, label in zip(panels, ("vertical_force_N", "drag_force_N"), ("Vertical", "Drag"), strict=True):
        for index, surface in enumerate(surfaces):
            runs = summary[summary["surface"] == surface]
            places = np.array([rows.index(row) for row in runs["row"]]) + (index - 0.5) * BAR_WIDTH
            mean = runs[f"mean_{name}"].to_numpy()
            spread = np.clip([mean - runs[f"low_{name}"], runs[f"high_{name}"] - mean], 0.0, None)
            drawn = {"color": colour(surface), "label": surface if axes is panels[0] else None}
            axes.errorbar(places, mean, spread, fmt=marker(surface), markersize=5, capsize=2, **drawn)
        axes.set_ylabel(f"{label} force (N)")
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    panels[1].set_xticks(range(len(rows)), rows)
    panels[1].set_xlabel("Design row")
    figure.legend(loc="outside upper center", ncols=len(surfaces))
    return figure
