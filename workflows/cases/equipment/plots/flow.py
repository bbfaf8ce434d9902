"""Pictures of the flow from the side: particles by speed, mean velocities, and where the charge of a mill lies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import LARGEST_HEIGHT, MAP, SMALLEST_FONT, draw_circles, new_figure
from bulkwear.workflows.cases.equipment.flow_panels import FlowPanel
from bulkwear.workflows.cases.equipment.plots.panels import round_length

TOP_SHARE = 0.98  # of the particles or cells lie inside the colours
OUTLINE = "black"
ARROWS_ACROSS = 12  # cells with an arrow across the longer side of a view at most
ARROW_LENGTH = 0.9  # -, of the fastest arrow over the distance of arrows
PAGE, GAP = (6.8, 4.4), 0.2  # inches: room of all panels, and between them
NARROWEST = 1.5  # inches, of a panel: its name must fit
ROOM = 0.03  # -, round what is shown
BAR_SHARE = 0.25  # -, of the width of a panel that its scale bar may have
ANGLE_COLOUR = "#D55E00"
SENSE_DEG, SENSE_RADIUS = 14.0, 1.06  # half the arc of the arrow that tells the rotation; -, over that of the shell


def flow_pictures(panels: Sequence[FlowPanel], remarks: Sequence[str]) -> Figure:
    """Draw the particles of an instant by their speed, with sections of the parts; a panel per setting and phase.

    tables: right_mm, up_mm, radius_mm, speed_m_per_s; those drawn first lie behind
    """
    figure, grid = _figure(panels, remarks)
    limits = (0.0, _top(panels, "speed_m_per_s"))
    for axes, panel in zip(grid, panels, strict=True):
        places, radii = panel.table[["right_mm", "up_mm"]].to_numpy(), panel.table["radius_mm"].to_numpy()
        draw_circles(axes, places, radii, panel.table["speed_m_per_s"].to_numpy(), Normalize(*limits), MAP)
    _bar(figure, grid, limits, "Particle speed (m/s)")
    return figure


def velocity_fields(panels: Sequence[FlowPanel], remarks: Sequence[str]) -> Figure:
    """Draw mean velocities in cells of the view, colours by speed, arrows along the mean paths.

    tables: as from `flow_views.velocity_field`
    """
    figure, grid = _figure(panels, remarks)
    limits = (0.0, _top(panels, "speed_m_per_s"))
    for axes, panel in zip(grid, panels, strict=True):
        _cells(axes, panel.table, "speed_m_per_s", limits)
        _arrows(axes, panel.table, limits[1])
    _bar(figure, grid, limits, "Mean velocity across the view (m/s)")
    return figure


def charge_shape(panels: Sequence[FlowPanel], remarks: Sequence[str]) -> Figure:
    """Draw how full a mill's section is, with toe and shoulder of its charge.

    tables: as from `flow_views.filling_field`; panels with angles, centre and radius
    """
    figure, grid = _figure(panels, remarks)
    limits = (0.0, _top(panels, "solid_fraction"))
    for axes, panel in zip(grid, panels, strict=True):
        _cells(axes, panel.table, "solid_fraction", limits)
        for word, angle in panel.angles.items():
            _angle(axes, panel, word, angle)
        _sense(axes, panel)
    _bar(figure, grid, limits, "Particle volume over space (-)")
    return figure


# ---------------------------------------------------------------- panels


def _figure(panels: Sequence[FlowPanel], remarks: Sequence[str]) -> tuple[Figure, list[Axes]]:
    """Return a figure and the axes of its panels, all of one scale, with the outlines of the parts.

    Settings are lines or columns, or all panels stand side by side, whichever gives larger ones.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    settings, phases = (list(dict.fromkeys(getattr(each, name) for each in panels)) for name in ("setting", "phase"))
    box = _box(panels)
    aspect = (box[1] - box[0]) / (box[3] - box[2])
    shapes = [(len(settings), len(phases)), (len(phases), len(settings)), (1, len(settings) * len(phases))]
    kind = int(np.argmax([_panel_area(*shape, aspect) for shape in shapes]))
    grid = figure.subplots(*shapes[kind], squeeze=False)
    for axes in grid.ravel():
        axes.set_axis_off()
    found = []
    for panel in panels:
        setting, phase = settings.index(panel.setting), phases.index(panel.phase)
        line, column = ((setting, phase), (phase, setting), (0, setting * len(phases) + phase))[kind]
        own = panel.setting if len(settings) > 1 else ""
        side, head = ((own, panel.title), ("", _both(own, panel.title)), ("", _both(own, panel.title)))[kind]
        axes = grid[line, column]
        alike = kind == 0 and len({each.title for each in panels if each.phase == panel.phase}) == 1
        axes.set_title("" if alike and line else head, fontsize=SMALLEST_FONT, pad=3)
        if column == 0:
            place = {"rotation": 90, "va": "center", "ha": "right", "fontsize": SMALLEST_FONT}
            axes.text(-0.02, 0.5, side, transform=axes.transAxes, **place)
        axes.set(xlim=box[:2], ylim=box[2:], aspect="equal")
        axes.add_collection(LineCollection(panel.outlines, colors=OUTLINE, linewidths=0.8, zorder=4))
        found.append(axes)
    _scale_bar(found[0], box)
    return figure, found


def _both(setting: str, title: str) -> str:
    return "\n".join(filter(None, [setting, title]))


def _panel_area(lines: int, columns: int, aspect: float) -> float:
    """Return the area (square inches) of a panel in a grid on a page."""
    width, height = PAGE[0] / columns - GAP, PAGE[1] / lines - GAP
    if width < NARROWEST:
        return 0.0
    return min(width, height * aspect) ** 2 / aspect


def _box(panels: Sequence[FlowPanel]) -> tuple[float, float, float, float]:
    """Return what all panels show (mm): from left, to right, from below, to above; parts and particles."""
    places = [panel.outlines.reshape(-1, 2) for panel in panels]
    places += [panel.table[["right_mm", "up_mm"]].to_numpy() for panel in panels]
    every = np.concatenate(places)
    low, high = every.min(axis=0), every.max(axis=0)
    room = ROOM * float((high - low).max())
    return low[0] - room, high[0] + room, low[1] - room, high[1] + room


def _top(panels: Sequence[FlowPanel], column: str) -> float:
    tops = [float(panel.table[column].quantile(TOP_SHARE)) for panel in panels if len(panel.table)]
    return max([*tops, np.finfo(float).tiny])


def _bar(figure: Figure, grid: Sequence[Axes], limits: tuple[float, float], label: str) -> None:
    look = {"shrink": 0.85, "aspect": 30, "pad": 0.02, "fraction": 0.06}
    figure.colorbar(ScalarMappable(Normalize(*limits), MAP), ax=grid, label=label, extend="max", **look)


def _scale_bar(axes: Axes, box: tuple[float, float, float, float]) -> None:
    """Draw a bar of round length below a panel."""
    length = round_length(BAR_SHARE * (box[1] - box[0]))
    axes.plot([box[0], box[0] + length], [box[2]] * 2, color="#333333", linewidth=1.5, clip_on=False)
    text = {"textcoords": "offset points", "va": "top", "fontsize": SMALLEST_FONT, "color": "#333333"}
    axes.annotate(f"{length:g} mm", (box[0], box[2]), (1.0, -2.5), annotation_clip=False, **text)


def _cells(axes: Axes, table: pd.DataFrame, column: str, limits: tuple[float, float]) -> None:
    """Draw cells by a column; white where there are none."""
    side = float(table["side_mm"].iloc[0]) if len(table) else 1.0
    i, j = (np.round(table[name].to_numpy() / side - 0.5).astype(int) for name in ("right_mm", "up_mm"))
    if not len(i):
        return
    values = np.full((np.ptp(j) + 1, np.ptp(i) + 1), np.nan)
    values[j - j.min(), i - i.min()] = table[column]
    x, y = (side * np.arange(k.min(), k.max() + 2) for k in (i, j))
    axes.pcolormesh(x, y, values, cmap=MAP, vmin=limits[0], vmax=limits[1], rasterized=True)


def _arrows(axes: Axes, table: pd.DataFrame, fastest: float) -> None:
    """Draw arrows of mean velocity, thinned so that they keep apart: each is the mean of the cells round it."""
    if table.empty:
        return
    side = float(table["side_mm"].iloc[0])
    spread = np.ptp(table[["right_mm", "up_mm"]].to_numpy(), axis=0).max()
    apart = side * max(round(spread / ARROWS_ACROSS / side), 1)
    columns = ["right_mm", "up_mm", "velocity_right_m_per_s", "velocity_up_m_per_s"]
    blocks = np.floor(table[columns[:2]] / apart).astype(int)
    means = table[columns].mul(table["particles"], axis=0).assign(particles=table["particles"])
    means = means.groupby([blocks["right_mm"], blocks["up_mm"]]).sum()
    means = means[columns].div(means["particles"], axis=0)
    scale = fastest / (ARROW_LENGTH * apart)
    look = {"angles": "xy", "scale_units": "xy", "scale": scale, "width": 0.006, "color": "white", "zorder": 3}
    look |= {"edgecolor": "black", "linewidth": 0.4, "pivot": "mid", "headwidth": 3.6}
    axes.quiver(*means.to_numpy().T, **look)


def _angle(axes: Axes, panel: FlowPanel, word: str, angle: float) -> None:
    """Draw the radius at an angle from 12 o'clock in the sense of rotation, and write the angle outside of it."""
    if not np.isfinite(angle):
        return
    turn = np.radians(angle) * (1.0 if panel.clockwise else -1.0)
    direction, centre = np.array([np.sin(turn), np.cos(turn)]), np.array(panel.centre_mm)
    axes.plot(*np.stack([centre, centre + panel.radius_mm * direction]).T, color=ANGLE_COLOUR, linewidth=1.6, zorder=5)
    box = {"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": ANGLE_COLOUR, "linewidth": 0.8}
    style = {"ha": "center", "va": "center", "fontsize": SMALLEST_FONT, "zorder": 6, "bbox": box}
    axes.text(*(centre + 0.5 * panel.radius_mm * direction), f"{word} {angle:.0f}°", **style)


def _sense(axes: Axes, panel: FlowPanel) -> None:
    """Draw an arrow outside the shell, at 3 o'clock, whither it turns."""
    turns = np.radians(90.0 + np.array([-1.0, 1.0]) * SENSE_DEG)
    ends = np.array(panel.centre_mm) + SENSE_RADIUS * panel.radius_mm * np.column_stack([np.sin(turns), np.cos(turns)])
    start, end = ends if panel.clockwise else ends[::-1]
    bent = -0.15 if panel.clockwise else 0.15
    look = {"arrowstyle": "-|>", "color": "black", "linewidth": 1.2, "connectionstyle": f"arc3,rad={bent}"}
    axes.annotate("", end, start, arrowprops=look, annotation_clip=False)
