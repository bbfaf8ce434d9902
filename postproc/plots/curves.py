"""Curves: wear and forces along the travel, distribution of depth."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bulkwear.postproc.plots.style import (
    BLUE,
    LARGEST_HEIGHT,
    ORANGE,
    OTHER_COLOUR,
    SMALLEST_FONT,
    colour,
    facets,
    label_all,
    marker,
    new_figure,
    scaled,
)
from bulkwear.postproc.tables.packings import mean_along

FEW_ROWS = 2  # design rows that are drawn in full; more become small multiples or means


def wear_against_travel(history: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw cumulative wear (mm3) against travel (mm), one small multiple per setting: the mean over its packings, and
    each of them thin where there are several.

    history: as from `tables.history.wear_history`. Applied volume is drawn where any was applied.
    """
    rows = list(dict.fromkeys(history["setting"]))
    figure = new_figure(remarks, 4.0 if len(rows) <= FEW_ROWS else LARGEST_HEIGHT)
    several = len(rows) > 1
    applied = bool((history["applied_volume_mm3"] > 0.0).any())
    unit, ticks = scaled("mm³", float(history["worn_volume_mm3"].max()))
    for row, axes in facets(figure, rows).items():
        for _, packings in history[history["setting"] == row].groupby("surface", sort=False):
            _packings(axes, packings)
            worn, lost = (mean_along(packings, "travel_mm", f"{name}_volume_mm3") for name in ("worn", "applied"))
            _wear_curves(axes, worn.assign(applied_volume_mm3=lost["applied_volume_mm3"]), applied)
        axes.set_ylim(bottom=0.0)
        axes.set_xlim(left=0.0)
        axes.yaxis.set_major_formatter(ticks)
        if several:
            axes.set_title(row, loc="left", fontsize=SMALLEST_FONT, pad=2)
    label_all(figure, several, "Travel (mm)", f"Cumulative wear volume ({unit})")
    styles = {"worn by the law": "-"} | ({"applied to the surface": "--"} if applied else {})
    _legend(figure, list(dict.fromkeys(history["surface"])), styles, marked=True)
    return figure


def _packings(axes: Axes, packings: pd.DataFrame) -> None:
    """Draw the volume of each packing thin; nothing of one alone, which is its own mean."""
    runs = _runs(packings)
    for run in runs if len(runs) > 1 else ():
        look = {"color": colour(run["surface"].iloc[0]), "linewidth": 0.6, "alpha": 0.7}
        axes.plot(run["travel_mm"], run["worn_volume_mm3"], label=f"{run['run'].iloc[0]} packing", **look)


def _runs(table: pd.DataFrame) -> list[pd.DataFrame]:
    return [run for _, run in table.groupby("run", sort=False)]


def _wear_curves(axes: Axes, run: pd.DataFrame, applied: bool) -> None:
    surface = run["surface"].iloc[0]
    common = {
        "color": colour(surface),
        "marker": marker(surface),
        "markersize": 4,
        "clip_on": False,
    }
    name = run["run"].iloc[0]
    axes.plot(run["travel_mm"], run["worn_volume_mm3"], label=f"{name} archard", **common)
    if applied:
        axes.plot(
            run["travel_mm"],
            run["applied_volume_mm3"],
            "--",
            markerfacecolor="white",
            label=f"{name} applied",
            **common,
        )


def _legend(figure: Figure, surfaces: Sequence[str], styles: dict[str, str], marked: bool = False) -> None:
    """One legend above the figure: colours of the surfaces, then line styles."""
    handles = [
        Line2D(
            [],
            [],
            color=colour(name),
            marker=marker(name) if marked else "",
            markersize=4,
            label=name,
        )
        for name in surfaces
    ]
    handles += [Line2D([], [], color="black", linestyle=style, label=name) for name, style in styles.items()]
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))


def depth_distribution(curves: pd.DataFrame, quantity: str, remarks: Sequence[str]) -> Figure:
    """Draw the share of area (%) that is worn deeper than a depth (um), one small multiple per design row.

    curves: run, row, surface, depth_um, area_share_percent; quantity: what the depth is, for the axis.
    """
    rows = list(dict.fromkeys(curves["row"]))
    figure = new_figure(remarks, 4.0 if len(rows) <= FEW_ROWS else LARGEST_HEIGHT)
    several = len(rows) > 1
    for row, axes in facets(figure, rows, sharey=True).items():
        for run in _runs(curves[curves["row"] == row]):
            drawn = {"color": colour(run["surface"].iloc[0]), "label": run["run"].iloc[0]}
            axes.plot(run["depth_um"], run["area_share_percent"], **drawn)
        axes.set_ylim(0.0, 100.0)
        axes.set_xscale("log")
        axes.minorticks_off()
        if several:
            axes.set_title(row, loc="left", fontsize=SMALLEST_FONT, pad=2)
    label_all(figure, several, f"{quantity} (µm)", "Area worn deeper (% of the sample)")
    _legend(figure, list(dict.fromkeys(curves["surface"])), {})
    return figure


def forces(history: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw vertical and drag force (N) on the sample against travel (mm) for a study of few design rows."""
    rows = list(dict.fromkeys(history["row"]))
    figure = new_figure(remarks, LARGEST_HEIGHT)
    grid = figure.subplots(2, len(rows), sharex=True, sharey="row", squeeze=False)
    for column, row in enumerate(rows):
        for run in _runs(history[history["row"] == row]):
            drawn = {"color": colour(run["surface"].iloc[0]), "linewidth": 1.0, "label": run["run"].iloc[0]}
            grid[0, column].plot(run["travel_mm"], run["vertical_force_N"], **drawn)
            grid[1, column].plot(run["travel_mm"], run["drag_force_N"], **drawn)
        if len(rows) > 1:
            grid[0, column].set_title(row, loc="left")
        grid[1, column].set_xlabel("Travel (mm)")
    grid[0, 0].set_ylabel("Vertical force (N)")
    grid[1, 0].set_ylabel("Drag force (N)")
    for axes in grid.ravel():
        axes.axhline(0.0, color="#888888", linewidth=0.6)
    _legend(figure, list(dict.fromkeys(history["surface"])), {})
    return figure


def sampling_error(errors: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the error (%) of sampled sliding work against the stride (steps), and the numbers beside it.

    errors: as from `benchmarks.sampling_error.sampling_errors`. The error of short windows is against stride 1.
    """
    figure = new_figure(remarks)
    axes, numbers = figure.subplots(1, 2, width_ratios=(3, 2))
    lines = {
        "map_error": ("map over the triangles, whole travel", "o-", BLUE),
        "short_window_error": ("total of a tenth of the travel", "s-", ORANGE),
        "total_error": ("total of the whole travel", "^-", OTHER_COLOUR),
    }
    for column, (label, style, shade) in lines.items():
        drawn = errors[errors[column] > 0.0] if column != "short_window_error" else errors[errors["stride_steps"] > 1]
        axes.plot(drawn["stride_steps"], 100.0 * drawn[column], style, color=shade, label=label)
    axes.set(xscale="log", yscale="log", xlabel="Steps between two samples of the contacts")
    axes.set_ylabel("Error of the sliding work (%)")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_xticks(errors["stride_steps"], [str(stride) for stride in errors["stride_steps"]])
    axes.minorticks_off()
    axes.legend()
    numbers.set_axis_off()
    cells = [
        [f"{row['stride_steps']:.0f}", *(f"{100.0 * row[column]:.2g}" for column in lines), f"{row['dumps_MB']:.3g}"]
        for _, row in errors.iterrows()
    ]
    heads = ["steps", "map\n(%)", "tenth\n(%)", "total\n(%)", "dumps\n(MB)"]
    table = numbers.table(cells, colLabels=heads, loc="center", edges="horizontal")
    table.auto_set_font_size(False)
    table.set_fontsize(SMALLEST_FONT)
    table.scale(1.0, 1.8)
    return figure
