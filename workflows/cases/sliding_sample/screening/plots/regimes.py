"""Figures by flow regime: patterned runs beside their plain twins, best designs beside what was predicted of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.plots.style import (
    BASE_COLOUR,
    LARGEST_HEIGHT,
    OTHER_COLOUR,
    PATTERN_COLOUR,
    SMALLEST_FONT,
    colour,
    marker,
    new_figure,
    scaled,
)
from bulkwear.postproc.tables.summary import patterned_name
from bulkwear.workflows.cases.sliding_sample.plots.bars import draw_intervals, highest_shown
from bulkwear.workflows.cases.sliding_sample.screening.confirmation import interval_reach

BAR = 0.4  # -, width of a bar over the distance of rows
PLAIN_FILL = "#f4c9a8"  # of the plain samples' bars
HEADROOM = 1.08  # -, of the highest bar
ROOM = 1.05  # -, of the largest value on the axis of a confirmation


def wear_by_regime(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw relative wear of patterned (base and pattern, stacked) and plain samples with intervals, least wear first.

    table: as from `regime_groups.wear_by_group`
    """
    highest = highest_shown([1.0], table["interval_high"])
    figure = new_figure(remarks, LARGEST_HEIGHT)
    for axes, shown in _panels(figure, table, "relative_wear"):
        patterned, plain = shown[shown["surface"] != PLAIN], shown[shown["surface"] == PLAIN]
        left = _places(patterned) - 0.5 * BAR
        axes.bar(left, patterned["base_relative_wear"], BAR, color=BASE_COLOUR)
        pattern = {"color": PATTERN_COLOUR, "hatch": "//", "edgecolor": "white"}
        axes.bar(left, patterned["bump_relative_wear"], BAR, bottom=patterned["base_relative_wear"], **pattern)
        axes.bar(_places(plain) + 0.5 * BAR, plain["relative_wear"], BAR, color=PLAIN_FILL, edgecolor=colour(PLAIN))
        for places, runs in ((left, patterned), (_places(plain) + 0.5 * BAR, plain)):
            draw_intervals(axes, places, runs["relative_wear"], runs)
        axes.set_ylim(0.0, HEADROOM * highest)
    figure.axes[0].set_ylabel("Wear over the largest of the regime (-)")
    name = patterned_name(table["surface"])
    handles = [
        Patch(color=BASE_COLOUR, label=f"{name}, base"),
        Patch(facecolor=PATTERN_COLOUR, hatch="//", edgecolor="white", label=f"{name}, pattern"),
        Patch(facecolor=PLAIN_FILL, edgecolor=colour(PLAIN), label="plain"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=3)
    return figure


def normal_force_by_regime(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the mean normal force (N) on patterned and plain samples with its interval.

    table: as from `regime_groups.force_by_group`
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    for axes, shown in _panels(figure, table, "mean_normal_force_N"):
        for shift, (surface, runs) in zip((-0.5, 0.5), _by_surface(shown), strict=False):
            places = _places(runs) + shift * BAR
            axes.bar(places, runs["mean_normal_force_N"], BAR, color=colour(surface))
            draw_intervals(axes, places, runs["mean_normal_force_N"], runs)
    highest = highest_shown(table["mean_normal_force_N"], table["interval_high"])
    figure.axes[0].set_ylim(0.0, HEADROOM * highest)
    figure.axes[0].set_ylabel("Normal force on the sample (N)")
    handles = [Patch(color=colour(surface), label=surface) for surface in dict.fromkeys(table["surface"])]
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))
    return figure


def _by_surface(table: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
    """Return the runs of each surface, plain ones last."""
    groups = list(table.groupby("surface", sort=False))
    return sorted(groups, key=lambda group: group[0] == PLAIN)


def _places(runs: pd.DataFrame) -> np.ndarray:
    return runs["place"].to_numpy(dtype=float)


def _panels(figure: Figure, table: pd.DataFrame, column: str) -> list[tuple[Axes, pd.DataFrame]]:
    """Return axes and lines, with their `place` on the axis, of each regime; panels are as wide as they have settings.

    Settings stand in the order of the column's values of their patterned samples.
    """
    regimes = list(dict.fromkeys(table["regime"]))
    counts = [table.loc[table["regime"] == regime, "setting"].nunique() for regime in regimes]
    grid = figure.subplots(1, len(regimes), sharey=True, squeeze=False, width_ratios=np.maximum(counts, 2))[0]
    panels = []
    for axes, regime in zip(grid, regimes, strict=True):
        shown = table[table["regime"] == regime]
        patterned = shown[shown["surface"] != PLAIN].sort_values(column, kind="stable")["setting"]
        rows = list(dict.fromkeys([*patterned, *shown["setting"]]))
        axes.set_xticks(range(len(rows)), rows)
        axes.set_xlim(-0.6, len(rows) - 0.4)
        axes.grid(axis="x", visible=False)
        axes.set_title(regime, loc="left", fontsize=SMALLEST_FONT)
        axes.set_xlabel("Design row")
        panels.append((axes, shown.assign(place=shown["setting"].map(rows.index))))
    return panels


def confirmation(table: pd.DataFrame, patterned: str, remarks: Sequence[str]) -> Figure:
    """Draw the predicted wear per metre (mm3/m) of each best design with its interval, and what the runs wear.

    table: as from `confirmation.confirmation_table`; patterned: the surface that is confirmed.
    """
    figure = new_figure(remarks, 2.6 + 0.7 * len(table))
    axes = figure.subplots()
    lines = -np.arange(len(table), dtype=float)
    drawn = {"fmt": "D", "color": OTHER_COLOUR, "markerfacecolor": "white", "capsize": 5}
    label = "predicted, with the interval of one run (95 %)"
    axes.errorbar(table["predicted_mm3_per_m"], lines, xerr=interval_reach(table), label=label, **drawn)
    for surface, column in ((patterned, "simulated_mm3_per_m"), (PLAIN, "plain_mm3_per_m")):
        marks = {"color": colour(surface), "markersize": 8, "linestyle": "", "label": f"simulated, {surface}"}
        axes.plot(table[column], lines, marker(surface), zorder=3, **marks)
    for place, inside, ratio in zip(lines, table["inside"], table["over_predicted"], strict=True):
        words = f"{'inside' if inside else 'outside'}, {ratio:.2f} of the prediction"
        axes.text(1.0, place + 0.18, words, transform=axes.get_yaxis_transform(), ha="right", fontsize=SMALLEST_FONT)
    largest = float(table.filter(like="mm3_per_m").max(axis=None))
    unit, ticks = scaled("mm³/m", largest)
    axes.set_xlim(0.0, ROOM * largest)
    axes.xaxis.set_major_formatter(ticks)
    axes.set_xlabel(f"Wear per length of travel ({unit})")
    axes.set_yticks(lines, table["row"])
    axes.set_ylim(lines[-1] - 0.5, 0.5)
    axes.set_ylabel("Best design for")
    figure.legend(loc="outside upper center", ncols=3)
    return figure
