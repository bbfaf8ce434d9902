"""Figures of wear laws side by side: bars of how much and where, maps."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd
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
    named_once,
    new_figure,
    picture,
)
from bulkwear.postproc.tables.depths import area_quantile
from bulkwear.postproc.tables.display import MICROMETRES
from bulkwear.postproc.tables.law_volumes import LawMap

PANELS = {
    "over_archard": "Volume over Archard's (-)",
    "over_first": "Volume over that of the first (-)",
    "overlap": "Wear where Archard's lies (-)",
    "front_share": "Share on fronts of bumps (-)",
}
RATIOS = ("over_archard", "over_first")
MOST_ON_LINEAR = (
    10.0  # -, largest over smallest ratio; beyond it bars go up and down from 1 on an axis of powers of ten
)
TICK_ROOM = 1.1  # times the ends of the bars, how far ticks reach
FEW_DECADES = 1.5  # within which an axis of powers of ten has ticks at three times these too
GROUP = 0.8  # of the distance between settings that bars fill
TOP_SHARE = 0.99  # of the area: more worn spots share the top colour
FEW_PLACES = 4  # along the axis whose names stand level


def law_bars(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw a panel per measure, in it a group of bars per setting, one per law, with 95 % intervals over packings.

    table: as from `tables.law_volumes.laws_of_settings`; measures without a value have no panel
    """
    names = [name for name in PANELS if table[name].notna().any()]
    figure = new_figure(remarks, LARGEST_HEIGHT)
    grid = figure.subplots(max(len(names), 1), 1, sharex=True, squeeze=False)[:, 0]
    words = [column for column in ("setting", "surface", "part") if column in table]
    places = table[words].fillna("").astype(str).agg(lambda row: " ".join(filter(None, row)), axis=1)
    places = places.str.replace("_", " ")
    order, laws = list(dict.fromkeys(places)), list(dict.fromkeys(table["law"]))
    width = GROUP / len(laws)
    for axes, name in zip(grid, names, strict=False):
        positive = table.loc[table[name] > 0.0, name]
        far = name in RATIOS and positive.max() > MOST_ON_LINEAR * positive.min()
        if far:
            axes.set_yscale("log")
            axes.set_yticks(_log_ticks(positive.min(), positive.max()))
            axes.yaxis.set(major_formatter="{x:g}", minor_formatter=NullFormatter())
            axes.axhline(1.0, color="black", linewidth=0.8)
        for number, law in enumerate(laws):
            rows = table[(table["law"] == law) & table[name].notna()]
            at = np.array([order.index(place) for place in places[rows.index]]) + (number + 0.5) * width - GROUP / 2.0
            value = rows[name].to_numpy()
            ends = np.abs(rows[[f"{name}_low", f"{name}_high"]].to_numpy(float).T - value)
            known = {"yerr": ends} if np.isfinite(ends).any() else {}
            look = {"color": SERIES_COLOURS[number % len(SERIES_COLOURS)], "label": law.replace("_", " ")}
            base = 1.0 if far else 0.0
            axes.bar(at, value - base, width, base, error_kw={"elinewidth": 0.9, "capsize": 2}, **known, **look)
        axes.set_title(PANELS[name], loc="left", fontsize=SMALLEST_FONT)  # panels are too low for words at their side
        if not far:
            axes.set_ylim(bottom=0.0)
    grid[-1].set_xticks(range(len(order)), order, rotation=0 if len(order) <= FEW_PLACES else 90)
    figure.legend(*named_once(grid), loc="outside upper left", ncols=len(laws))
    return figure


def _log_ticks(least: float, most: float) -> list[float]:
    """Return ticks of an axis of powers of ten between two ratios on either side of 1."""
    first, last = math.floor(math.log10(least)), math.ceil(math.log10(most))
    steps = (1.0, 3.0) if math.log10(most / least) < FEW_DECADES else (1.0,)
    ticks = [step * 10.0**power for power in range(first, last + 1) for step in steps]
    return [tick for tick in ticks if min(least, 1.0) / TICK_ROOM <= tick <= max(most, 1.0) * TICK_ROOM]


def law_pictures(maps: Sequence[LawMap], remarks: Sequence[str]) -> Figure:
    """Draw the map of each law, seen obliquely from where most wear is, all on one colour scale."""
    figure = new_figure(remarks, LARGEST_HEIGHT)
    if not maps:
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
    return area_quantile(depth, areas(mesh.points, mesh.triangles), TOP_SHARE)
