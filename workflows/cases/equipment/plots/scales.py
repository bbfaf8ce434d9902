"""Scales of colour that maps of parts share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Colormap, LogNorm, Normalize
from matplotlib.figure import Figure

from bulkwear.postproc.mesh import areas
from bulkwear.postproc.plots.style import MAP, SMALLEST_FONT
from bulkwear.postproc.tables.depths import area_quantile
from bulkwear.workflows.cases.equipment.pictures import PartMap
from bulkwear.workflows.cases.equipment.plots.panels import Box, part_of

TOP_SHARE = 0.99  # of the area that has a value: higher ones share the top colour
FAR_BELOW = 0.1  # -, of the highest part's top: a part whose own top is lower would be of one colour
BELOW_LOWEST, MOST_DECADES = 0.1, 4  # where a scale of decades begins: of the lowest part's top, and below the highest


def top_of(maps: Sequence[PartMap], quantity: str) -> float:
    """Return the value that 99 % of the area with one does not exceed, of the map where that is highest."""
    return max([*tops_of(maps, quantity), np.finfo(float).tiny])


def tops_of(maps: Sequence[PartMap], quantity: str) -> list[float]:
    """Return the value that 99 % of the area with one does not exceed, of each map that has any."""
    tops = []
    for shown in maps:
        values, area = shown.values[quantity], areas(shown.mesh.points, shown.mesh.triangles)
        there = np.isfinite(values) & (values > 0.0)
        if there.any():
            tops.append(area_quantile(values[there], area[there], TOP_SHARE))
    return tops


def scale_of(maps: Sequence[PartMap], quantity: str) -> Normalize:
    """Return the scale from 0 that all maps share, or one of decades where a part is far below another one.

    The lowest part is the one whose highest map is lowest.
    """
    parts = dict.fromkeys(each.part for each in maps)
    tops = [max(tops_of([each for each in maps if each.part == part], quantity), default=0.0) for part in parts]
    worn = [top for top in tops if top > 0.0]
    if not worn or min(worn) >= FAR_BELOW * max(worn):
        return Normalize(0.0, top_of(maps, quantity))
    return LogNorm(max(BELOW_LOWEST * min(worn), max(worn) / 10.0**MOST_DECADES), max(worn))


def on_scale(maps: Sequence[PartMap], quantity: str, scale: Normalize) -> list[PartMap]:
    """Return maps with a quantity as shares of a scale, 0 to 1; below and beyond it as its ends, NaN as it is."""
    values = (np.asarray(scale(np.clip(each.values[quantity], scale.vmin, scale.vmax))) for each in maps)
    return [replace(each, values={**each.values, quantity: share}) for each, share in zip(maps, values, strict=True)]


def colour_bar(
    figure: Figure,
    box: Box,
    scale: Normalize,
    label: str,
    extend: str = "max",
    colours: str | Colormap = MAP,
    **look: object,
) -> Colorbar:
    """Draw a colour bar into a box; one of decades holds lower values as well."""
    axes = figure.add_axes(part_of(figure, box))
    extend = "both" if isinstance(scale, LogNorm) else extend
    bar = figure.colorbar(ScalarMappable(scale, colours), cax=axes, extend=extend, **look)
    bar.set_label(label)
    return bar


def second_scale(bar: Colorbar, factor: float) -> None:
    """Write the scale of a bar once more on its other side, per Mt."""
    other = bar.ax.secondary_yaxis("left", functions=(lambda value: factor * value, lambda value: value / factor))
    other.set_ylabel("mm per Mt", fontsize=SMALLEST_FONT)
    other.tick_params(labelsize=SMALLEST_FONT)
