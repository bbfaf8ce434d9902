"""Figures of the circular wear tester beside those of its volumes: steadiness, flow, forces, where and how it wears."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from postproc.plots.spheres import draw_circles
from postproc.plots.style import (
    BASE_COLOUR,
    BUMP_COLOUR,
    LARGEST_HEIGHT,
    MAP,
    MARKERS,
    SMALLEST_FONT,
    colour,
    named_once,
    new_figure,
)
from postproc.tables.display import DEGREES, MILLIMETRES
from postproc.tables.published import published_value
from postproc.tables.summary import PLAIN
from workflows.cases.circular_tester.distribution import share_of_bumps
from workflows.cases.circular_tester.flow import STEADINESS

BAND_COLOUR = "#dddddd"  # of published ranges, behind what is simulated
BANDS = 0.25  # opacity of published ranges in the colour of their surface
NAMES = {
    "velocity_m_per_s": "particle velocity",
    "bed_height_m": "bed height",
    "wear_rate_m3_per_s": "wear rate",
}
TOP_SHARE = 0.98  # of the particles lie inside the colours
SHIFT = 0.1  # revolutions that two surfaces stand apart
MEASURES = {  # measure -> axis, factor from SI, published values (quantity, on which side of it ours are to lie)
    "bottom_angular_speed_rad_per_s": (
        "Angular speed of the bottom layer (°/s)",
        DEGREES,
        (
            "convex_first_angular_speed",
            "convex_last_angular_speed",
            "plain_least_angular_speed",
            "plain_largest_angular_speed",
        ),
    ),
    "bottom_velocity_m_per_s": (
        "Velocity of the bottom layer (mm/s)",
        MILLIMETRES,
        ("plain_velocity_above", "convex_velocity_below"),
    ),
    "normal_force_N": (
        "Normal force (N)",
        1.0,
        (
            "convex_first_normal_force",
            "convex_last_normal_force",
            "plain_least_normal_force",
            "plain_largest_normal_force",
        ),
    ),
}


def steadiness(means: pd.DataFrame, steady: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the coefficient of variation (%) of velocity, bed height and wear rate per revolution (Fig 6.7).

    means: as from `analysis.tester_flow.revolution_means`; steady: as from `steady_revolutions`; published:
    circular_tester.csv.
    """
    figure = new_figure(remarks, 4.2)
    grid = figure.subplots(1, len(STEADINESS), sharex=True)
    ends = [published_value(published, f"{end}_wear_variation", "simulation") for end in ("least", "largest")]
    start = published_value(published, "steady_from", "simulation")
    for axes, measure in zip(grid, STEADINESS, strict=True):
        of_measure = means[means["measure"] == measure]
        for (_, surface), of_run in of_measure.groupby(["run", "surface"], sort=False):
            look = {"color": colour(surface), "marker": MARKERS.get(surface, "^"), "markersize": 3.5, "linewidth": 1.0}
            axes.plot(of_run["revolution"], 100.0 * of_run["variation"], label=surface, **look)
        axes.axvline(start, label="steady from here on, Yan 2022", color="black", linestyle="--", linewidth=1.0)
        if measure == "wear_rate_m3_per_s":
            words = "convex from there on, Yan 2022"
            last = max(of_measure["revolution"].max(), start + 1.0)
            axes.fill_between([start, last], *ends, color=BAND_COLOUR, label=words, zorder=0)
        found = steady[steady["measure"] == measure]
        said = "\n".join(f"{row.surface}: {_steady_words(row)}" for row in found.itertuples())
        axes.set_title(f"{NAMES[measure]}\n{said}", loc="left", fontsize=SMALLEST_FONT)
        axes.set(xlabel="Revolution", ylim=(0.0, None))
    grid[0].set_ylabel("Coefficient of variation (%)")
    figure.legend(*named_once(grid), loc="outside upper center", ncols=4)
    return figure


def _steady_words(row: tuple) -> str:
    return f"steady from {row.start:.2g}" if row.steady else "not steady"


def by_revolution(means: pd.DataFrame, measure: str, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw mean and standard deviation of a measure of MEASURES per revolution (Fig 6.17, 6.18, 6.21).

    means: as from `analysis.tester_flow.revolution_means`. Published values are drawn as lines in the colour of their
    surface: what the source gives as first and last at these ends, the others right across.
    """
    label, factor, quantities = MEASURES[measure]
    figure = new_figure(remarks)
    axes = figure.subplots()
    of_measure = means[means["measure"] == measure]
    for shift, ((_, surface), of_run) in zip(
        (-SHIFT, SHIFT, 0.0), of_measure.groupby(["run", "surface"], sort=False), strict=False
    ):
        mean, deviation = factor * of_run["mean"], factor * of_run["deviation"]
        look = {"color": colour(surface), "fmt": f"{MARKERS.get(surface, '^')}-", "markersize": 4, "capsize": 2.5}
        axes.errorbar(of_run["revolution"] + shift, mean, deviation, linewidth=1.0, label=surface, **look)
    ends = of_measure["revolution"].min(), of_measure["revolution"].max()
    for quantity in quantities:
        _published_line(axes, published[published["quantity"] == quantity].iloc[0], ends)
    axes.set(xlabel="Revolution", ylabel=label, ylim=(0.0, None))
    figure.legend(*named_once([axes]), loc="outside upper center", ncols=4)
    return figure


def _published_line(axes: Axes, row: pd.Series, ends: tuple[float, float]) -> None:
    """Draw a published value with its uncertainty; words in its quantity say of which surface and where."""
    surface, which = row["quantity"].split("_")[:2]
    places = {"first": (ends[0], ends[0] + 1), "last": (ends[1] - 1, ends[1])}.get(which, ends)
    axes.plot(places, [row["value"]] * 2, "--", color=colour(surface), linewidth=1.2, label=f"{surface}, Yan 2022")
    if row["uncertainty"] > 0.0:
        low, high = row["value"] - row["uncertainty"], row["value"] + row["uncertainty"]
        axes.fill_between(places, low, high, color=colour(surface), alpha=BANDS, linewidth=0.0)


def by_column(table: pd.DataFrame, unit: str, quantity: str, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw a quantity on base and bumps per column of the sample, a panel per run (Fig 6.13, 6.22).

    table: run, column, base_<unit>, bumps_<unit>, as from `analysis.tester_distribution`; with deviation_<unit> where
    several revolutions were averaged; quantity: what the axis says, with its unit.
    """
    figure = new_figure(remarks)
    runs = list(dict.fromkeys(table["run"]))
    grid = figure.subplots(1, len(runs), sharey=True, squeeze=False)[0]
    base, bumps, deviation = (f"{name}_{unit}" for name in ("base", "bumps", "deviation"))
    for axes, run in zip(grid, runs, strict=True):
        of_run = table[table["run"] == run]
        axes.bar(of_run["column"], of_run[base], color=BASE_COLOUR, label="base")
        axes.bar(
            of_run["column"],
            of_run[bumps],
            bottom=of_run[base],
            color=BUMP_COLOUR,
            hatch="//",
            edgecolor="white",
            label="bumps",
        )
        if deviation in table:
            total = of_run[base] + of_run[bumps]
            axes.errorbar(of_run["column"], total, of_run[deviation], fmt="none", ecolor="black", capsize=3)
        axes.set_title(
            f"{run.replace('_', ' ')}{_share_words(of_run, base, bumps, unit, published)}",
            loc="left",
            fontsize=SMALLEST_FONT,
        )
        axes.set_xlabel("Column, 1 where the bed arrives")
        axes.set_xticks(of_run["column"])
    grid[0].set_ylabel(quantity)
    figure.legend(*named_once(grid), loc="outside upper center", ncols=2)
    return figure


def _share_words(of_run: pd.DataFrame, base: str, bumps: str, unit: str, published: pd.DataFrame) -> str:
    """What the bumps bear, beside what the source says of that quantity; nothing for a plain sample."""
    if not of_run[bumps].any():
        return ""
    if unit == "mm3":
        share = share_of_bumps(of_run).iloc[0]
        theirs = published_value(published, "share_of_bumps", "simulation")
        return f": bumps {100.0 * share:.0f} % (Yan 2022: {theirs:g} %)"
    first = of_run.iloc[0]
    theirs = published_value(published, "first_column_force_share", "simulation")
    return (
        f": bumps of column 1 {100.0 * first[bumps] / (first[base] + first[bumps]):.0f} % (Yan 2022: over {theirs:g} %)"
    )


def by_bump(table: pd.DataFrame, published: pd.DataFrame, scale_remark: str, remarks: Sequence[str]) -> Figure:
    """Draw the worn volume (mm3) of every bump, columns of the sample apart, on the published ranges (Fig 6.14).

    table: as from `analysis.tester_distribution.wear_by_bump`; scale_remark: to which revolution both belong.
    """
    figure = new_figure(remarks)
    axes = figure.subplots()
    places = np.arange(len(table))
    for row, of_row in table.groupby("row"):
        kind = "odd" if row % 2 else "even"
        ends = [published_value(published, f"{end}_bump_volume_{kind}", "simulation") for end in ("least", "largest")]
        there = places[(table["row"] == row).to_numpy()]
        axes.fill_between(
            [there[0] - 0.5, there[-1] + 0.5],
            *ends,
            color=BAND_COLOUR,
            zorder=0,
            label="range of the column's bumps, Yan 2022",
        )
        axes.bar(there, of_row["volume_mm3"], color=BUMP_COLOUR)
    axes.set_xticks(places, table["bump"], rotation=90)
    axes.set_title(scale_remark, loc="left", fontsize=SMALLEST_FONT)
    axes.set_ylabel("Worn volume of a bump (mm³)")
    figure.legend(*named_once([axes]), loc="outside upper center")
    return figure


def mesh_size(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the volume over that of the plain sample on the finest mesh against mesh size (Fig 6.8).

    table: as from `analysis.tester_distribution.mesh_size_effect`.
    """
    figure = new_figure(remarks)
    axes = figure.subplots()
    for surface, rows in table.groupby("surface", sort=False):
        mean, deviation = rows["mean_percent"].iloc[0], rows["deviation_percent"].iloc[0]
        name = f"{surface}, {mean:.3g} ± {deviation:.2g} %"
        look = {"color": colour(surface), "marker": MARKERS.get(surface, "^"), "markersize": 5, "linewidth": 1.0}
        axes.plot(rows["element_size_mm"], rows["relative_percent"], label=name, **look)
        theirs = published[published["quantity"] == f"{surface}_relative_volume"]
        for each in theirs.itertuples():
            low, high = each.value - each.uncertainty, each.value + each.uncertainty
            words = f"{surface}, Yan 2022: {each.value:g} ± {each.uncertainty:g} %"
            axes.axhspan(low, high, color=colour(surface), alpha=BANDS, linewidth=0.0, label=words)
    axes.set(
        xlabel="Element size (mm)", ylabel="Volume over the finest plain mesh's (%)", ylim=(0.0, None), xlim=(0.0, None)
    )
    figure.legend(*named_once([axes]), loc="outside upper center", ncols=2)
    return figure


def worn_contours(contours: pd.DataFrame, title: str, remarks: Sequence[str]) -> Figure:
    """Draw sections of bumps of several surfaces, side view above, front view below (Fig 6.9, 6.16).

    contours: as from `analysis.tester_distribution.worn_contours`; title: what the legend lists, such as "revolution".
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


def relative_motion(
    particles: pd.DataFrame, quantity: str, label: str, outlines: Mapping[str, np.ndarray], remarks: Sequence[str]
) -> Figure:
    """Draw the particles of a layer over each sample, coloured by a speed over the plain sample's mean.

    Figures 6.19 and 6.20. particles: as from `analysis.tester_flow.relative_motion`; quantity: relative_speed or
    relative_angular_speed; label: of the colour bar; outlines: by surface, (k, 2, 2) ends of lines in m. Arrows show
    the velocity where speed is shown.
    """
    figure = new_figure(remarks, 4.4)
    surfaces = sorted(particles["surface"].unique(), key=lambda surface: surface != PLAIN)
    grid = figure.subplots(1, len(surfaces), sharex=True, sharey=True, squeeze=False)[0]
    norm = Normalize(0.0, float(particles[quantity].quantile(TOP_SHARE)))
    for axes, surface in zip(grid, surfaces, strict=True):
        of_surface = particles[particles["surface"] == surface]
        places = MILLIMETRES * of_surface[["x_m", "y_m"]].to_numpy()
        radii = MILLIMETRES * of_surface["radius_m"].to_numpy()
        draw_circles(axes, places, radii, of_surface[quantity].to_numpy(), norm, MAP)
        if quantity == "relative_speed":
            arrows = of_surface[["vx_m_per_s", "vy_m_per_s"]].to_numpy()
            axes.quiver(*places.T, *arrows.T, color="white", width=0.003, pivot="mid")
        for line in outlines.get(surface, ()):
            axes.plot(*(MILLIMETRES * line.T), color="black", linewidth=0.8)
        axes.set_title(surface, loc="left")
        axes.set(xlabel="x (mm), outwards", aspect="equal")
        axes.autoscale_view()
        axes.grid(False)
    grid[0].set_ylabel("y (mm)\nbed moves to +y →")
    figure.colorbar(ScalarMappable(norm, MAP), ax=grid, label=label, extend="max", shrink=0.85)
    return figure
