"""Figures made of rendered pictures: worn surfaces and the bed, with axes, colour bars and remarks."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from bulkwear.postproc.mesh import SurfaceMesh, areas, worn_faces
from bulkwear.postproc.plots.scene import (
    bed_bounds,
    bed_picture,
    common_bounds,
    surface_oblique,
    surface_plan,
    trimmed,
    worn_side,
)
from bulkwear.postproc.plots.style import LARGEST_HEIGHT, MAP, SMALLEST_FONT, WIDTH, new_figure, picture, scaled
from bulkwear.postproc.tables.depths import area_quantile, depth_quantity, face_depth
from bulkwear.postproc.tables.display import MICROMETRES, SQUARE_MILLIMETRES, in_display_units

SCALE_ROOM = 1.1  # inches, of a figure's width for its colour bar
TITLE_LINE = 0.16  # inches, of a line of a title
TITLE_CHARACTERS = 14.0  # of a title per inch
TITLE_LINES = 3  # of a title at most
MAPS_HEIGHT = 4.4  # inches, of a figure with maps side by side
MOST_VIEWS = 4  # surfaces obliquely side by side
MOST_ROWS = 18  # design rows from above: of more, maps would be smaller than their bumps can be seen in
FAR_WORN = 30.0  # -, over the median of the runs' depths: a run worn deeper does not set their scale
TOP_SHARE = 0.99  # of the worn area: deeper spots share the top colour


def colour_limits(depths: pd.DataFrame) -> tuple[float, float]:
    """Return the colour scale (um) of all runs of a figure: 0 to the depth that 99 % of the worn area of
    the run with the deepest wear does not exceed; runs that are `beyond_scale` do not count.

    depths: as from `tables.depths.depth_table`.
    """
    tops = _tops(depths)
    return 0.0, max([*tops.drop(beyond_scale(depths)), np.finfo(float).tiny])


def beyond_scale(depths: pd.DataFrame) -> list[str]:
    """Return the runs that are worn so many times as deep as most that on their scale the others would look unworn."""
    tops = _tops(depths)
    worn = tops[tops > 0.0]
    return list(worn.index[worn > FAR_WORN * worn.median()]) if len(worn) else []


def _tops(depths: pd.DataFrame) -> pd.Series:
    """Return the depth (um) by run that 99 % of its worn area does not exceed."""
    return pd.Series(
        {
            run: area_quantile(faces["depth_um"].to_numpy(), faces["area_mm2"].to_numpy(), TOP_SHARE)
            for run, faces in depths.groupby("run", sort=False)
        },
        dtype=float,
    )


def _beyond_remark(depths: pd.DataFrame) -> list[str]:
    deeper = [run.replace("_", " ") for run in beyond_scale(depths)]
    return [f"worn over {FAR_WORN:g} times as deep as most, beyond the scale: {', '.join(deeper)}"] if deeper else []


def worn_surface(
    meshes: Mapping[str, SurfaceMesh],
    runs: pd.DataFrame,
    deformed: bool,
    depths: pd.DataFrame,
    quantity: str,
    remarks: Sequence[str],
) -> Figure:
    """Draw worn surfaces, all runs on one colour scale: obliquely and from above for one row, else from above only; of
    more than MOST_ROWS rows the first and the least worn ones.

    meshes: by run; runs: run, row, surface; depths: as from `tables.depths.depth_table`; quantity: what the colour is.
    """
    rows = list(dict.fromkeys(runs["row"]))
    if len(rows) > MOST_ROWS:
        runs = _least_worn(runs, depths, MOST_ROWS)
        remarks = [*remarks, f"of {len(rows)} rows the first and the {MOST_ROWS - 1} least worn ones are shown"]
        depths = depths[depths["run"].isin(runs["run"])]
    several = len(rows) > 1
    figure = new_figure([*remarks, *_beyond_remark(depths)], LARGEST_HEIGHT, compressed=several)
    limits, bounds = colour_limits(depths), common_bounds(meshes.values())
    unit, ticks = scaled("µm", limits[1])
    if several:
        grid = _small_multiples(figure, meshes, runs, deformed, limits)
        _colour_bar(figure, grid, limits, f"{quantity} ({unit})", ticks)
        return figure
    grid = figure.subplots(2, len(runs), squeeze=False)
    for column, run in enumerate(runs["run"]):
        picture(grid[0, column], surface_oblique(meshes[run], deformed, limits, bounds))
        grid[0, column].set_title(run.replace("_", " "))
        picture(grid[1, column], *surface_plan(meshes[run], deformed, limits))
        grid[1, column].set(xlabel="Across the travel, x (mm)", ylabel="y (mm)\nbed moves to +y →")
    _colour_bar(figure, grid, limits, f"{quantity} ({unit})", ticks)
    return figure


def _least_worn(runs: pd.DataFrame, depths: pd.DataFrame, most: int) -> pd.DataFrame:
    """Return the runs of the first design row and of those whose least worn run has the smallest mean depth."""
    worn = depths.assign(volume=depths["depth_um"] * depths["area_mm2"]).groupby("run")[["volume", "area_mm2"]].sum()
    mean = runs["run"].map(worn["volume"] / worn["area_mm2"])
    first, *others = mean.groupby(runs["row"], sort=False).min().items()
    kept = [first, *sorted(others, key=lambda each: each[1])[: most - 1]]
    return runs[runs["row"].isin([row for row, _ in kept])].reset_index(drop=True)


def surface_views(
    meshes: Mapping[str, SurfaceMesh], deformed: bool, depths: pd.DataFrame, quantity: str, remarks: Sequence[str]
) -> Figure:
    """Draw worn surfaces obliquely side by side, from where their wear is seen, all on one colour scale; of more than
    MOST_VIEWS the first ones.

    meshes: by run; depths: as from `tables.depths.depth_table`; quantity: what the colour is
    """
    shown = dict(list(meshes.items())[:MOST_VIEWS])
    if len(shown) < len(meshes):
        remarks = [*remarks, f"the first {len(shown)} of {len(meshes)} runs are shown"]
    figure = new_figure([*remarks, *_beyond_remark(depths)], LARGEST_HEIGHT)
    limits, bounds = colour_limits(depths), common_bounds(shown.values())
    seen_from = worn_side(shown.values(), deformed)
    views = trimmed([surface_oblique(mesh, deformed, limits, bounds, direction=seen_from) for mesh in shown.values()])
    height, width = views[0].shape[:2]
    columns = len(shown) if height > width else math.ceil(math.sqrt(len(shown)))
    grid = figure.subplots(math.ceil(len(shown) / columns), columns, squeeze=False)
    for axes in grid.ravel()[len(shown) :]:
        axes.set_axis_off()
    for axes, run, pixels in zip(grid.ravel(), shown, views, strict=False):
        picture(axes, pixels)
        axes.set_title(run.replace("_", " "))
    unit, ticks = scaled("µm", limits[1])
    _colour_bar(figure, grid, limits, f"{quantity} ({unit})", ticks)
    return figure


def draw_surface(mesh: SurfaceMesh, title: str = "") -> Figure:
    """Draw one worn surface obliquely, coloured by its removed thickness (`removed_thickness_m`).

    mesh: m, as from `postproc.wear.update.wear_update`, or the worn_surface.vtu of a run
    """
    worn = worn_faces(mesh)
    area, depth = areas(mesh.points, mesh.triangles)[worn], face_depth(mesh, True)[worn] * MICROMETRES
    limits = colour_limits(pd.DataFrame({"run": "", "area_mm2": area * SQUARE_MILLIMETRES, "depth_um": depth}))
    figure = new_figure([])
    axes = figure.subplots()
    picture(axes, trimmed([surface_oblique(mesh, True, limits, common_bounds([mesh]))])[0])
    axes.set_title(title)
    unit, ticks = scaled("µm", limits[1])
    _colour_bar(figure, axes, limits, f"{depth_quantity(True)} ({unit})", ticks)
    return figure


def _colour_bar(figure: Figure, grid: np.ndarray, limits: tuple[float, float], label: str, ticks=None) -> None:
    bar = ScalarMappable(Normalize(*limits), MAP)
    figure.colorbar(
        bar, ax=grid, label=label, format=ticks, extend="max", shrink=0.85, aspect=30, pad=0.02, fraction=0.06
    )


def _small_multiples(
    figure: Figure,
    meshes: Mapping[str, SurfaceMesh],
    runs: pd.DataFrame,
    deformed: bool,
    limits: tuple[float, float],
) -> np.ndarray:
    """Draw all runs from above without skirt, those of a design row below each other; return the axes."""
    rows, lines = list(dict.fromkeys(runs["row"])), runs.groupby("row").cumcount()
    deep = int(lines.max()) + 1
    plans = {run: surface_plan(meshes[run], deformed, limits, 300, skirt=False)[0] for run in runs["run"]}
    height, width = np.max([pixels.shape[:2] for pixels in plans.values()], axis=0)
    room = figure.get_figheight() * figure.get_layout_engine().get()["rect"][3]
    columns = _columns(rows, deep, width / height, (WIDTH - SCALE_ROOM, room))
    wrapped = _wrapped(rows, columns, WIDTH - SCALE_ROOM)
    grid = figure.subplots(math.ceil(len(rows) / columns) * deep, columns, squeeze=False)
    for axes in grid.ravel():
        axes.set_axis_off()
    for run, line in zip(runs.itertuples(), lines, strict=True):
        block, column = divmod(rows.index(run.row), columns)
        axes = grid[block * deep + line, column]
        picture(axes, plans[run.run])
        if line == 0:
            axes.set_title(wrapped[run.row], fontsize=SMALLEST_FONT, pad=3)
        if column == 0 and deep > 1:
            place = {"rotation": 90, "va": "center", "ha": "right", "fontsize": SMALLEST_FONT}
            axes.text(-0.06, 0.5, run.surface, transform=axes.transAxes, **place)
    return grid


def _columns(rows: Sequence[str], deep: int, aspect: float, room: tuple[float, float]) -> int:
    """Return how many columns of pictures make them largest, their titles included.

    deep: pictures of a row below each other; aspect: width over height of a picture; room: width, height, inches
    """

    def height(columns: int) -> float:
        lines = max(name.count("\n") + 1 for name in _wrapped(rows, columns, room[0]).values())
        blocks = math.ceil(len(rows) / columns)
        return min(room[0] / columns / aspect, (room[1] / blocks - lines * TITLE_LINE) / deep)

    return max(range(1, len(rows) + 1), key=height)


def _wrapped(names: Sequence[str], columns: int, width: float) -> dict[str, str]:
    """Return names in as many lines as their column asks for; width: inches, of all columns."""
    letters = max(int(width / columns * TITLE_CHARACTERS), 1)
    wide = [max(letters, math.ceil(len(name) / TITLE_LINES)) for name in names]
    return {name: "\n".join(textwrap.wrap(name, most)) for name, most in zip(names, wide, strict=True)}


def wear_maps(
    meshes: Mapping[str, SurfaceMesh],
    runs: pd.DataFrame,
    deformed: bool,
    depths: pd.DataFrame,
    quantity: str,
    remarks: Sequence[str],
) -> Figure:
    """Draw worn surfaces from above without skirt side by side, all on one colour scale, surface by surface.

    meshes: by run; runs: run, surface and particle_scale; the others as for `worn_surface`
    """
    figure = new_figure(remarks, MAPS_HEIGHT)
    limits, ordered = colour_limits(depths), runs.sort_values("surface", kind="stable")
    grid = figure.subplots(1, len(runs), sharey=True, squeeze=False)
    for axes, run in zip(grid[0], ordered.itertuples(), strict=True):
        picture(axes, *surface_plan(meshes[run.run], deformed, limits, 600, skirt=False))
        axes.set_title(f"{run.surface} sample,\nparticle scale {run.particle_scale:g}", fontsize=SMALLEST_FONT)
        axes.set_xlabel("x (mm)")
    grid[0, 0].set_ylabel("y (mm)\nbed moves to +y →")
    unit, ticks = scaled("µm", limits[1])
    place = {"location": "bottom", "shrink": 0.6, "aspect": 40, "pad": 0.04}
    bar = ScalarMappable(Normalize(*limits), MAP)
    figure.colorbar(bar, ax=grid, label=f"{quantity} ({unit})", format=ticks, extend="max", **place)
    return figure


def bed(
    cuts: Mapping[str, pd.DataFrame],
    meshes: Mapping[str, SurfaceMesh],
    remarks: Sequence[str],
) -> Figure:
    """Draw the bed over the sample, cut open along the travel, one picture per run; colour: speed over the
    sample.

    cuts: particles by run, as from `flow.bed.behind_cut`; meshes: worn surfaces by run.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT, compressed=True)
    limits = (0.0, max(float(cut["speed_m_per_s"].quantile(0.98)) for cut in cuts.values()))
    grid = figure.subplots(len(cuts), 1, squeeze=False)[:, 0]
    bounds = bed_bounds(cuts.values(), meshes.values())
    pictures = trimmed([bed_picture(cut, meshes[run], limits, bounds) for run, cut in cuts.items()])
    for axes, run, pixels in zip(grid, cuts, pictures, strict=True):
        picture(axes, pixels)
        axes.set_title(f"{run.replace('_', ' ')}, the bed moves to the right", fontsize=SMALLEST_FONT, pad=3)
    bar = ScalarMappable(Normalize(*limits), MAP)
    figure.colorbar(
        bar, ax=grid, label="Particle speed relative to the sample (m/s)", extend="max", shrink=0.85, pad=0.02
    )
    return figure


def bed_table(cuts: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return the particles of the figure `bed` in display units: run, id, place and radius in mm, speed in
    m/s.
    """
    return in_display_units(pd.concat([cut.assign(run=run) for run, cut in cuts.items()], ignore_index=True))
