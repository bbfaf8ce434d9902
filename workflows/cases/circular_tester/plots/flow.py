"""Figures of the flow in the circular wear tester: steadiness, spin, velocity and force by revolution, lowest layer."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.plots.style import MAP, SMALLEST_FONT, colour, draw_circles, marker, named_once, new_figure
from bulkwear.postproc.statistics.steady import STEADY
from bulkwear.postproc.tables.display import DEGREES, MILLIMETRES
from bulkwear.postproc.tables.summary import published_value
from bulkwear.workflows.cases.circular_tester.flow import STEADINESS
from bulkwear.workflows.cases.circular_tester.packings import errorbars

BAND_COLOUR = "#dddddd"  # of published ranges, behind what is simulated
BANDS = 0.25  # opacity of published ranges in the colour of their surface
NAMES = {
    "velocity_m_per_s": "particle velocity",
    "bed_height_m": "bed height",
    "wear_rate_m3_per_s": "wear rate",
}
TOP_SHARE = 0.98  # of the particles lie inside the colours
TITLE_CHARACTERS = 32  # of a line over one of three panels
SHIFT = 0.1  # revolutions that two surfaces stand apart
MEASURES = {  # measure -> axis, factor from SI, published values (quantity, on which side of it ours are to lie)
    "bottom_averaged_angular_velocity_rad_per_s": (
        "Averaged angular velocity\nof the bottom layer (°/s)",
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


def steadiness(
    variations: pd.DataFrame, steady: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]
) -> Figure:
    """Draw the coefficient of variation (%) of velocity, bed height and wear rate per revolution (Fig 6.7).

    variations: as from `flow.revolutions_over_packings`; steady: as from `steady_revolutions`; published:
    circular_tester.csv.
    """
    figure = new_figure(remarks, 4.2)
    grid = figure.subplots(1, len(STEADINESS), sharex=True)
    ends = [published_value(published, f"{end}_wear_variation", "simulation") for end in ("least", "largest")]
    start = published_value(published, "steady_from", "simulation")
    for axes, measure in zip(grid, STEADINESS, strict=True):
        of_measure = variations[variations["measure"] == measure]
        for surface, rows in of_measure.groupby("surface", sort=False):
            _with_intervals(axes, rows, "variation", 100.0, surface)
        axes.axvline(start, label="steady from here on, Yan 2022", color="black", linestyle="--", linewidth=1.0)
        if measure == "wear_rate_m3_per_s":
            words = "convex from there on, Yan 2022"
            last = max(of_measure["revolution"].max(), start + 1.0)
            axes.fill_between([start, last], *ends, color=BAND_COLOUR, label=words, zorder=0)
        found = steady[steady["measure"] == measure]
        told = [f"{surface}: {steady_words(rows)}" for surface, rows in found.groupby("surface", sort=False)]
        lines = [NAMES[measure], *(line for words in told for line in textwrap.wrap(words, TITLE_CHARACTERS))]
        axes.set_title("\n".join(lines), loc="left", fontsize=SMALLEST_FONT)
        axes.set(xlabel="Revolution", ylim=(0.0, None))
    grid[0].set_ylabel("Coefficient of variation (%)")
    figure.legend(*named_once(grid), loc="outside upper center", ncols=4)
    return figure


def _with_intervals(
    axes: Axes, rows: pd.DataFrame, value: str, factor: float, surface: str, shift: float = 0.0
) -> None:
    """Draw means over packings by revolution with their intervals, where these are known."""
    reach = errorbars(rows, value, factor)
    look = {"color": colour(surface), "fmt": f"{marker(surface)}-", "markersize": 3.5, "capsize": 2.5, "linewidth": 1.0}
    bars = reach if np.isfinite(reach).any() else None
    axes.errorbar(rows["revolution"] + shift, factor * rows[value], bars, label=surface, **look)


def steady_words(rows: pd.DataFrame) -> str:
    """Say of the packings of a measure from where on they are steady; rows: of `steady_revolutions`."""
    steady = rows.loc[rows["answer"] == STEADY, "start_revolutions"]
    others = rows.loc[rows["answer"] != STEADY, "answer"].value_counts()
    told = [f"{count} x {answer}" for answer, count in others.items()]
    if len(steady):
        told.insert(0, f"steady from {', '.join(f'{start:.2g}' for start in steady)}")
    return "; ".join(told)


def by_revolution(means: pd.DataFrame, measure: str, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the mean of a measure of MEASURES per revolution with its interval over packings (Fig 6.17, 6.18, 6.21).

    means: as from `flow.revolutions_over_packings`. Published values are drawn as lines in the colour of their
    surface: what the source gives as first and last at these ends, the others right across.
    """
    label, factor, quantities = MEASURES[measure]
    figure = new_figure(remarks)
    axes = figure.subplots()
    of_measure = means[means["measure"] == measure]
    for shift, (surface, rows) in zip((-SHIFT, SHIFT, 0.0), of_measure.groupby("surface", sort=False), strict=False):
        _with_intervals(axes, rows, "mean", factor, surface, shift)
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


def relative_motion(
    particles: pd.DataFrame, quantity: str, label: str, outlines: Mapping[str, np.ndarray], remarks: Sequence[str]
) -> Figure:
    """Draw the particles of a layer over each sample, coloured by a speed over the plain sample's mean.

    Figures 6.19 and 6.20. particles: as from `layer.relative_motion`; quantity: relative_speed or
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
