"""Figures of a calibration: response maps, the family that fits, pairs and bands, sizes of boxes, progress."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text

from bulkwear.postproc.inference.posterior import CORE_SHARE, FAMILY_SHARE
from bulkwear.postproc.inference.problem import Measured
from bulkwear.postproc.plots.style import (
    BLUE,
    LARGEST_HEIGHT,
    MAP,
    ORANGE,
    OTHER_COLOUR,
    SMALLEST_FONT,
    facets,
    label_all,
    new_figure,
)
from bulkwear.workflows.cases.calibration.responses import BAND, RECOMMENDED, parameter_name, response_name

OURS, OTHERS = BLUE, ORANGE
MAPS_BESIDE = 2  # maps in a line: of more their numbers are too small to read
LABEL_FONT = 8.0  # pt, of numbers within maps
CLEAR_OF_TITLE = 0.9  # of a map's height, above which a mark's number stands below it
CLEAR_OF_MARKS = (0.10, 0.09)  # of a map's width and height, by which a contour's number keeps away from marks' numbers
BAND_COLOUR = "#000000"
FAMILY_COLOURS = ListedColormap(["#0072B2", "#9ecbe6"])


# ---------------------------------------------------------------- maps


def response_maps(
    grid: pd.DataFrame,
    simulations: pd.DataFrame,
    measured: Mapping[str, Measured],
    published: pd.DataFrame,
    names: Sequence[str],
    remarks: Sequence[str],
) -> Figure:
    """Draw every response over the first two parameters, with the measured band and what was simulated.

    grid: as from `responses.response_grid`; simulations: ours; published: pairs that others simulated;
    names: of the two parameters
    """
    responses = [name for name in grid.columns if f"{name}_doubt" in grid]
    figure = new_figure(remarks, 4.6 if len(responses) == 1 else LARGEST_HEIGHT)
    columns = min(len(responses), MAPS_BESIDE)
    grid_of_axes = figure.subplots(
        math.ceil(len(responses) / columns), columns, sharex=True, sharey=True, squeeze=False
    ).ravel()
    for spare in grid_of_axes[len(responses) :]:
        spare.remove()
    for name, axes in zip(responses, grid_of_axes, strict=False):
        _draw_map(figure, axes, grid, simulations, published, name, list(names[:2]))
        if name in measured:
            _draw_band(axes, grid, name, measured[name], list(names[:2]))
        axes.set_title(response_name(name), loc="left", fontsize=SMALLEST_FONT)
        axes.grid(False)
    label_all(figure, len(responses) > 1, parameter_name(names[0]), parameter_name(names[1]))
    handles = [
        Line2D([], [], linestyle="", marker="o", color="white", markeredgecolor="black", label="simulated here"),
        Line2D([], [], linestyle="", marker="D", color="white", markeredgecolor=OTHERS, label="simulated by others"),
        Patch(facecolor="none", edgecolor=BAND_COLOUR, hatch="///", label="measured, ± one standard deviation"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=3)
    return figure


def _draw_map(
    figure: Figure,
    axes: Axes,
    grid: pd.DataFrame,
    simulations: pd.DataFrame,
    published: pd.DataFrame,
    name: str,
    pair: list[str],
) -> None:
    """Draw the surrogate's mean as filled contours, and simulated values on the same colours.

    Colours reach as far as our values; published ones stand beside their marks, because some lie far outside.
    """
    nothing = published.iloc[:0].assign(**dict.fromkeys(pair, pd.Series(dtype=float)))
    there = published if set(pair) <= set(published) else nothing
    inside = [there[column].between(grid[column].min(), grid[column].max()) for column in pair]
    points = {
        marker: table[table[name].notna()]
        for marker, table in (("o", simulations), ("D", _with(there[np.logical_and(*inside)], name)))
    }
    values = np.concatenate([grid[name], points["o"][name]])
    levels = np.linspace(values.min(), values.max(), 15)
    x, y, z = _as_grid(grid, pair, name)
    filled = axes.contourf(x, y, z, levels=levels, cmap=MAP)
    lines = axes.contour(x, y, z, levels=levels[1:-1:2], colors="white", linewidths=0.5)
    numbers = axes.clabel(lines, fmt="%.3g", fontsize=LABEL_FONT)
    for marker, table in points.items():
        axes.scatter(
            *(table[column] for column in pair),
            c=table[name],
            cmap=MAP,
            vmin=levels[0],
            vmax=levels[-1],
            marker=marker,
            edgecolors="black" if marker == "o" else OTHERS,
            linewidths=0.9 if marker == "o" else 1.6,
            s=28,
            zorder=3,
            clip_on=False,  # marks at the ends of the range are whole
        )
    least, most = np.array([x.min(), y.min()]), np.array([x.max(), y.max()])
    _hide_numbers_near(numbers, pd.concat(points.values())[pair].to_numpy(), CLEAR_OF_MARKS * (most - least))
    for _, row in points["D"].iterrows():
        place = row[pair].to_numpy(float)
        right, top = place[0] > (x.min() + x.max()) / 2.0, place[1] > least[1] + CLEAR_OF_TITLE * (most - least)[1]
        value = axes.annotate(
            f"{row[name]:.3g}",
            place,
            (-4 if right else 4, -4 if top else 4),
            textcoords="offset points",
            ha="right" if right else "left",
            va="top" if top else "baseline",
            fontsize=LABEL_FONT,
            color=OTHERS,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6},
        )
        value.set_in_layout(False)
    figure.colorbar(filled, ax=axes, format="%.3g")


def _hide_numbers_near(numbers: Sequence[Text], places: np.ndarray, distances: np.ndarray) -> None:
    """Hide contours' numbers that lie nearer to a place, (n, 2), than the two distances."""
    for number in numbers:
        apart = np.abs(places - number.get_position())
        number.set_visible(not (apart < distances).all(axis=1).any())


def _with(table: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return the table with a column, NaN where it has none."""
    return table if column in table else table.assign(**{column: np.nan})


def _draw_band(axes: Axes, grid: pd.DataFrame, name: str, aim: Measured, pair: list[str]) -> None:
    x, y, z = _as_grid(grid, pair, name)
    edges = [aim.value - BAND * aim.deviation, aim.value + BAND * aim.deviation]
    if z.min() < edges[1] and z.max() > edges[0]:
        axes.contourf(x, y, z, levels=edges, colors="none", hatches=["////"])
        axes.contour(x, y, z, levels=edges, colors=BAND_COLOUR, linewidths=1.0)


def _as_grid(grid: pd.DataFrame, pair: list[str], column: str) -> list[np.ndarray]:
    count = grid[pair[0]].nunique()
    return [grid[name].to_numpy().reshape(count, -1) for name in (*pair, column)]


# ---------------------------------------------------------------- the family


def family(
    table: pd.DataFrame,
    simulations: pd.DataFrame,
    pairs: Mapping[str, Mapping[str, float]],
    remarks: Sequence[str],
) -> Figure:
    """Draw which parameters fit what was measured: the regions with 50 and 95 % of the posterior, for every two.

    table: as from `responses.family_table`; pairs: {name: values}, marked
    """
    kinds = list(dict.fromkeys(zip(table["first"], table["second"], strict=True)))
    figure = new_figure(remarks, 4.6 if len(kinds) == 1 else LARGEST_HEIGHT)
    axes = figure.subplots(1, len(kinds), squeeze=False)[0]
    for each, (first, second) in zip(axes, kinds, strict=True):
        part = table[(table["first"] == first) & (table["second"] == second)]
        draw_family(each, part, simulations, pairs)
        each.set(xlabel=parameter_name(first), ylabel=parameter_name(second))
    handles = family_handles({name: _pair_label(name, values) for name, values in pairs.items()})
    figure.legend(handles=handles, loc="outside right center")
    return figure


def draw_family(
    axes: Axes, table: pd.DataFrame, simulations: pd.DataFrame, pairs: Mapping[str, Mapping[str, float]]
) -> None:
    """Draw the regions of two parameters with 50 and 95 % of the posterior, the simulations and the pairs.

    table: as from `responses.family_table`, of these two alone
    """
    count, first, second = table["first_value"].nunique(), table["first"].iloc[0], table["second"].iloc[0]
    x, y, share = (
        table[name].to_numpy().reshape(count, -1) for name in ("first_value", "second_value", "denser_share")
    )
    axes.contourf(x, y, share, levels=[-0.01, CORE_SHARE, FAMILY_SHARE], cmap=FAMILY_COLOURS)
    axes.use_sticky_edges = False  # or marks at the ends of the range would be cut
    axes.scatter(simulations[first], simulations[second], s=14, c="black", marker="x", linewidths=0.9, zorder=3)
    for name, values in pairs.items():
        axes.plot(values[first], values[second], markersize=9, zorder=4, **_pair_look(name))


def family_handles(labels: Mapping[str, str]) -> list[Artist]:
    """Return what explains `draw_family`; labels: of the pairs, by name."""
    return [
        *(
            Patch(color=FAMILY_COLOURS(k), label=f"{share:.0%} of the posterior")
            for k, share in enumerate((CORE_SHARE, FAMILY_SHARE))
        ),
        Line2D([], [], linestyle="", marker="x", color="black", markersize=5, label="simulated"),
        *(Line2D([], [], markersize=9, label=label, **_pair_look(name)) for name, label in labels.items()),
    ]


def _pair_look(name: str) -> dict[str, Any]:
    ours = name == RECOMMENDED
    return {
        "linestyle": "",
        "marker": "*" if ours else "D",
        "color": "white" if ours else OTHERS,
        "markeredgecolor": "black",
    }


def _pair_label(name: str, values: Mapping[str, float]) -> str:
    return f"{name.replace('_', ' ')}\n({', '.join(f'{value:.2f}' for value in values.values())})"


# ---------------------------------------------------------------- pairs against what was measured


def pairs_against_bands(statements: pd.DataFrame, published: pd.Series, remarks: Sequence[str]) -> Figure:
    """Draw the responses of every pair beside the measured bands; published: of the compared pair, as printed."""
    responses = list(dict.fromkeys(statements["response"]))
    figure = new_figure(remarks, 3.6 if len(responses) < 3 else LARGEST_HEIGHT)
    for name, axes in facets(figure, responses).items():
        part = statements[statements["response"] == name]
        low = part["measured"].iloc[0] - BAND * part["measured_deviation"].iloc[0]
        high = part["measured"].iloc[0] + BAND * part["measured_deviation"].iloc[0]
        axes.axhspan(low, high, color=OTHER_COLOUR, alpha=0.25, linewidth=0)
        for place, (_, row) in enumerate(part.iterrows()):
            look = _pair_look(row["pair"]) | {"color": OURS if row["pair"] == RECOMMENDED else OTHERS}
            axes.errorbar(
                place - 0.08,
                row["simulated"],
                yerr=row["simulated_uncertainty"],
                capsize=3,
                ecolor="black",
                markersize=8,
                **look,
            )
            axes.errorbar(
                place + 0.12,
                row["predicted"],
                yerr=row["predicted_deviation"],
                capsize=3,
                color=OTHER_COLOUR,
                marker="_",
            )
        if name in published and np.isfinite(published[name]):
            axes.plot(
                len(part) - 1 + 0.3, published[name], marker="D", color="white", markeredgecolor=OTHERS, linestyle=""
            )
        axes.set_xticks(range(len(part)), [pair.replace("_", " ") for pair in part["pair"]])
        axes.set_xlim(-0.6, len(part) - 0.4)
        axes.set_title(response_name(name), loc="left", fontsize=SMALLEST_FONT)
    _explain_bands(figure)
    return figure


def _explain_bands(figure: Figure) -> None:
    """Add the legend of `pairs_against_bands`; both pairs' marks stand for what was simulated here."""
    look = {"linestyle": "", "markersize": 8}
    ours = tuple(
        Line2D([], [], marker=marker, color=colour, markeredgecolor="black", **look)
        for marker, colour in (("*", OURS), ("D", OTHERS))
    )
    handles = {
        "measured, ± one standard deviation": Patch(color=OTHER_COLOUR, alpha=0.25),
        "simulated here, mean of seeds": ours,
        "surrogate": Line2D([], [], marker="_", color=OTHER_COLOUR, **look),
        "compared pair, simulated by others": Line2D([], [], marker="D", color="white", markeredgecolor=OTHERS, **look),
    }
    together = {tuple: HandlerTuple(ndivide=None, pad=0.6)}
    figure.legend(
        handles.values(), handles.keys(), loc="outside upper center", ncols=2, handler_map=together, handlelength=2.5
    )


# ---------------------------------------------------------------- box sizes, and what to simulate or measure next


def box_sizes(sizes: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the shear angle against length and against width of the box, with the published ones.

    sizes: row, varied (length or width), length_mm, width_mm, mean, deviation, seeds; published: length_mm, width_mm,
    shear_angle_deg, deviation_deg
    """
    figure = new_figure(remarks, 3.8)
    axes = figure.subplots(1, 2, sharey=True)
    for each, what in zip(axes, ("length", "width"), strict=True):
        part = sizes[sizes["varied"].str.contains(what)].sort_values(f"{what}_mm")
        each.errorbar(
            part[f"{what}_mm"],
            part["mean"],
            yerr=part["deviation"],
            marker="o",
            color=OURS,
            capsize=3,
            label="simulated here",
        )
        shown = published if what == "length" else published.iloc[:0]
        if len(shown):
            each.errorbar(
                shown["length_mm"],
                shown["shear_angle_deg"],
                yerr=shown["deviation_deg"],
                marker="D",
                color=OTHERS,
                capsize=3,
                linestyle="--",
                label="Yan 2022, Table 3.3",
            )
        each.set_xlabel(f"{what.capitalize()}{' and height' if what == 'length' else ''} of the box (mm)")
        each.legend()
    axes[0].set_ylabel("Shear angle (°)")
    return figure


def progress_and_information(
    looks: pd.DataFrame, stop: float, information: pd.DataFrame, remarks: Sequence[str]
) -> Figure:
    """Draw how the surrogate's share of the variance fell with simulations, and what each response would still tell."""
    figure = new_figure(remarks, 3.6)
    left, right = figure.subplots(1, 2)
    before = 0
    for (test, part), colour in zip(looks.groupby("test", sort=False), (OURS, OTHERS, OTHER_COLOUR), strict=False):
        left.plot(
            before + part["simulations"],
            part["surrogate_share"],
            marker="o",
            color=colour,
            label=test.replace("_", " "),
        )
        before += int(part["simulations"].max())
    left.axhline(stop, color="black", linestyle="--", linewidth=1.0, label="stopping rule")
    left.set(xlabel="Simulations", ylabel="Surrogate's share of the variance (-)", ylim=(0.0, 1.0))
    left.xaxis.get_major_locator().set_params(integer=True)
    left.legend()
    names = [response_name(name) for name in information["response"]][::-1]
    right.barh(names, information["information_bits"][::-1], height=0.5, color=OURS)
    right.set(xlabel="Expected information (bit)", ylim=(-1.0, len(names)))
    right.grid(axis="y", visible=False)
    return figure
