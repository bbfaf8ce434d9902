"""A scan against surfaces: maps of depth and deviation, sections of bumps with the scanner's accuracy as a band."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.plots.scene import common_bounds, depth_oblique
from bulkwear.postproc.plots.style import (
    BLUE,
    LARGEST_HEIGHT,
    MAP,
    ORANGE,
    OTHER_COLOUR,
    SMALLEST_FONT,
    new_figure,
    picture,
)
from bulkwear.postproc.scans.comparison import STEEPEST, depth_of_faces

DEVIATION_MAP = "RdBu_r"
TOP_SHARE = 0.99  # of the cells: deeper ones share the top colour
MEASURED_COLOUR = "black"
SURFACE_COLOURS = (BLUE, ORANGE, "#009E73", "#CC79A7")


def depth_maps(cells: pd.DataFrame, pristine: SurfaceMesh, names: Sequence[str], remarks: Sequence[str]) -> Figure:
    """Draw the measured depth (um) in plan and obliquely, and of every worn surface its depth and the deviation.

    cells: as from `scans.comparison.depth_cells`; names: of the worn surfaces, as in its columns. All depths
    share a scale; deviations share one about zero: positive where the scan stands out of the worn surface.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    grid = figure.subplots(2, 1 + len(names), squeeze=False)
    worn = cells[cells["part"] >= 0]
    depths = worn[["measured_depth_um", *(f"{name}_depth_um" for name in names)]]
    limits = (0.0, max(float(depths.quantile(TOP_SHARE).max()), np.finfo(float).tiny))
    drawn = _map(grid[0, 0], cells, "measured_depth_um", MAP, limits)
    grid[0, 0].set_title("measured depth", loc="left", fontsize=SMALLEST_FONT)
    picture(
        grid[1, 0],
        depth_oblique(pristine, depth_of_faces(cells, pristine), limits, common_bounds([pristine])),
    )
    for column, name in enumerate(names, start=1):
        _map(grid[0, column], cells, f"{name}_depth_um", MAP, limits)
        grid[0, column].set_title(f"depth of {name}", loc="left", fontsize=SMALLEST_FONT)
    figure.colorbar(drawn, ax=grid[0], label="Depth (µm)", extend="both", shrink=0.85, pad=0.02, fraction=0.06)
    if names:
        away = worn[[f"{name}_deviation_um" for name in names]].abs().quantile(TOP_SHARE).max()
        for column, name in enumerate(names, start=1):
            drawn = _map(grid[1, column], cells, f"{name}_deviation_um", DEVIATION_MAP, (-away, away))
            grid[1, column].set_title(f"scan above {name} (red)", loc="left", fontsize=SMALLEST_FONT)
        figure.colorbar(drawn, ax=grid[1], label="Deviation (µm)", extend="both", shrink=0.85, pad=0.02, fraction=0.06)
    for axes in [grid[0, 0], *grid[:, 1:].ravel()]:
        axes.set(xlabel="x (mm)", ylabel="y (mm)")
    return figure


def _map(axes: Axes, cells: pd.DataFrame, column: str, colours: str, limits: tuple[float, float]):
    """Show a column of the cells in plan, white where there is none; return what a colour bar needs."""
    x, i = np.unique(cells["x_mm"].round(6), return_inverse=True)
    y, j = np.unique(cells["y_mm"].round(6), return_inverse=True)
    total, weight = np.zeros((len(y), len(x))), np.zeros((len(y), len(x)))
    points = cells["points"].to_numpy(float)
    np.add.at(total, (j, i), points * cells[column].to_numpy())  # a cell at the foot of a bump has two labels
    np.add.at(weight, (j, i), points)
    values = np.divide(total, weight, out=np.full_like(total, np.nan), where=weight > 0.0)
    drawn = axes.pcolormesh(
        x, y, values, cmap=colours, vmin=limits[0], vmax=limits[1], shading="nearest", rasterized=True
    )
    axes.set_aspect("equal")
    axes.grid(False)
    return drawn


def bump_sections(
    sections: pd.DataFrame, bumps: Sequence[str], names: Sequence[str], accuracy: float, remarks: Sequence[str]
) -> Figure:
    """Draw the sections of some bumps, side view above, front view below: pristine, measured with a band, simulated.

    sections: as from `scans.comparison.bump_sections`; names: of the worn surfaces; accuracy: um.
    """
    figure, panels = _panels(sections, bumps, "Height (mm)", remarks)
    for axes, section in panels:
        along, pristine = section["along_mm"], section["pristine_height_mm"]
        axes.plot(along, pristine, ":", color=OTHER_COLOUR, linewidth=1.0, label="pristine")
        heights = {"measured": section["measured_height_mm"]}
        heights |= {name: section[f"{name}_height_mm"] for name in names}
        _curves(axes, along, heights, section["band_mm"], accuracy)
    _legend(figure, panels[0][0])
    return figure


def bump_losses(
    sections: pd.DataFrame, bumps: Sequence[str], names: Sequence[str], accuracy: float, remarks: Sequence[str]
) -> Figure:
    """Draw how much lower (um) than pristine some bumps are, along and across the travel; arguments as `bump_sections`.

    Only where the pristine section is no steeper than 60 degrees: beyond, it tells where the sample lies, not its wear.
    """
    figure, panels = _panels(sections, bumps, "Height loss (µm)", remarks)
    for axes, section in panels:
        along, pristine = section["along_mm"], section["pristine_height_mm"]
        flat = np.abs(np.gradient(pristine, along)) <= STEEPEST
        losses = {"measured": 1e3 * (pristine - section["measured_height_mm"]).where(flat)}
        losses |= {name: 1e3 * (pristine - section[f"{name}_height_mm"]).where(flat) for name in names}
        _curves(axes, along, losses, 1e3 * section["band_mm"], accuracy)
        axes.axhline(0.0, color=OTHER_COLOUR, linewidth=0.6)
    _legend(figure, panels[0][0])
    return figure


def _panels(
    sections: pd.DataFrame, bumps: Sequence[str], quantity: str, remarks: Sequence[str]
) -> tuple[Figure, list[tuple[Axes, pd.DataFrame]]]:
    """A figure with a panel per bump and view, and the section of each."""
    figure = new_figure(remarks, LARGEST_HEIGHT)
    views = {"side": "Along the travel from the middle (mm)", "front": "Across the travel from the middle (mm)"}
    grid = figure.subplots(2, len(bumps), sharex="row", sharey=True, squeeze=False)
    panels = []
    for line, (view, label) in zip(grid, views.items(), strict=True):
        for axes, bump in zip(line, bumps, strict=True):
            panels.append((axes, sections[(sections["bump"] == bump) & (sections["view"] == view)]))
            axes.set_title(f"{bump}, {view}", loc="left", fontsize=SMALLEST_FONT)
        line[len(line) // 2].set_xlabel(label)
        line[0].set_ylabel(quantity)
    return figure, panels


def _curves(axes: Axes, along: pd.Series, curves: dict[str, pd.Series], band: pd.Series, accuracy: float) -> None:
    """Draw what was measured with its band, and what was simulated."""
    measured = curves.pop("measured")
    band_look = {"color": MEASURED_COLOUR, "alpha": 0.25, "linewidth": 0.0}
    axes.fill_between(
        along, measured - band, measured + band, label=f"scanner's accuracy, {accuracy:.3g} µm", **band_look
    )
    axes.plot(along, measured, color=MEASURED_COLOUR, linewidth=0.9, label="measured")
    for (name, curve), colour in zip(curves.items(), SURFACE_COLOURS, strict=False):
        axes.plot(along, curve, "--", color=colour, linewidth=1.1, label=name)


def _legend(figure: Figure, axes: Axes) -> None:
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
