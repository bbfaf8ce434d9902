"""Figures of wear laws side by side: bars of how much and where, maps."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from bulkwear.postproc.mesh import SurfaceMesh, areas
from bulkwear.postproc.plots.scene import common_bounds, depth_oblique, facing_side, trimmed
from bulkwear.postproc.plots.style import (
    LARGEST_HEIGHT,
    MAP,
    SERIES_COLOURS,
    SMALLEST_FONT,
    height_of_pictures,
    named_once,
    new_figure,
    picture,
)
from bulkwear.postproc.tables.depths import area_quantile
from bulkwear.postproc.tables.display import MICROMETRES
from bulkwear.postproc.tables.law_volumes import LawMap

PANELS = {
    "over_archard": "Volume over\nArchard's (-)",
    "over_first": "Volume over that\nof the first (-)",
    "overlap": "Wear where\nArchard's lies (-)",
    "front_share": "Share on fronts\nof bumps (-)",
}
RATIOS = ("over_archard", "over_first")
MOST_ON_LINEAR = 10.0  # -, largest over smallest ratio; beyond it bars go both ways from 1 on an axis of powers of ten
TICK_ROOM = 1.1  # times the ends of the bars, how far ticks reach
FEW_DECADES = 1.5  # within which an axis of powers of ten has ticks at three times these too
GROUP = 0.8  # of the distance between settings that bars fill
MOST_IN_COLUMN = 28  # names of rows under one another, that do not touch
LETTER_WIDTH = 0.58  # of the size of its font, in the mean of a name's letters and a little more
TOP_SHARE = 0.99  # of the area: more worn spots share the top colour


def law_bars(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw a panel per measure side by side, in it a group of bars per setting, one per law, from top to bottom, with
    95 % intervals over packings.

    table: as from `tables.law_volumes.laws_of_settings`; measures without a value have no panel
    """
    names = [name for name in PANELS if table[name].notna().any()]
    figure = new_figure(remarks, LARGEST_HEIGHT)
    grid = figure.subplots(1, max(len(names), 1), sharey=True, squeeze=False)[0]
    places = _places(table)
    order, laws = list(dict.fromkeys(places)), list(dict.fromkeys(table["law"]))
    thick = GROUP / len(laws)
    for axes, name in zip(grid, names, strict=False):
        base = _ratios_from_one(axes, table[name]) if name in RATIOS else 0.0
        for number, law in enumerate(laws):
            rows = table[(table["law"] == law) & table[name].notna()]
            at = np.array([order.index(place) for place in places[rows.index]]) + (number + 0.5) * thick - GROUP / 2.0
            value = rows[name].to_numpy()
            ends = np.abs(rows[[f"{name}_low", f"{name}_high"]].to_numpy(float).T - value)
            known = {"xerr": ends} if np.isfinite(ends).any() else {}
            look = {"color": SERIES_COLOURS[number % len(SERIES_COLOURS)], "label": law.replace("_", " ")}
            axes.barh(at, value - base, thick, base, error_kw={"elinewidth": 0.9, "capsize": 2}, **known, **look)
        axes.set_title(PANELS[name], loc="left", fontsize=SMALLEST_FONT)
        axes.tick_params(axis="y", which="both", length=0)
        axes.grid(visible=False, axis="y")
        if base == 0.0:
            axes.set_xlim(left=0.0)
    _name_rows(grid[0], order)
    figure.legend(*named_once(grid), loc="outside upper left", ncols=len(laws))
    return figure


def _name_rows(axes: Axes, names: Sequence[str]) -> None:
    """Put names beside rows, the first on top; of many every other one further out, at the end of a line."""
    columns = 1 if len(names) <= MOST_IN_COLUMN else 2
    axes.set_yticks(range(0, len(names), columns), names[::columns])
    axes.set_ylim(len(names) - 0.5, -0.5)
    if columns > 1:
        out = LETTER_WIDTH * SMALLEST_FONT * max(map(len, names[::columns]))
        axes.set_yticks(range(1, len(names), columns), names[1::columns], minor=True)
        axes.tick_params(axis="y", which="minor", length=out, width=0.4, color="0.75", labelsize=SMALLEST_FONT)


def _places(table: pd.DataFrame) -> pd.Series:
    """Return what stands beside each row's bars: setting and, where a setting has several, surface or part."""
    words = [column for column in ("setting", "surface", "part") if column in table]
    told = table[words].fillna("").astype(str)
    if told.drop_duplicates()["setting"].is_unique:
        told = told[["setting"]]
    return told.agg(lambda row: " ".join(filter(None, row)), axis=1).str.replace("_", " ")


def _ratios_from_one(axes: Axes, ratios: pd.Series) -> float:
    """Return where bars of ratios begin: at 0, or at 1 on an axis of powers of ten that they ask for."""
    positive = ratios[ratios > 0.0]
    if not positive.max() > MOST_ON_LINEAR * positive.min():
        return 0.0
    axes.set_xscale("log")
    axes.set_xticks(_log_ticks(positive.min(), positive.max()))
    axes.xaxis.set(major_formatter="{x:g}", minor_formatter=NullFormatter())
    axes.axvline(1.0, color="black", linewidth=0.8)
    return 1.0


def _log_ticks(least: float, most: float) -> list[float]:
    """Return ticks of an axis of powers of ten between two ratios on either side of 1."""
    first, last = math.floor(math.log10(least)), math.ceil(math.log10(most))
    steps = (1.0, 3.0) if math.log10(most / least) < FEW_DECADES else (1.0,)
    ticks = [step * 10.0**power for power in range(first, last + 1) for step in steps]
    return [tick for tick in ticks if min(least, 1.0) / TICK_ROOM <= tick <= max(most, 1.0) * TICK_ROOM]


def law_pictures(maps: Sequence[LawMap], remarks: Sequence[str]) -> Figure:
    """Draw the map of each law, seen obliquely from where most wear is, all on one colour scale."""
    if not maps:
        figure = new_figure(remarks, LARGEST_HEIGHT)
        figure.text(0.5, 0.5, "nothing wears", ha="center")
        return figure
    shown = [_worn_alone(each) for each in maps]
    limits = (0.0, max(_top(mesh, depth) for mesh, depth in shown))
    bounds = common_bounds([mesh for mesh, _ in shown])
    direction = facing_side(*shown[0])
    views = trimmed(
        [
            depth_oblique(mesh, depth / MICROMETRES, limits, bounds, size=(1000, 720), direction=direction)
            for mesh, depth in shown
        ]
    )
    columns = len(maps) if len(maps) <= 3 else math.ceil(len(maps) / 2)
    figure = new_figure(remarks, height_of_pictures(views, columns))
    grid = figure.subplots(math.ceil(len(maps) / columns), columns, squeeze=False)
    for axes in grid.ravel():
        axes.set_axis_off()
    for axes, each, pixels in zip(grid.ravel(), maps, views, strict=False):
        picture(axes, pixels)
        axes.set_title(each.law.replace("_", " "), fontsize=SMALLEST_FONT)
    bar = ScalarMappable(Normalize(*limits), MAP)
    place = {"location": "bottom", "shrink": 0.6, "aspect": 40, "pad": 0.04, "extend": "max"}
    figure.colorbar(bar, ax=grid, label="Depth over the mean depth of all that wears (-)", **place)
    return figure


def _worn_alone(shown: LawMap) -> tuple[SurfaceMesh, np.ndarray]:
    """Return the faces that wear as a surface of their own, and their relative depth."""
    worn = np.isfinite(shown.relative_depth)
    mesh = SurfaceMesh(shown.surface.points, shown.surface.triangles[worn])
    used, triangles = np.unique(mesh.triangles, return_inverse=True)
    alone = SurfaceMesh(mesh.points[used], triangles.reshape(-1, 3))
    return alone, shown.relative_depth[worn]


def _top(mesh: SurfaceMesh, depth: np.ndarray) -> float:
    """Return the depth at which the scale ends; where next to nothing of a surface wears, that of what does."""
    area, worn = areas(mesh.points, mesh.triangles), depth > 0.0
    return area_quantile(depth, area, TOP_SHARE) or area_quantile(depth[worn], area[worn], TOP_SHARE)
