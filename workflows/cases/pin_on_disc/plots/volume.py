"""Volume of the pin-on-disc study: against revolutions, what exceeds alpha F L, calibration, comparison."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import (
    LARGEST_HEIGHT,
    OTHER_COLOUR,
    PUBLISHED,
    SMALLEST_FONT,
    facets,
    label_all,
    named_once,
    new_figure,
)
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.postproc.wear.coefficient import scaling_factor
from bulkwear.workflows.cases.pin_on_disc.coefficient import PUBLISHED_FITS, TOUCHED
from bulkwear.workflows.cases.pin_on_disc.plots.contours import (
    LABORATORY_COLOUR,
    LAW_COLOUR,
    SCHEME_COLOURS,
    SCHEME_MARKERS,
    SCHEME_NAMES,
    coefficient_name,
)
from bulkwear.workflows.cases.pin_on_disc.runs import same_coefficient
from bulkwear.workflows.cases.pin_on_disc.volume import (
    CANDIDATES,
    VOLUMES,
    law_volume,
    published_volume,
    trend_words,
)

CANDIDATE_COLOURS = dict(zip(CANDIDATES, ("#56B4E9", "#999999", "#F0E442", "#E69F00", "#CC79A7"), strict=True))
UNEXPLAINED_LOOK = {"color": "white", "edgecolor": "black", "hatch": "////", "linewidth": 0.6}
BAR = 0.13  # of the space of a run
SHOWN_FORCES = (0.98, 1.05)  # -, of the load, at least
ROW_HEIGHT, ROOM = 0.32, 0.22  # inches of a compared case; beside the longest bar for its words, over its length
HEADROOM = 1.3  # -, of the highest bar
VOLUME_LOOKS = {  # volume, line and what it is called
    "removed": ("-", "removed from the surface"),
    "Eq 5.9, touched": (":", "Eq 5.9 over touched triangles"),
}


def wear_volume(volumes: pd.DataFrame, fits: pd.DataFrame, trends: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw volume (mm3) against revolutions, a panel per wear coefficient: both schemes, the published fit, alpha F L.

    volumes : as from `volume.beside_laws`, whose published volumes say which coefficients have a fit beside them;
    fits : coefficients of Eq 5.11-5.15; trends : as from `volume.volume_trends`.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    coefficients = sorted(volumes["wear_coefficient_per_pa"].unique())
    panels = facets(figure, coefficients, most=3)  # their titles are long
    for coefficient, axes in panels.items():
        chosen = volumes[volumes["wear_coefficient_per_pa"] == coefficient]
        _volume_panel(axes, chosen, coefficient, fits)
        said = [coefficient_name(coefficient), *_changes(same_coefficient(trends, coefficient))]
        axes.set_title("\n".join(said), loc="left", fontsize=SMALLEST_FONT)
        axes.set_xlim(0.0, volumes["revolution"].max() + 0.5)
        axes.set_ylim(bottom=0.0)
    label_all(figure, len(coefficients) > 1, "Revolutions", "Volume (mm³)")
    figure.legend(*named_once(panels.values()), loc="outside upper center", ncols=2)
    return figure


def _changes(trends: pd.DataFrame) -> list[str]:
    """Return what is drawn of a coefficient's volumes in words: the change of what a revolution adds."""
    return [
        f"{row.scheme.replace('_', ' ') if row.volume == 'removed' else row.volume}: {trend_words(row)}"
        for row in trends.itertuples()
        if row.volume in VOLUME_LOOKS and (row.volume == "removed" or row.scheme == "per_triangle")
    ]


def _volume_panel(axes: Axes, chosen: pd.DataFrame, coefficient: float, fits: pd.DataFrame) -> None:
    x = np.linspace(0.0, chosen["revolution"].max(), 61)
    for load, track in chosen[["load_n", "track_radius_m"]].drop_duplicates().itertuples(index=False):
        law = law_volume(coefficient, load, track, x)
        axes.plot(x, CUBIC_MILLIMETRES * law, color=LAW_COLOUR, linewidth=1.2, label=r"$\alpha F L$")
    if chosen["published_volume_m3"].notna().any():
        of_theirs = published_volume(fits, coefficient, x[x >= 1.0])
        axes.plot(x[x >= 1.0], CUBIC_MILLIMETRES * of_theirs, label=PUBLISHED_FITS, **PUBLISHED)
    for (_, scheme), run in chosen.groupby(["run", "scheme"], sort=False):
        for volume, (style, words) in VOLUME_LOOKS.items():
            if volume != "removed" and scheme != "per_triangle":
                continue  # a conserving patch moves triangles that nothing touches: the sum says nothing of it
            look = {"color": SCHEME_COLOURS[scheme], "linewidth": 1.0, "markersize": 3.0}
            name = f"{scheme.replace('_', ' ')}, {words}"
            values = CUBIC_MILLIMETRES * run[VOLUMES[volume]]
            axes.plot(run["revolution"], values, SCHEME_MARKERS[scheme] + style, label=name, **look)


def force_rise(factors: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw the vertical and the summed normal force over the load, and the contacts at once, against revolutions.

    factors : as from `volume.excess_factors`, all runs of the series of coefficients.
    """
    figure = new_figure(remarks)
    panels = {
        "vertical_force_over_load": "Vertical force over load (-)",
        "force_rise": "Sum of normal forces over load (-)",
        "contacts": "Contacts at once (-)",
    }
    grid = figure.subplots(1, len(panels), sharex=True)
    coefficients = sorted(factors["wear_coefficient_per_pa"].unique())
    for axes, (column, label) in zip(grid, panels.items(), strict=True):
        for (_, scheme, coefficient), run in factors.groupby(["run", "scheme", "wear_coefficient_per_pa"], sort=False):
            weight = 0.6 + 1.8 * coefficients.index(coefficient) / max(len(coefficients) - 1, 1)
            look = {"color": SCHEME_COLOURS[scheme], "linewidth": weight, "markersize": 3.0}
            axes.plot(run["revolution"], run[column], f"{SCHEME_MARKERS[scheme]}-", label=SCHEME_NAMES[scheme], **look)
        axes.set(xlabel="Revolutions", ylabel=label)
    for axes in grid[:2]:
        axes.axhline(1.0, color="black", linewidth=0.8, linestyle="--")
        low, high = axes.get_ylim()
        axes.set_ylim(min(low, SHOWN_FORCES[0]), max(high, SHOWN_FORCES[1]))  # a thousandth is not to look like much
    thin, thick = coefficient_name(coefficients[0]), coefficient_name(coefficients[-1])
    grid[0].set_title(f"thin: {thin}, thick: {thick}; mean since the start", loc="left", fontsize=SMALLEST_FONT)
    figure.legend(*named_once(grid), loc="outside upper center", ncols=2)
    return figure


def excess_volume(factors: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw what volumes over alpha F L are made of: factor upon factor on a log axis, and the published one beside.

    factors : as from `volume.excess_factors`, the rows to show, in order.
    """
    figure = new_figure(remarks, 4.6)
    axes = figure.subplots()
    places = np.arange(len(factors))
    reached = np.cumprod(factors[[*CANDIDATES, "unexplained"]].fillna(1.0).to_numpy(), axis=1)
    steps = np.column_stack([np.ones(len(factors)), reached])
    looks = [{"color": colour} for colour in CANDIDATE_COLOURS.values()]
    names = [*CANDIDATES.values(), "left unexplained"]
    for index, (look, words) in enumerate(zip([*looks, UNEXPLAINED_LOOK], names, strict=True)):
        place = places + BAR * (index - 0.5 * (len(names) - 1))
        axes.bar(place, steps[:, index + 1] - steps[:, index], BAR, bottom=steps[:, index], label=words, **look)
    end = places + BAR * (0.5 * len(names) + 0.5)
    axes.plot(end, factors["published"], "D", color="black", markersize=5, label="published (Eq 5.11 to 5.15)")
    axes.axhline(1.0, color="black", linewidth=0.8)
    axes.set_yscale("log", base=2)
    axes.set_ylim(top=HEADROOM * steps.max())
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_ylabel(r"Volume over $\alpha F L$ (-)")
    axes.set_xticks(places, [_factor_name(row) for _, row in factors.iterrows()], fontsize=SMALLEST_FONT)
    figure.legend(loc="outside upper center", ncols=2)
    return figure


def _factor_name(row: pd.Series) -> str:
    scheme = row["scheme"].replace("_", " ")
    return f"{scheme}\n{row['wear_coefficient_per_pa']:.2g} 1/Pa\nrevolution {row['revolution']:.0f}"


def calibration(
    table: pd.DataFrame,
    laboratory: tuple[float, float],
    test_revolutions: float,
    limits: pd.DataFrame,
    remarks: Sequence[str],
) -> Figure:
    """Draw the coefficient that makes N revolutions stand for the test, with its range, and Archard's own.

    table : as from `coefficient.calibration_table`; laboratory : coefficient and error (1/Pa); limits : as
    from `coefficient.scaling_limits`, one run per scheme.
    """
    figure = new_figure(remarks, 4.6)
    axes = figure.subplots()
    x = np.linspace(table["revolutions"].min() - 0.5, table["revolutions"].max() + 0.5, 101)
    line, band = (scaling_factor(test_revolutions, x) * value for value in laboratory)
    axes.plot(x, line, color=LABORATORY_COLOUR, label="laboratory's coefficient times scaling factor (Archard)")
    axes.fill_between(x, line - band, line + band, color=LABORATORY_COLOUR, alpha=0.2)
    looks = SCHEME_COLOURS | {TOUCHED: CANDIDATE_COLOURS["summing_rule"], PUBLISHED_FITS: "black"}
    for index, (scheme, rows) in enumerate(table.groupby("scheme", sort=False)):
        best, least, most = (rows[f"{part}wear_coefficient_per_pa"] for part in ("", "least_", "largest_"))
        place = rows["revolutions"] + 0.1 * (index - 1)
        look = {"fmt": SCHEME_MARKERS.get(scheme, "x"), "color": looks[scheme], "markersize": 5, "capsize": 2.5}
        axes.errorbar(place, best, [best - least, most - best], label=SCHEME_NAMES.get(scheme, scheme), **look)
        beyond = ~rows["interpolated"].astype(bool)
        words = "beyond the simulated coefficients: in proportion" if index == 0 else None
        axes.plot(
            place[beyond], best[beyond], "o", markersize=10, markerfacecolor="none", color=OTHER_COLOUR, label=words
        )
    shown = limits[(test_revolutions / limits["largest_factor"]).between(x[0], x[-1])]
    for index, (words, factor) in enumerate(zip(shown["run"], shown["largest_factor"], strict=True)):
        axes.axvline(test_revolutions / factor, color=OTHER_COLOUR, linewidth=0.8, linestyle=":")
        axes.text(
            test_revolutions / factor,
            0.6 - 0.08 * index,  # between the coefficients by the two rules
            f" {words}: at most {factor:.1f}",
            va="center",
            fontsize=SMALLEST_FONT,
            transform=axes.get_xaxis_transform(),
        )
    axes.set(
        yscale="log", xlabel="Simulated revolutions that stand for the test", ylabel=r"Wear coefficient (Pa$^{-1}$)"
    )
    axes.set_xticks(sorted(table["revolutions"].unique()))
    top = axes.secondary_xaxis("top", functions=(_reciprocal(test_revolutions), _reciprocal(test_revolutions)))
    top.set_xlabel("Scaling factor (-)")
    figure.legend(loc="outside upper center", ncols=2)
    return figure


def _reciprocal(revolutions: float):
    """Function that turns simulated revolutions into scaling factors, and back."""
    return lambda value: revolutions / np.maximum(value, 1e-9)


def size_invariance(table: pd.DataFrame, published_percent: float, remarks: Sequence[str]) -> Figure:
    """Draw simulated over theoretical volume against the scale of the pin, and the published bound.

    table : as from `volume.size_invariance`.
    """
    figure = new_figure(remarks)
    axes = figure.subplots()
    axes.axhspan(
        -published_percent,
        published_percent,
        color="#eeeeee",
        label=f"Yan 2022, Fig 4.6: under {published_percent:g} %",
    )
    axes.axhline(0.0, color=LAW_COLOUR, label=r"$\alpha F L$")
    axes.plot(
        table["particle_scale"],
        table["difference_percent"],
        "o-",
        color=SCHEME_COLOURS["conserving"],
        label="simulated, one revolution",
    )
    axes.set(xlabel="Scale of the pin (-)", ylabel="Volume less that of Archard's law (%)")
    axes.set_xticks(table["particle_scale"])
    figure.legend(loc="outside upper center", ncols=3)
    return figure


def _case_colour(case: str) -> str:
    """Colour of a compared case by its name."""
    known = {"laboratory": LABORATORY_COLOUR, "Yan 2022": "black"}
    schemes = {scheme.replace("_", " "): colour for scheme, colour in SCHEME_COLOURS.items()}
    return known.get(case) or schemes.get(case.partition(",")[0], OTHER_COLOUR)


def comparison(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw depth, width and volume of laboratory, thesis and our runs, each with its difference from the laboratory.

    table : as from `comparison.comparison`.
    """
    figure = new_figure(remarks, 1.6 + ROW_HEIGHT * len(table))
    units = {"depth": "mm", "width": "mm", "volume": "mm³"}
    drawn = figure.subplots(1, len(units), sharey=True)
    places = -np.arange(len(table))
    colours = [_case_colour(case) for case in table["case"]]
    for axes, (quantity, unit) in zip(drawn, units.items(), strict=True):
        values = table[f"{quantity}_{'mm3' if quantity == 'volume' else 'mm'}"]
        bars = axes.barh(places, values, 0.6, color=colours)
        axes.axvline(values.iloc[0], color=LABORATORY_COLOUR, linewidth=0.8, linestyle="--")
        off = [f"{round(each) + 0.0:+.0f} %" if each else "" for each in table[f"{quantity}_to_laboratory_percent"]]
        axes.bar_label(bars, off, padding=2.0, fontsize=SMALLEST_FONT)
        axes.margins(x=ROOM)
        axes.set_xlabel(f"{quantity.capitalize()} ({unit})")
    drawn[0].set_yticks(places, table["case"])
    return figure
