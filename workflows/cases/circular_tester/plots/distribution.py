"""Figures of where a sample in the circular wear tester wears: by columns, shapes of a pattern, meshes, in sections."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import (
    BASE_COLOUR,
    LARGEST_HEIGHT,
    MAP,
    PATTERN_COLOUR,
    SMALLEST_FONT,
    colour,
    marker,
    named_once,
    new_figure,
)
from bulkwear.postproc.tables.summary import published_value
from bulkwear.workflows.cases.circular_tester.packings import errorbars
from bulkwear.workflows.cases.circular_tester.plots.flow import BAND_COLOUR, BANDS


def by_column(table: pd.DataFrame, unit: str, quantity: str, pattern_words: str, remarks: Sequence[str]) -> Figure:
    """Draw a quantity on base and pattern per column of the sample, a panel per surface (Fig 6.13, 6.22).

    table: as from `distribution.columns_over_packings`; quantity: what the axis says, with its unit; pattern_words:
    what the pattern bears, ours and published.
    """
    figure = new_figure(remarks)
    surfaces = list(dict.fromkeys(table["surface"]))
    grid = figure.subplots(1, len(surfaces), sharey=True, squeeze=False)[0]
    base, bumps, total = (f"{name}_{unit}" for name in ("base", "bumps", "total"))
    for axes, surface in zip(grid, surfaces, strict=True):
        rows = table[table["surface"] == surface]
        axes.bar(rows["column"], rows[base], color=BASE_COLOUR, label="base")
        look = {"color": PATTERN_COLOUR, "hatch": "//", "edgecolor": "white", "label": "pattern"}
        axes.bar(rows["column"], rows[bumps], bottom=rows[base], **look)
        reach = errorbars(rows, total)
        if np.isfinite(reach).any():
            axes.errorbar(rows["column"], rows[total], reach, fmt="none", ecolor="black", capsize=3)
        words = f": {pattern_words}" if rows[bumps].any() else ""
        axes.set_title("\n".join(textwrap.wrap(f"{surface}{words}", 60)), loc="left", fontsize=SMALLEST_FONT)
        axes.set_xlabel("Column, 1 where the bed arrives")
        axes.set_xticks(rows["column"])
    grid[0].set_ylabel(quantity)
    figure.legend(*named_once(grid), loc="outside upper center", ncols=2)
    return figure


def by_bump(
    table: pd.DataFrame, published: pd.DataFrame | None, revolutions: tuple[float, float], remarks: Sequence[str]
) -> Figure:
    """Draw what every shape of a pattern loses per revolution (mm3), columns apart, on the published ranges (Fig 6.14).

    table: bump, row, volume_mm3, and the interval over packings; published: None without such ranges; revolutions: of
    ours, and those of ours that the published volumes take.
    """
    ours, theirs = revolutions
    figure = new_figure(remarks)
    axes = figure.subplots()
    places = np.arange(len(table))
    for row, of_row in table.groupby("row"):
        there = places[(table["row"] == row).to_numpy()]
        if published is not None:
            names = [f"{end}_bump_volume_{'odd' if row % 2 else 'even'}" for end in ("least", "largest")]
            ends = [published_value(published, name, "simulation") / theirs for name in names]
            words = "range of the column's bumps, Yan 2022"
            axes.fill_between([there[0] - 0.5, there[-1] + 0.5], *ends, color=BAND_COLOUR, zorder=0, label=words)
        reach = errorbars(of_row, "volume_mm3") / ours
        bars = {"yerr": reach, "capsize": 2.0} if np.isfinite(reach).any() else {}
        axes.bar(there, of_row["volume_mm3"] / ours, color=PATTERN_COLOUR, **bars)
    axes.set_xticks(places, table["bump"], rotation=90)
    said = f"means over {ours:.3g} revolutions" + (f", Yan 2022 over {theirs:.3g}" if published is not None else "")
    axes.set_title(said, loc="left", fontsize=SMALLEST_FONT)
    axes.set_ylabel("Worn volume of a shape\nper revolution (mm³)")
    figure.legend(*named_once([axes]), loc="outside upper center")
    return figure


def mesh_size(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the volume over that of the plain sample on the finest mesh against mesh size (Fig 6.8).

    table: as from `distribution.mesh_size_effect`.
    """
    figure = new_figure(remarks)
    axes = figure.subplots()
    for surface, rows in table.groupby("surface", sort=False):
        ends = rows["relative_percent"].min(), rows["relative_percent"].max()
        name = f"{surface}, {ends[0]:.3g} to {ends[1]:.3g} % over the meshes"
        look = {"color": colour(surface), "marker": marker(surface), "markersize": 5, "linewidth": 1.0}
        reach = errorbars(rows, "relative_percent")
        bars = {"yerr": reach, "capsize": 2.5} if np.isfinite(reach).any() else {}
        axes.errorbar(rows["element_size_mm"], rows["relative_percent"], label=name, **look, **bars)
        theirs = published[published["quantity"] == f"{surface}_relative_volume"]
        for each in theirs.itertuples():
            low, high = each.value - each.uncertainty, each.value + each.uncertainty
            words = f"{surface}, Yan 2022: {each.value:g} %, deviation {each.uncertainty:g} %"
            axes.axhspan(low, high, color=colour(surface), alpha=BANDS, linewidth=0.0, label=words)
    axes.set(
        xlabel="Element size (mm)", ylabel="Volume over the finest plain mesh's (%)", ylim=(0.0, None), xlim=(0.0, None)
    )
    figure.legend(*named_once([axes]), loc="outside upper center", ncols=2)
    return figure


def worn_contours(contours: pd.DataFrame, title: str, remarks: Sequence[str]) -> Figure:
    """Draw sections of a pattern of several surfaces, side view above, front view below (Fig 6.9, 6.16).

    contours: as from `distribution.worn_contours`; title: what the legend lists, such as "revolution".
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    bumps, names = list(dict.fromkeys(contours["bump"])), list(dict.fromkeys(contours["name"]))
    shades = colormaps[MAP](np.linspace(0.9, 0.0, len(names)))
    grid = figure.subplots(2, len(bumps), sharex="row", sharey=True, squeeze=False)
    for line, (view, across) in zip(grid, {"side": "Along", "front": "Across"}.items(), strict=True):
        for axes, bump in zip(line, bumps, strict=True):
            for name, shade in zip(names, shades, strict=True):
                rows = contours[(contours["bump"] == bump) & (contours["view"] == view) & (contours["name"] == name)]
                axes.plot(rows["along_mm"], rows["height_mm"], color=shade, linewidth=1.0, label=name)
            axes.set_title(f"{bump}, {view}", loc="left", fontsize=SMALLEST_FONT)
        line[len(line) // 2].set_xlabel(f"{across} the travel from the middle (mm)")
        line[0].set_ylabel("Height (mm)")
    figure.legend(*grid[0, 0].get_legend_handles_labels(), title=title, loc="outside right center")
    return figure
