"""Sections through the worst places: outlines at several hours of operation, and what was lost along them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, MaxNLocator

from bulkwear.postproc.plots.style import LARGEST_HEIGHT, MAP, SMALLEST_FONT, label_all, new_figure

MOST_SECTIONS = 4  # side by side
HOUR_COLOURS = (0.05, 0.88)  # -, of the map: its lightest end is hard to see on white
LINE_WIDTH = 1.3
TICKS_ACROSS = 14  # of all panels side by side
PANELS_WIDE, TICK_INCHES = 5.4, 0.3  # inches: all panels together, and between two ticks
ENDS = ("along_1_mm", "out_1_mm", "along_2_mm", "out_2_mm")
DEPTHS = ("depth_1_mm", "depth_2_mm")
LEAST_DEPTH = 1.0  # mm, of the axis of depth, so that no wear does not fill it


def profile_sections(sections: pd.DataFrame, windows: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw outlines in mm, true to scale, and below them the thickness removed along those of parts that do not turn.

    sections: a row per line: section, operation_h, ENDS (mm from the place), DEPTHS (mm), faces_out (whether its face
    looks out of the body there); windows: a row per section: section, name, half_width_mm shown, turns
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    shown = windows.head(MOST_SECTIONS)
    flat = not shown["turns"].all()
    heights = {"height_ratios": (3, 2)} if flat else {}
    grid = figure.subplots(1 + flat, len(shown), squeeze=False, **heights)
    hours = sorted(sections["operation_h"].unique())
    for column, window in enumerate(shown.itertuples()):
        lines = sections[sections["section"] == window.section]
        _outlines(grid[0, column], lines, hours, window)
        if flat:
            _depths(grid[1, column], lines, hours, bool(window.turns))
    _as_high(grid[0])
    deepest = max(float(sections[list(DEPTHS)].max().max()), LEAST_DEPTH)
    for axes in grid[1] if flat else ():
        axes.set_ylim(1.06 * deepest, -0.04 * deepest)
    grid[0, 0].set_ylabel("Out of the body (mm)")
    if flat:
        grid[1, 0].set_ylabel("Removed (mm)")
    for axes in grid.ravel():
        axes.xaxis.set_major_locator(MaxNLocator(TICKS_ACROSS // len(shown), prune="both"))
    for axes in grid[0]:
        (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
        inches = PANELS_WIDE / len(shown) * (high - low) / (right - left)
        axes.yaxis.set_major_locator(MaxNLocator(int(np.clip(inches / TICK_INCHES, 1, 6))))
    label_all(figure, True, "Along the section (mm)", "")
    _hours_bar(figure, grid, hours)
    return figure


def _hours_bar(figure: Figure, grid: np.ndarray, hours: Sequence[float]) -> None:
    """Tell the colours of the hours by a bar, and the black of the shape as built."""
    colours = ListedColormap(
        [hour_colour(hour, hours) for hour in np.linspace(*np.divide(max(hours), (256.0, 1.0)), 256)]
    )
    bar = figure.colorbar(
        ScalarMappable(Normalize(0.0, max(max(hours), 1.0)), colours), ax=grid, pad=0.02, fraction=0.05, aspect=35
    )
    bar.set_label("Hours of operation")
    bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.6g}"))
    for hour in hours:
        bar.ax.axhline(hour, color="white", linewidth=1.2)
    black = Line2D([], [], color="black", linewidth=LINE_WIDTH, label="as built")
    figure.legend(handles=[black], loc="outside upper right")


def hour_colour(hour: float, hours: Sequence[float]) -> object:
    """Return the colour of a shape by its hours of operation; black as built."""
    last = max(hours)
    low, high = HOUR_COLOURS
    return "black" if hour <= 0.0 else colormaps[MAP](high - (high - low) * hour / last)


def _outlines(axes: Axes, lines: pd.DataFrame, hours: Sequence[float], window: tuple) -> None:
    """Draw the outlines of a section within its window."""
    reach = window.half_width_mm
    for hour in hours:
        ends = lines.loc[lines["operation_h"] == hour, list(ENDS)].to_numpy().reshape(-1, 2, 2)
        look = {"colors": [hour_colour(hour, hours)], "linewidths": LINE_WIDTH, "capstyle": "round"}
        axes.add_collection(LineCollection(ends, zorder=3 if hour > 0.0 else 2.5, **look))
    places = lines[list(ENDS)].to_numpy().reshape(-1, 2)
    inside = places[(np.abs(places) <= reach).all(axis=1)]
    low, high = (inside[:, 1].min(), inside[:, 1].max()) if len(inside) else (-reach, reach)
    room = 0.06 * max(high - low, 0.2 * reach)
    axes.set(xlim=(-reach, reach), ylim=(low - room, high + room), aspect="equal")
    axes.set_title(window.name, loc="left", fontsize=SMALLEST_FONT)


def _as_high(panels: Sequence[Axes]) -> None:
    """Give outlines, as high over their width as the highest of them, so that equal windows have one scale."""
    reaches = np.array([axes.get_xlim()[1] for axes in panels])
    ends = np.array([axes.get_ylim() for axes in panels]) / reaches[:, None]
    for axes, reach in zip(panels, reaches, strict=True):
        axes.set_ylim(*(reach * np.array([ends[:, 0].min(), ends[:, 1].max()])))


def _depths(axes: Axes, lines: pd.DataFrame, hours: Sequence[float], turns: bool) -> None:
    """Draw the thickness removed along a section, of the faces that look out of the body."""
    if turns:
        axes.set_axis_off()
        return
    out = lines[lines["faces_out"]]
    for hour in hours:
        rows = out[out["operation_h"] == hour]
        along, depth = (rows[[f"{name}_1_mm", f"{name}_2_mm"]].to_numpy() for name in ("along", "depth"))
        look = {"colors": [hour_colour(hour, hours)], "linewidths": LINE_WIDTH}
        axes.add_collection(LineCollection(np.stack([along, depth], axis=-1), **look))
    along = out[["along_1_mm", "along_2_mm"]].to_numpy() if len(out) else np.array([-1.0, 1.0])
    axes.set_xlim(along.min(), along.max())
