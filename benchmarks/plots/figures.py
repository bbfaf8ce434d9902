"""Figures that only benchmarks draw: sections of one groove on several meshes, what numerical choices
change, a travelling window beside a full bed, candidates for the critical scale."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from bulkwear.postproc.plots.style import BLUE, LARGEST_HEIGHT, ORANGE, OTHER_COLOUR, SMALLEST_FONT, new_figure

PANELS = {"spread_once": "conserving"}  # schemes that are drawn in the panel of another
LINES = ((OTHER_COLOUR, ":"), (ORANGE, "--"), (BLUE, "-"))  # coarsest mesh first
TABLE_LINE = 0.5  # pt
HEAD_LINES = 2.1  # lines of type in the head of the table
OVERLAY = {"color": "black", "linewidth": 0.6}
PERCENT = 100.0
SHADES = ("black", OTHER_COLOUR, ORANGE, BLUE, "#009E73", "#CC79A7")  # of the beds, the full one first
MILLIMETRES = 1000.0
ROOM = 1.2  # -, of the panels over the largest mean
NARROW = 0.15  # -, of the panel of ratios below and above 1, at least
PACKING_LINE = {"linewidth": 0.6, "alpha": 0.45}  # of a single packing
SOURCE_COLOUR = "#009E73"
TITLES = {
    "conserving": "conserving, patch spread twice",
    "spread_once": "conserving, patch spread once",
    "per_triangle": "per triangle (Yan 2022, Eq 5.7)",
}
COLUMNS = {
    "strokes": ("strokes", "{:.0f}"),
    "edges_per_width": ("edge over\nwidth", "1/{:.0f}"),
    "depth_um": ("depth\n(µm)", "{:.0f}"),
    "width_mm": ("width\n(mm)", "{:.2f}"),
    "removed_over_archard": ("removed over\n$\\alpha W$ (-)", "{:.4f}"),
    "accounted_over_archard": ("with carried\nvolume (-)", "{:.9f}"),
    "work_over_load_times_distance": ("$W/FL$, last\nstroke (-)", "{:.3f}"),
}


def groove_convergence(sections: pd.DataFrame, table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the sections of each scheme (columns `scheme`, `edges_per_width`, `x_mm`, `depth_um`), meshes overlaid.

    table: one row per scheme and mesh, `scheme` and the columns of COLUMNS; printed below the drawing
    All panels have the same axes, depth downwards.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    panels = [scheme for scheme in dict.fromkeys(sections["scheme"]) if scheme not in PANELS]
    grid = figure.add_gridspec(2, 1, height_ratios=(1, 1))
    drawn = grid[0].subgridspec(1, len(panels)).subplots(sharex=True, sharey=True, squeeze=False)[0]
    for axes, panel in zip(drawn, panels, strict=True):
        for scheme, of_scheme in sections.groupby("scheme", sort=False):
            if PANELS.get(scheme, scheme) == panel:
                _sections(axes, of_scheme, scheme in PANELS)
        strokes = table.loc[table["scheme"] == panel, "strokes"].max()
        axes.set_title(f"{TITLES.get(panel, panel)}: {strokes:.0f} strokes", loc="left")
        axes.set_xlabel("Across the track (mm)")
    drawn[0].set_ylabel("Depth (µm)")
    drawn[0].invert_yaxis()
    figure.legend(*drawn[0].get_legend_handles_labels(), loc="outside upper center", ncols=len(LINES) + 1)
    _numbers(figure.add_subplot(grid[1]), table)
    return figure


def _sections(axes: Axes, sections: pd.DataFrame, overlaid: bool) -> None:
    """Draw one scheme's sections, coarsest mesh first."""
    for (edges, section), (shade, style) in zip(sections.groupby("edges_per_width"), LINES, strict=False):
        look = OVERLAY if overlaid else {"color": shade, "linestyle": style}
        label = f"edge 1/{edges}" + (" (patch spread once)" if overlaid else "")
        axes.plot(section["x_mm"], section["depth_um"], label=label, **look)


def _numbers(axes: Axes, table: pd.DataFrame) -> None:
    """Print the table on axes of its own."""
    axes.set_axis_off()
    names = [name for name in COLUMNS if name in table]
    cells = [
        [TITLES.get(row["scheme"], row["scheme"]), *(COLUMNS[name][1].format(row[name]) for name in names)]
        for _, row in table.iterrows()
    ]
    drawn = axes.table(
        cells,
        colLabels=["scheme", *(COLUMNS[name][0] for name in names)],
        bbox=(0.0, 0.0, 1.0, 1.0),
        cellLoc="center",
        edges="horizontal",
    )
    drawn.auto_set_font_size(False)
    drawn.set_fontsize(SMALLEST_FONT)
    drawn.auto_set_column_width(range(len(names) + 1))
    for (row, _), cell in drawn.get_celld().items():
        cell.set_linewidth(TABLE_LINE)
        cell.set_height(cell.get_height() * (HEAD_LINES if row == 0 else 1.0))


@dataclass(frozen=True)
class Panel:
    """A choice: its axis, its rows of `changes.changes`, and values worth a line, by name."""

    label: str
    changes: pd.DataFrame
    marked: Mapping[str, float] = field(default_factory=dict)


def deviation_figure(panels: Sequence[Panel], quantity: str, limit: float, remarks: Sequence[str]) -> Figure:
    """Draw the change of a quantity (%) over the values of each choice, both limits (-) and the marked values."""
    figure = new_figure(remarks, 4.2)
    for axes, panel in zip(figure.subplots(1, len(panels), sharey=True, squeeze=False)[0], panels, strict=True):
        rows = panel.changes.dropna(subset=["change"])
        change, low, high = (PERCENT * rows[name].to_numpy() for name in ("change", "change_low", "change_high"))
        reach = np.nan_to_num([change - low, high - change])
        axes.axhspan(-PERCENT * limit, PERCENT * limit, color=OTHER_COLOUR, alpha=0.15, linewidth=0.0)
        axes.errorbar(rows["value"], change, reach, marker="o", markersize=4.0, capsize=2.0, color=BLUE)
        for (name, value), style in zip(panel.marked.items(), ("--", ":", "-."), strict=False):
            axes.axvline(value, color=ORANGE, linestyle=style, linewidth=1.0, label=name)
        for value in panel.changes.loc[panel.changes["failed"] > 0, "value"]:
            axes.axvline(value, color="black", linewidth=0.6, label="a run failed")
        axes.set(xscale="log", xlabel=panel.label)
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(FuncFormatter(lambda value, _: ""))
        if panel.marked:
            axes.legend(loc="best", fontsize=SMALLEST_FONT)
    figure.axes[0].set_ylabel(f"Change of {quantity} (%)")
    return figure


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
