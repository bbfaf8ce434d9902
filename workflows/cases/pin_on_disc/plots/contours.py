"""Contours of a worn disc: how they are taken, along the revolutions, their distribution, and by mesh."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import (
    LARGEST_HEIGHT,
    MAP,
    OTHER_COLOUR,
    PUBLISHED,
    SMALLEST_FONT,
    named_once,
    new_figure,
)
from bulkwear.postproc.tables.display import MICROMETRES, MILLIMETRES
from bulkwear.workflows.cases.pin_on_disc.run_in import SIGNIFICANCE, SIZES

SCHEME_COLOURS = {"conserving": "#0072B2", "per_triangle": "#D55E00"}
SCHEME_NAMES = {"conserving": "conserving", "per_triangle": "per triangle (Yan 2022, Eq 5.7)"}
SCHEME_MARKERS = {"conserving": "o", "per_triangle": "s"}
LAW_COLOUR = "#009E73"
LABORATORY_COLOUR = "#CC79A7"
UNITS = {"depth": ("µm", MICROMETRES), "opening width": ("mm", MILLIMETRES)}
AXIS_NAMES = {
    "depth": "Depth (µm)",
    "opening width": "Opening width (mm)",
    "width of 95 % of the area": "Width of 95 % of the area (mm)",
}
LEAST_P_VALUE = 1e-6  # smaller ones are drawn here: 0 has no place on a log axis
RIM_DEPTH = 0.01  # -, of the deepest section: what is drawn ends a little beyond
ROOM = 1.25  # -, of what is worn
BOX_STEP = 0.2  # revolutions that the boxes of two forces stand beside their revolution
FORCE_COLOUR = "#009E73"
BAND_COLOUR = "#dddddd"  # of published ranges, behind what is simulated
TITLE_CHARACTERS = 48  # of a line above one of two panels
SIDE_STEP = 0.12  # revolutions that two schemes stand apart


def coefficient_name(coefficient: float) -> str:
    """A wear coefficient (1/Pa) as people read it."""
    exponent = f"{coefficient:.1e}".partition("e")[2]
    digits = coefficient / 10.0 ** int(exponent)
    return rf"$\alpha$ = {digits:.3g}·10$^{{{int(exponent)}}}$ Pa$^{{-1}}$"


def _axis(size: str) -> tuple[str, float]:
    """Label of a size's axis, and factor from m."""
    return AXIS_NAMES[size], UNITS.get(size, ("mm", MILLIMETRES))[1]


def run_in(
    statistics: pd.DataFrame, published: pd.DataFrame, found: Mapping[str, str], remarks: Sequence[str]
) -> Figure:
    """Draw depth and opening per revolution with mean, deviation and extremes, and the p values of both below.

    statistics : as from `run_in.revolution_statistics`, with `scheme`, one run per scheme;
    published : `revolution`, `depth_p_value`, `width_p_value`; found : what to say of each panel's run-in, by size.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    grid = figure.subplots(2, 2, sharex=True, height_ratios=(3, 2))
    columns = {"depth": "depth_p_value", "opening width": "width_p_value"}
    for (upper, lower), (size, column) in zip(grid.T, columns.items(), strict=True):
        label, factor = _axis(size)
        of_size = statistics[statistics["size"] == size]
        for index, (scheme, rows) in enumerate(of_size.groupby("scheme", sort=False)):
            _spread(upper, rows, factor, scheme, SIDE_STEP * (2 * index - 1))
            _p_values(lower, rows["revolution"], rows["p_value"], "o-", scheme)
        lower.plot(
            published["revolution"],
            published[column].clip(lower=LEAST_P_VALUE),
            "x",
            label="Yan 2022, Table 5.3",
            **(PUBLISHED | {"linestyle": ":"}),
        )
        lower.axhline(SIGNIFICANCE, color=OTHER_COLOUR, linewidth=0.8)
        lower.set(yscale="log", ylim=(0.5 * LEAST_P_VALUE, 2.0), xlabel="Revolution")
        upper.set_ylim(bottom=0.0)
        upper.set_ylabel(label)
        upper.set_title(textwrap.fill(found[size], TITLE_CHARACTERS), loc="left", fontsize=SMALLEST_FONT)
    grid[1, 0].set_ylabel("p of normality (-)")
    figure.legend(*named_once(grid[:, 0]), loc="outside upper center", ncols=3)
    return figure


def _spread(axes: Axes, rows: pd.DataFrame, factor: float, scheme: str, shift: float) -> None:
    """Mean with standard deviation, and a thin line from the least to the largest."""
    colour, place = SCHEME_COLOURS[scheme], rows["revolution"] + shift
    axes.vlines(place, factor * rows["least_m"], factor * rows["largest_m"], color=colour, linewidth=0.7)
    look = {"fmt": SCHEME_MARKERS[scheme], "markersize": 4, "color": colour, "capsize": 2.5, "elinewidth": 2.0}
    axes.errorbar(place, factor * rows["mean_m"], factor * rows["deviation_m"], label=SCHEME_NAMES[scheme], **look)


def _p_values(axes: Axes, revolution: pd.Series, p_value: pd.Series, style: str, scheme: str) -> None:
    look = {"color": SCHEME_COLOURS[scheme], "markersize": 3.5, "linewidth": 0.8}
    axes.plot(revolution, p_value.clip(lower=LEAST_P_VALUE), style, **look)


def contour_distribution(
    contours: pd.DataFrame,
    histograms: Mapping[tuple[str, str], pd.DataFrame],
    ranges: pd.DataFrame,
    remarks: Sequence[str],
) -> Figure:
    """Draw depth and opening of the 360 contours round the disc, and how they are distributed beside the normal curve.

    contours : `scheme`, `angle_deg` and sizes (m) after one revolution; histograms : by (scheme, size), as from
    `run_in.size_histogram` in m; ranges : published ones, `size`, `least_m`, `largest_m`, `label`.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    grid = figure.subplots(2, 2, sharey="row", width_ratios=(3, 2))
    for (left, right), (size, column) in zip(grid, tuple(SIZES.items())[:2], strict=True):
        label, factor = _axis(size)
        for band in ranges[ranges["size"] == size].itertuples():
            bounds = (factor * band.least_m, factor * band.largest_m)
            left.axhspan(*bounds, color=BAND_COLOUR, label=band.label, zorder=0)
            right.axhspan(*bounds, color=BAND_COLOUR, zorder=0)
        said = []
        for scheme, rows in contours.groupby("scheme", sort=False):
            colour = SCHEME_COLOURS[scheme]
            left.plot(rows["angle_deg"], factor * rows[column], ".", markersize=3, color=colour)
            bars = histograms[scheme, size]
            middle, height = 0.5 * factor * (bars["from"] + bars["to"]), factor * (bars["to"] - bars["from"])
            right.barh(middle, bars["count"], height, color=colour, alpha=0.45, label=SCHEME_NAMES[scheme])
            right.plot(
                bars["normal_count"], middle, color=colour, linewidth=1.2, label="normal, same mean and deviation"
            )
            said.append(f"{scheme.replace('_', ' ')} {bars['p_value'].iloc[0]:.2g}")
        right.set_title(f"p: {', '.join(said)}", loc="left", fontsize=SMALLEST_FONT)
        left.set_ylabel(label)
        left.set_xticks(range(0, 361, 60))
    named = [axes.get_legend_handles_labels() for axes in (grid[0, 1], *grid[:, 0])]
    handles, labels = ([part for parts in kind for part in parts] for kind in zip(*named, strict=True))
    figure.legend(handles, labels, loc="outside upper center", ncols=2)
    grid[1, 0].set_xlabel("Angle of the contour (degrees)")
    grid[1, 1].set_xlabel("Contours (of 360)")
    return figure


def _crop(axes: Axes, sections: pd.DataFrame) -> None:
    """Let a section's axes show what is worn and a little beyond, depth downwards from a little above the surface."""
    worn = sections.loc[sections["depth_um"] > RIM_DEPTH * sections["depth_um"].max(), "across_mm"].abs().max()
    deepest = sections["depth_um"].max()
    axes.set_xlim(-ROOM * worn, ROOM * worn)
    axes.set_ylim((1.0 + 0.5 * (ROOM - 1.0)) * deepest, -0.5 * (ROOM - 1.0) * deepest)


def contour_examples(sections: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw sections at several angles, those of the last revolutions on top of each other, schemes by colour.

    sections : `scheme`, `angle_deg`, `revolution`, `across_mm` (from the track, outwards), `depth_um`.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    angles = list(dict.fromkeys(sections["angle_deg"]))
    columns = (len(angles) + 1) // 2
    grid = figure.subplots(2, columns, sharex=True, sharey=True, squeeze=False)
    revolutions = sorted(sections["revolution"].unique())
    for axes, angle in zip(grid.ravel(), angles, strict=False):
        chosen = sections[sections["angle_deg"] == angle]
        for (scheme, revolution), section in chosen.groupby(["scheme", "revolution"], sort=False):
            newest = (revolutions.index(revolution) + 1) / len(revolutions)
            look = {"color": SCHEME_COLOURS[scheme], "alpha": newest, "linewidth": 1.0}
            name = SCHEME_NAMES[scheme].partition(" (")[0]
            axes.plot(section["across_mm"], section["depth_um"], label=f"{name}, revolution {revolution}", **look)
        axes.set_title(f"{angle:g} degrees", loc="left", fontsize=SMALLEST_FONT)
    for axes in grid[-1]:
        axes.set_xlabel("Across (mm)")
    for axes in grid[:, 0]:
        axes.set_ylabel("Depth (µm)")
    _crop(grid[0, 0], sections)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def mesh_series(series: pd.DataFrame, stability: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw depth and both widths against the size of the elements, with the deviation of the contours.

    series, stability : as from comparison.py; the shaded meshes are those up to a fifth of the groove's width.
    """
    figure = new_figure(remarks, 4.2)
    grid = figure.subplots(1, len(SIZES), sharex=True)
    for axes, size in zip(grid, SIZES, strict=True):
        label, factor = _axis(size)
        for scheme, rows in series[series["size"] == size].groupby("scheme", sort=False):
            scale = factor / MILLIMETRES
            look = {"fmt": f"{SCHEME_MARKERS[scheme]}-", "markersize": 4, "capsize": 2.5, "linewidth": 0.8}
            mean, deviation = scale * rows["mean_mm"], scale * rows["deviation_mm"]
            axes.errorbar(
                rows["element_size_mm"],
                mean,
                deviation,
                color=SCHEME_COLOURS[scheme],
                label=SCHEME_NAMES[scheme],
                **look,
            )
        said = stability[stability["size"] == size].set_index("scheme")
        axes.set_title(
            "\n".join(_agreement(scheme, row) for scheme, row in said.iterrows()), loc="left", fontsize=SMALLEST_FONT
        )
        if "conserving" in said.index:
            axes.axvspan(
                0.0, said.loc["conserving", "largest_element_mm"], color=SCHEME_COLOURS["conserving"], alpha=0.08
            )
        axes.set(xlabel="Element size (mm)", ylabel=label, xlim=(0.0, None), ylim=(0.0, None))
    figure.legend(*grid[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


def _agreement(scheme: str, row: pd.Series) -> str:
    """What the meshes up to a fifth of the groove's width say of each other."""
    name = scheme.replace("_", " ")
    if row["meshes"] < 2:
        return f"{name}: too coarse"
    return f"{name}: {row['difference_percent']:.1f} % of {row['meshes']:.0f} meshes"


def mesh_contours(sections: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw one section per mesh, one panel per scheme, on the same axes.

    sections : `scheme`, `element_size_mm`, `across_mm`, `depth_um`.
    """
    schemes = list(dict.fromkeys(sections["scheme"]))
    figure = new_figure(remarks)
    grid = figure.subplots(1, len(schemes), sharex=True, sharey=True, squeeze=False)[0]
    sizes = sorted(sections["element_size_mm"].unique())
    shades = colormaps[MAP](np.linspace(0.0, 0.9, len(sizes)))
    for axes, scheme in zip(grid, schemes, strict=True):
        for size, section in sections[sections["scheme"] == scheme].groupby("element_size_mm"):
            axes.plot(section["across_mm"], section["depth_um"], color=shades[sizes.index(size)], label=f"{size:g} mm")
        axes.set_title(SCHEME_NAMES[scheme], loc="left")
        axes.set_xlabel("Across the track, outwards (mm)")
    grid[0].set_ylabel("Depth (µm)")
    _crop(grid[0], sections)
    figure.legend(*named_once(grid), title="elements", loc="outside right center")
    return figure


def normal_force(forces: pd.DataFrame, loads: Mapping[str, float], remarks: Sequence[str]) -> Figure:
    """Draw the vertical force of the pin and the sum of its normal forces per revolution as boxes with their means.

    forces : `scheme` and as from `runs.window_forces`; loads : N, by scheme.
    """
    schemes = list(dict.fromkeys(forces["scheme"]))
    figure = new_figure(remarks, 4.4)
    grid = figure.subplots(1, len(schemes), sharey=True, squeeze=False)[0]
    for axes, scheme in zip(grid, schemes, strict=True):
        revolutions = forces[forces["scheme"] == scheme].groupby("revolution")
        _boxes(axes, revolutions["vertical_force_N"], -BOX_STEP, OTHER_COLOUR, "vertical force")
        _boxes(axes, revolutions["normal_force_N"], BOX_STEP, FORCE_COLOUR, "sum of the normal forces of all contacts")
        axes.axhline(loads[scheme], label=f"load {loads[scheme]:g} N", color=LABORATORY_COLOUR, linewidth=0.9)
        axes.set_title(SCHEME_NAMES[scheme], loc="left")
        axes.set_xticks(list(revolutions.groups), [str(revolution) for revolution in revolutions.groups])
        axes.set_xlabel("Revolution")
    grid[0].set_ylabel("Force on the disc (N)")
    figure.legend(*named_once(grid), loc="outside upper center", ncols=3)
    return figure


def _boxes(axes: Axes, forces, shift: float, colour: str, name: str) -> None:
    """One box per revolution with its mean as a filled circle; forces: grouped by revolution."""
    mean = {"marker": "o", "markerfacecolor": colour, "markeredgecolor": colour, "markersize": 3.5}
    beyond = {"marker": ".", "markersize": 2, "markeredgecolor": colour}
    line = {"color": colour, "linewidth": 0.8}
    axes.boxplot(
        [force.to_numpy() for _, force in forces],
        positions=[revolution + shift for revolution in forces.groups],
        widths=1.6 * BOX_STEP,
        manage_ticks=False,
        showmeans=True,
        meanprops=mean,
        flierprops=beyond,
        boxprops=line,
        whiskerprops=line,
        capprops=line,
        medianprops=line,
    )
    axes.plot([], [], "s-", color=colour, markersize=4, label=name)


def laboratory_contour(
    sections: pd.DataFrame, boxes: pd.DataFrame, segment: tuple[float, float], remarks: Sequence[str]
) -> Figure:
    """Draw sections of runs beside the range of the laboratory's contours and a groove of the pin's own shape.

    sections : `case`, `angle_deg`, `across_mm`, `depth_um`; boxes : `of`, `least_depth_mm`, `depth_mm`,
    `least_width_mm`, `width_mm`, published; segment : depth and width (mm) of the pin's shape with the laboratory's
    volume.
    """
    cases = list(dict.fromkeys(sections["case"]))
    figure = new_figure(remarks, 4.4)
    grid = figure.subplots(1, len(cases), sharex=True, sharey=True, squeeze=False)[0]
    across = np.linspace(-0.5, 0.5, 101) * segment[1]
    for axes, case in zip(grid, cases, strict=True):
        for angle, section in sections[sections["case"] == case].groupby("angle_deg"):
            axes.plot(section["across_mm"], section["depth_um"], linewidth=1.0, label=f"{angle:g} degrees")
        depth = MICROMETRES / MILLIMETRES * segment[0] * (1.0 - (2.0 * across / segment[1]) ** 2)
        axes.plot(across, depth, color="black", linewidth=1.2, label="pin's shape, laboratory's volume")
        for box, look in zip(boxes.itertuples(), (":", "--"), strict=False):
            _box(axes, box, look)
        axes.set_title(case, loc="left", fontsize=SMALLEST_FONT)
        axes.set_xlabel("Across the track, outwards (mm)")
    grid[0].set_ylabel("Depth (µm)")
    _crop(grid[0], pd.concat([sections, _published_corners(boxes)]))
    figure.legend(*grid[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def _published_corners(boxes: pd.DataFrame) -> pd.DataFrame:
    """Bottom corners of the published boxes, as points of sections."""
    depth = MICROMETRES / MILLIMETRES * boxes["depth_mm"]
    return pd.DataFrame({"across_mm": 0.5 * boxes["width_mm"], "depth_um": depth})


def _box(axes: Axes, box: tuple, style: str) -> None:
    """Draw depth and width of published contours as a bracket, open at the top."""
    half, depth = 0.5 * box.width_mm, MICROMETRES / MILLIMETRES * box.depth_mm
    axes.plot([-half, -half, half, half], [0.0, depth, depth, 0.0], style, color=LABORATORY_COLOUR, label=box.of)
