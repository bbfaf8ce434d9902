"""Wear against particle scale and against ratios of size, and profiles of motion (Yan 2022, section 4.5)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.plots.style import (
    BLUE,
    LARGEST_HEIGHT,
    OTHER_COLOUR,
    PUBLISHED,
    SMALLEST_FONT,
    colour,
    marker,
    named_once,
    new_figure,
)
from bulkwear.postproc.statistics.crossing import FEWEST_PLACES, Crossing
from bulkwear.workflows.cases.sliding_sample.particle_size.plots.contacts import (
    ASIDE,
    MARKERS,
    PUBLISHED_MARKS,
    packings_by_scale,
    scale_colours,
)
from bulkwear.workflows.cases.sliding_sample.particle_size.wear_by_scale import RATIOS, patterned_curve

PARTS = {"base": ("#009E73", "^", "its base"), "bumps": ("#CC79A7", "v", "its pattern")}  # colour, marker and name
RATIO_NAMES = {
    "equivalent_radius": "equivalent radius",
    "projected_area": "projected area",
    "surface_area": "surface area",
    "volume": "volume",
}
MEASURE_NAMES = {
    "relative_velocity": "Relative velocity of\nthe particles (%)",
    "relative_wear_rate": "Wear rate over the\nlargest of all runs (%)",
}
POINTS = 50  # of a drawn line
ROOM = 0.08  # -, of the scales, beside them
MOST_BESIDE = 4  # entries of a legend
INTERVAL_COLOUR, CRITICAL = "#e5e5e5", "critical scale, 95 %"
HEIGHT = "height_mm"  # places that stand upright


def wear_against_scale(
    wear: pd.DataFrame, published: pd.DataFrame, critical: Crossing, remarks: Sequence[str]
) -> Figure:
    """Draw relative wear (-) against particle scale with fitted lines, and the published lines beside them.

    wear: as from `wear_by_scale.wear_by_scale`; published: curve, intercept, slope, source
    critical: where patterned and plain meet, with its interval as a grey field
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    axes = figure.subplots()
    low, high = wear["particle_scale"].min(), wear["particle_scale"].max()
    room = ROOM * max(high - low, 1.0)
    places = np.linspace(low - room, high + room, POINTS)
    looks = {name: _of_surface(name) for name in (PLAIN, patterned_curve(wear))} | PARTS
    for curve, (shade, mark, _) in looks.items():
        one = wear[wear["curve"] == curve]
        packings_by_scale(axes, one, "relative_wear", (shade, mark), curve)
        if one["particle_scale"].nunique() >= FEWEST_PLACES:
            line = np.polynomial.Polynomial.fit(one["particle_scale"], one["relative_wear"], 1)
            axes.plot(places, line(places), color=shade, linewidth=0.7, label=f"{curve} line")
        for _, line in published[published["curve"] == curve].iterrows():
            drawn = {"color": shade, "linestyle": ":", "label": f"{curve} published"}
            axes.plot(places, line["intercept"] + line["slope"] * places, **drawn)
    _critical(axes, critical, (places[0], places[-1]))
    axes.axhline(0.0, color="#888888", linewidth=0.6)
    axes.set(xlabel="Particle scale (-)", ylabel="Wear over the plain sample's\nwith the smallest particles (-)")
    axes.set_xlim(places[0], places[-1])
    _scale_legend(figure, looks, published, critical)
    return figure


def _of_surface(surface: str) -> tuple[str, str, str]:
    """Return colour, marker and name of a surface's sample."""
    return colour(surface), marker(surface), f"{surface} sample"


def _critical(axes: Axes, critical: Crossing, ends: tuple[float, float]) -> None:
    """Mark the critical scale, where it has a value, and its interval, as far as the axis shows them."""
    if critical.reason:
        return
    if not np.isnan(critical.value):
        axes.axvline(critical.value, color="black", linewidth=0.8, linestyle="--", label="critical")
    axes.axvspan(max(critical.low, ends[0]), min(critical.high, ends[1]), color=INTERVAL_COLOUR, zorder=0)


def _scale_legend(
    figure: Figure, looks: dict[str, tuple[str, str, str]], published: pd.DataFrame, critical: Crossing
) -> None:
    handles: list[Line2D | Patch] = [
        Line2D([], [], color=shade, marker=mark, label=name) for shade, mark, name in looks.values()
    ]
    if not published.empty:
        source = published["source"].iloc[0].partition(",")[0]
        handles.append(Line2D([], [], color="black", linestyle=":", label=source))
    if not critical.reason and np.isnan(critical.value):
        handles.append(Patch(color=INTERVAL_COLOUR, label=CRITICAL))
    elif not critical.reason:
        handles.append(Line2D([], [], color="black", linestyle="--", linewidth=0.8, label=CRITICAL))
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles), columnspacing=1.2)


def wear_against_size_ratios(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw patterned over plain wear (-) against the four ratios of particle to bump, a panel each.

    table, published: wear_over_plain and the four ratios; published ones are drawn as a line
    """
    figure = new_figure(remarks)
    panels = figure.subplots(1, len(RATIOS), sharey=True)
    for axes, ratio in zip(panels, RATIOS, strict=True):
        axes.plot(published[ratio], published["wear_over_plain"], ":", color="black", label="published")
        reach = np.abs(table[["interval_low", "interval_high"]].to_numpy().T - table["wear_over_plain"].to_numpy())
        axes.errorbar(table[ratio], table["wear_over_plain"], reach, fmt="o", color=BLUE, capsize=2, label="ours")
        axes.axhline(1.0, color=OTHER_COLOUR, linewidth=0.8, linestyle="--")
        axes.axvline(1.0, color=OTHER_COLOUR, linewidth=0.8, linestyle="--")
        axes.set_xscale("log")
        axes.minorticks_off()
        axes.xaxis.set_major_formatter("{x:g}")
        axes.set_xlabel(f"Ratio of\n{RATIO_NAMES[ratio]} (-)")
    panels[0].set_ylabel("Wear of the patterned sample\nover the plain one's (-)")
    handles = [
        Line2D([], [], color=BLUE, marker="o", linestyle="", label="simulated"),
        Line2D([], [], color="black", linestyle=":", label="Yan 2022, Eq 4.14 and 4.15, pattern of run R5"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=2)
    return figure


def steady_by_scale(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw relative velocity and relative wear rate (%) in the steady window against particle scale, with deviations.

    table: as from `published_sizes.steady_by_scale`; hollow where the window is not steady, of a mean over packings
        where that of any of them is not
    published: quantity, surface, scale_from, scale_to, relation, value, source; of the two measures
    """
    figure = new_figure(remarks)
    panels = figure.subplots(1, len(MEASURE_NAMES))
    for axes, (measure, label) in zip(panels, MEASURE_NAMES.items(), strict=True):
        for surface, one in table[table["measure"] == measure].groupby("surface", sort=False):
            _with_deviation(axes, one, str(surface))
        for each in published[published["quantity"] == measure].itertuples():
            look = {"color": colour(each.surface), "markerfacecolor": "white", "linestyle": ":", "label": "published"}
            look["marker"] = PUBLISHED_MARKS[each.relation]
            axes.plot([each.scale_from, each.scale_to], [each.value] * 2, linewidth=0.8, markersize=6, **look)
        axes.set(xlabel="Particle scale (-)", ylabel=label)
        axes.set_ylim(bottom=0.0)
    shown = [_of_surface(name) for name in sorted(set(table["surface"]), key=lambda name: name != PLAIN)]
    handles = [Line2D([], [], color=each, marker=mark, linestyle="", label=name) for each, mark, name in shown]
    handles.append(Line2D([], [], color="black", marker="o", markerfacecolor="white", linestyle="", label="not steady"))
    for relation in dict.fromkeys(published.loc[published["quantity"].isin(MEASURE_NAMES), "relation"]):
        mark = {"marker": PUBLISHED_MARKS[relation], "markerfacecolor": "white", "linestyle": ":"}
        handles.append(Line2D([], [], color=OTHER_COLOUR, label=f"Yan 2022: {relation}", **mark))
    figure.legend(handles=handles, loc="outside upper center", ncols=3)
    return figure


def _with_deviation(axes: Axes, one: pd.DataFrame, surface: str) -> None:
    """Draw the means of the packings' windows over packings, and their deviations along the travel as thin lines."""
    shade, aside = colour(surface), ASIDE if surface == PLAIN else -ASIDE
    thin = {"fmt": "none", "ecolor": shade, "elinewidth": 0.6, "alpha": 0.6, "label": f"{surface} deviation"}
    axes.errorbar(one["particle_scale"] + aside, one["mean_percent"], one["deviation_percent"], **thin)
    hollow = ~one["steady"].astype(bool)
    packings_by_scale(axes, one, "mean_percent", (shade, marker(surface)), surface, hollow, aside)


def curves_by_scale(
    table: pd.DataFrame,
    value: str,
    place: str,
    labels: tuple[str, str],
    remarks: Sequence[str],
    bounds: pd.DataFrame | None = None,
) -> Figure:
    """Draw a quantity against places, a panel per surface on the same axes, a curve per particle scale.

    table: surface, particle_scale, `value` and `place`; a height is upright, other places lie level; packings are
    averaged
    labels: of value and place, with their units
    bounds: published ones of the value: surface, relation, value and place_to, as far as it holds; dotted
    """
    surfaces, scales = list(dict.fromkeys(table["surface"])), sorted(set(table["particle_scale"]))
    colours, upright = scale_colours(scales), place == HEIGHT
    figure = new_figure(remarks)
    panels = figure.subplots(1, len(surfaces), sharex=True, sharey=True, squeeze=False)[0]
    bounds = pd.DataFrame(columns=["surface", "relation", "value", "place_to"]) if bounds is None else bounds
    for axes, surface in zip(panels, surfaces, strict=True):
        (axes.axvline if upright else axes.axhline)(0.0, color=OTHER_COLOUR, linewidth=0.8)
        for k, scale in enumerate(scales):
            packings = table[(table["surface"] == surface) & (table["particle_scale"] == scale)]
            one = packings.groupby(place, as_index=False)[value].mean()
            drawn = {"color": colours[scale], "marker": MARKERS[k % len(MARKERS)], "markersize": 4, "linewidth": 1.2}
            axes.plot(*_placed(one[value], one[place], upright), label=f"scale {scale:g}", **drawn)
        for each in bounds[bounds["surface"] == surface].itertuples():
            drawn = {"label": f"Yan 2022: {each.relation} {each.value:g}", **PUBLISHED, "linestyle": ":"}
            axes.plot(*_placed([each.value] * 2, [0.0, each.place_to], upright), **drawn)
        axes.set_title(f"{surface} sample", loc="left", fontsize=SMALLEST_FONT)
        axes.set_xlabel(labels[0] if upright else labels[1])
        (axes.set_ylim if upright else axes.set_xlim)(0.0, None)
    panels[0].set_ylabel(labels[1] if upright else labels[0])
    handles, names = named_once(panels)
    figure.legend(handles, names, loc="outside upper center", ncols=min(len(handles), MOST_BESIDE))
    return figure


def _placed(values: Sequence[float], places: Sequence[float], upright: bool) -> tuple[Sequence[float], Sequence[float]]:
    return (values, places) if upright else (places, values)
