"""Sections of one groove worn on several meshes: how far its shape depends on the mesh, by displacement scheme."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from postproc.plots.style import BLUE, LARGEST_HEIGHT, ORANGE, OTHER_COLOUR, SMALLEST_FONT, new_figure

TITLES = {
    "conserving": "conserving, patch spread twice",
    "spread_once": "conserving, patch spread once",
    "per_triangle": "per triangle (Yan 2022, Eq 5.7)",
}
PANELS = {"spread_once": "conserving"}  # schemes that are drawn in the panel of another
LINES = ((OTHER_COLOUR, ":"), (ORANGE, "--"), (BLUE, "-"))  # coarsest mesh first
TABLE_LINE = 0.5  # pt
HEAD_LINES = 2.1  # lines of type in the head of the table
OVERLAY = {"color": "black", "linewidth": 0.6}
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
