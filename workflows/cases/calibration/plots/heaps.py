"""Figure of heaps at rest, seen along the periodic width, with the stretch of their slopes that was measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bulkwear.postproc.plots.style import LARGEST_HEIGHT, ORANGE, SMALLEST_FONT, new_figure

SLOPE_COLOUR = ORANGE
PARTICLE_COLOUR, PARTICLE_EDGE = "#d8dee4", "#8a949e"
HALF_LABEL_POINTS = 44.0  # half the width of an angle's words


def heaps(pictures: Sequence[Mapping[str, Any]], remarks: Sequence[str]) -> Figure:
    """Draw heaps from the side with their walls and the straight lines fitted to their free surfaces.

    pictures: each with title, particles (x_m, y_m, z_m, radius_m), slopes (`flow.free_surface.Slope`), walls (lines
    as ((y, z), (y, z)) in m)
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    axes = figure.subplots(1, len(pictures), squeeze=False)[0]
    for each, picture in zip(axes, pictures, strict=True):
        _draw_particles(each, picture["particles"])
        for start, end in picture["walls"]:
            each.plot(*(1e3 * np.array([start, end]).T), color="black", linewidth=1.4, solid_capstyle="butt")
        for slope in picture["slopes"]:
            _draw_slope(each, slope)
        _set_limits(each, picture)
        each.set(aspect="equal", xlabel="Along the box (mm)", ylabel="Height (mm)")
        each.set_title(picture["title"], loc="left", fontsize=SMALLEST_FONT)
        each.grid(False)
    handles = [
        Line2D([], [], color=SLOPE_COLOUR, linewidth=2.5, label="robust fit, over the stretch that it uses"),
        Line2D([], [], color="black", linewidth=1.4, label="walls"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=2)
    return figure


def _draw_particles(axes: Axes, particles: pd.DataFrame) -> None:
    """Draw particles as circles, those in front last."""
    front = particles.sort_values("x_m", kind="stable")
    diameters = 2e3 * front["radius_m"].to_numpy()
    axes.add_collection(
        EllipseCollection(
            diameters,
            diameters,
            np.zeros(len(front)),
            units="x",
            offsets=1e3 * front[["y_m", "z_m"]].to_numpy(),
            offset_transform=axes.transData,
            facecolor=PARTICLE_COLOUR,
            edgecolor=PARTICLE_EDGE,
            linewidth=0.3,
            rasterized=True,
        )
    )


def _set_limits(axes: Axes, picture: Mapping[str, Any]) -> None:
    """Show every particle and wall of a heap whole."""
    particles, walls = picture["particles"], np.array(picture["walls"]).reshape(-1, 2)
    margin = 1e3 * float(particles["radius_m"].max())
    for name, values, limits in (("y_m", walls[:, 0], axes.set_xlim), ("z_m", walls[:, 1], axes.set_ylim)):
        low = min([(particles[name] - particles["radius_m"]).min(), *values])
        high = max([(particles[name] + particles["radius_m"]).max(), *values])
        limits(1e3 * low - margin, 1e3 * high + margin)


def _draw_slope(axes: Axes, slope: Any) -> None:
    y = np.array([slope.start_m, slope.end_m])
    z = slope.height_at_start_m + slope.gradient * (y - slope.start_m)
    axes.plot(1e3 * y, 1e3 * z, color=SLOPE_COLOUR, linewidth=2.5, marker="|", markersize=9)
    axes.annotate(
        f"{np.degrees(slope.angle_rad):.1f} ± {np.degrees(slope.uncertainty_rad):.1f}°",
        (1e3 * y.mean(), 1e3 * z.mean()),
        xytext=(0, 8.0 + HALF_LABEL_POINTS * abs(slope.gradient)),  # in the air, clear of the slope
        textcoords="offset points",
        ha="center",
        fontsize=SMALLEST_FONT,
    )
