"""What the wear updates did, in four small panels: along the travel, or the worst per run of many design rows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bulkwear.postproc.plots.style import LARGEST_HEIGHT, SMALLEST_FONT, colour, marker, new_figure
from bulkwear.postproc.tables.updates import drawn_in_log

VOLUMES, STEP = "Share of the cycle's\nwear (%)", "Largest step over\nits cap (-)"
ANGLE, FACES, BALANCE = "Smallest angle (°)", "Faces remeshed (bars)", "Error of the volume\nbalance (-)"
LINES = {  # column -> its panel and line style
    "applied_percent": (VOLUMES, "-"),
    "carried_percent": (VOLUMES, "--"),
    "step_demand": (STEP, "-"),
    "step_taken": (STEP, "--"),
    "smallest_angle_deg": (ANGLE, "-"),
    "balance_error": (BALANCE, "-"),
}
TITLES = {  # what the styles of a panel's lines, or the faces of its points, stand for
    VOLUMES: ("full: applied, dashed: carried on", "filled: applied, hollow: carried on"),
    STEP: (
        "full: wanted step over the mesh's cap,\ndashed: taken step over the cap in force",
        "filled: wanted step over the mesh's cap,\nhollow: taken step over the cap in force",
    ),
    ANGLE: ("dotted: bound", "dotted: bound"),
}
MARKED = 30  # cycles; more are drawn without markers
BAR_STRENGTH = 0.3  # -, of colour: lines stay legible on bars
BAR_WIDTH = 0.38  # -, of the space of a row with two runs


def wear_updates(updates: pd.DataFrame, angle_bound: float, remarks: Sequence[str]) -> Figure:
    """Draw volumes, steps, angle with remeshed faces and the balance of each update against travel (mm).

    updates: as from `tables.updates.wear_updates`; angle_bound: degrees, below which faces are remeshed.
    """
    figure, panels = _panels(remarks, angle_bound)
    faces = _face_axes(panels[ANGLE], updates)
    for name, run in updates.groupby("run", sort=False):
        shade, marker = _look(run["surface"].iloc[0])
        for column, (panel, style) in LINES.items():
            drawn = {"color": shade, "label": f"{name} {column}", "markersize": 4, "clip_on": False}
            drawn |= {"marker": marker if len(run) <= MARKED else "", "linewidth": 1.2}
            filled = {"markerfacecolor": shade if style == "-" else "white"}
            panels[panel].plot(run["travel_mm"], _values(run, column), style, **drawn, **filled)
        if faces is not None:
            length = (run["travel_mm"] - run["cycle_start_mm"]).to_numpy()
            heights = run["remeshed_faces"].to_numpy()
            drawn = {"color": shade, "alpha": BAR_STRENGTH, "label": f"{name} remeshed_faces"}
            faces.bar(run["cycle_start_mm"], heights, length, align="edge", **drawn)
    for axes in (panels[ANGLE], panels[BALANCE]):
        axes.set_xlabel("Travel (mm)")
    panels[STEP].set_xlim(left=0.0)
    _finish(figure, panels, updates)
    return figure


def worst_updates(summary: pd.DataFrame, angle_bound: float, remarks: Sequence[str]) -> Figure:
    """Draw the worst update of each setting and surface: points, and remeshed faces as bars.

    summary: as from `tables.updates.update_summary`; angle_bound: degrees, below which faces are remeshed.
    """
    figure, panels = _panels(remarks, angle_bound)
    rows, surfaces = (list(dict.fromkeys(summary[name])) for name in ("setting", "surface"))
    faces = _face_axes(panels[ANGLE], summary)
    for index, surface in enumerate(surfaces):
        runs = summary[summary["surface"] == surface]
        shade, marker = _look(surface)
        places = np.array([rows.index(row) for row in runs["setting"]]) + (index - 0.5) * BAR_WIDTH
        for column, (panel, style) in LINES.items():
            drawn = {"color": shade, "label": f"{surface} {column}", "markersize": 5, "clip_on": False}
            filled = {"markerfacecolor": shade if style == "-" else "white"}
            panels[panel].plot(places, _values(runs, column), marker, **drawn, **filled)
        if faces is not None:
            drawn = {"color": shade, "alpha": BAR_STRENGTH, "label": f"{surface} remeshed_faces"}
            faces.bar(places, runs["remeshed_faces"].to_numpy(), BAR_WIDTH, **drawn)
    for axes in (panels[ANGLE], panels[BALANCE]):
        axes.set_xticks(range(len(rows)), rows, rotation=90)
        axes.set_xlabel("Design row")
    _finish(figure, panels, summary, points=True)
    return figure


def _panels(remarks: Sequence[str], angle_bound: float) -> tuple[Figure, dict[str, Axes]]:
    figure = new_figure(remarks, LARGEST_HEIGHT)
    panels = dict(zip((VOLUMES, STEP, ANGLE, BALANCE), figure.subplots(2, 2, sharex=True).ravel(), strict=True))
    for label, axes in panels.items():
        axes.set_ylabel(label)
    panels[STEP].axhline(1.0, color="black", linewidth=0.8, linestyle=":")
    panels[ANGLE].axhline(angle_bound, color="black", linewidth=0.8, linestyle=":")
    panels[BALANCE].set_yscale("log")
    return figure, panels


def _look(surface: str) -> tuple[str, str]:
    return colour(surface), marker(surface)


def _values(table: pd.DataFrame, column: str) -> np.ndarray:
    return drawn_in_log(table[column]) if column == "balance_error" else table[column].to_numpy(dtype=float)


def _face_axes(angles: Axes, updates: pd.DataFrame) -> Axes | None:
    """Return a second axis for remeshed faces, behind the angles; None where none was remeshed."""
    if not updates["remeshed_faces"].any():
        return None
    faces = angles.twinx()
    faces.set_ylabel(FACES)
    faces.spines["right"].set_visible(True)
    faces.grid(False)
    angles.set_zorder(faces.get_zorder() + 1)
    angles.patch.set_visible(False)
    return faces


def _finish(figure: Figure, panels: dict[str, Axes], table: pd.DataFrame, points: bool = False) -> None:
    remeshed = "" if table["remeshed_faces"].any() else "; no face was remeshed"
    for label, titles in TITLES.items():
        panels[label].set_ylim(bottom=0.0)
        title = titles[points] + (remeshed if label == ANGLE else "")
        panels[label].set_title(title, loc="left", fontsize=SMALLEST_FONT, pad=3)
    errors = table["balance_error"][table["balance_error"] > 0.0]
    if len(errors):  # whole powers of ten, so that there are two to read off
        decades = np.log10([errors.min(), errors.max()])
        panels[BALANCE].set_ylim(10.0 ** np.floor(decades[0]), 10.0 ** (np.floor(decades[1]) + 1.0))
    looks = {surface: _look(surface) for surface in table["surface"]}
    drawn = {"markersize": 4, "linestyle": "" if points else "-"}
    handles = [Line2D([], [], color=shade, marker=mark, label=name, **drawn) for name, (shade, mark) in looks.items()]
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))
