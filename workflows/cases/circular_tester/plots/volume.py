"""Figures of volumes in the circular wear tester: by revolution and hours, by machine, until a pattern is gone."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

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
    printed_table,
)
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.postproc.tables.summary import patterned_name, published_value
from bulkwear.workflows.cases.circular_tester.comparison import WORN_OUT_SHARE
from bulkwear.workflows.cases.circular_tester.tables import LABORATORY, OURS, THESIS, THESIS_ALIKE
from bulkwear.workflows.cases.circular_tester.volume import (
    CONVEX,
    TERMS,
    chosen_fit,
    fit_at,
    of_surface,
    published_terms,
    volume_at,
)

CURVE_POINTS = 101
NOTE_CHARACTERS = 105  # of a line over a printed table
SCALE_STYLES = {1: "-", 2: "--", 3: "-.", 4: ":"}
LABORATORY_COLOUR = "#CC79A7"
BARS = 0.8  # of the space of a case
MACHINE_STYLES = {"channel": "-", "ring": "--"}
SHIFT = 0.05  # revolutions that two machines stand apart


def _case_name(surface: str, scale: float) -> str:
    return f"{surface}, particle scale {scale:g}"


def volume_by_revolution(
    volumes: pd.DataFrame, fits: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]
) -> Figure:
    """Draw lost volume (mm3) against revolutions with fits, the published ones beside, numbers below (Fig 6.11).

    volumes, fits: as from `volume`; published: Eq 6.2 to 6.6. Published cases that no run has are drawn
    thin and grey.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    axes, printed = figure.subplots(2, 1)
    x = np.linspace(0.0, volumes["revolution"].max(), CURVE_POINTS)
    ours = set()
    for (run, surface, scale), of_run in volumes.groupby(["run", "surface", "particle_scale"], sort=False):
        ours.add((surface, scale))
        look = {"color": colour(surface), "linestyle": SCALE_STYLES.get(round(scale), "-")}
        mark, look["linewidth"] = {"marker": marker(surface), "markersize": 4}, 1.0
        axes.plot(of_run["revolution"], CUBIC_MILLIMETRES * of_run["volume_m3"], **mark, **look | {"linestyle": "none"})
        axes.plot(x, volume_at(chosen_fit(fits, run), x), **look)
        axes.plot([], [], label=_case_name(surface, scale), **mark, **look)  # points and fit together in the legend
    for row in published.itertuples():
        same = (row.surface, row.particle_scale) in ours
        look = PUBLISHED if same else PUBLISHED | {"color": "#999999", "linewidth": 0.7}
        name = row.source.partition(" (")[0] if same else "Yan 2022, other cases"
        axes.plot(x, volume_at(np.array([getattr(row, term) for term in TERMS]), x), label=name, **look)
    axes.set(xlabel="Revolutions", ylabel="Lost volume (mm³)", xlim=(0.0, None), ylim=(0.0, None))
    figure.legend(*named_once([axes]), loc="outside upper center", ncols=3)
    _fit_table(printed, fits, published)
    return figure


def _fit_table(axes: Axes, fits: pd.DataFrame, published: pd.DataFrame) -> None:
    """Print a line per run: its linear and its quadratic fit, and the published one of its case."""
    head = ["", "a x: a (mm³)", "R²", "a x + b x²: a (mm³)", "b (mm³)", "R²", "Yan 2022: a, b (mm³)"]
    cells = []
    for _, of_run in fits.groupby("run", sort=False):
        rows = of_run.set_index("fit")
        line, curve = rows.loc["linear"], rows.loc["quadratic"]
        shown = [_with_error(line, TERMS[0]), f"{line['r_squared']:.5f}"]
        shown += [*(_with_error(curve, term) for term in TERMS), f"{curve['r_squared']:.5f}"]
        theirs = published_terms(published, line["surface"], line["particle_scale"])
        known = "" if np.isnan(theirs).any() else ", ".join(f"{term:g}" for term in theirs)
        cells.append([f"{line['surface']}, scale {line['particle_scale']:g}", *shown, known])
    printed_table(axes, head, cells)


def _with_error(row: pd.Series, term: str) -> str:
    return f"{row[term]:.3g} ± {row[f'{term}_error']:.2g}"


def element_increments(
    increments: pd.DataFrame, crossings: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]
) -> Figure:
    """Draw what an element and what the sample lose per revolution (Eq 6.7, Fig 6.12).

    increments: as from `volume.element_increments`; crossings: particle_scale, rate_crossing and
    crossing (revolutions), drawn as lines where they are inside; published: circular_tester.csv.
    """
    figure = new_figure(remarks, 4.4)
    left, right = figure.subplots(1, 2)
    for (_, surface, scale), of_run in increments.groupby(["run", "surface", "particle_scale"], sort=False):
        look = {"color": colour(surface), "linestyle": SCALE_STYLES.get(round(scale), "-")}
        look |= {"marker": marker(surface), "markersize": 3.5, "linewidth": 1.0}
        name = _case_name(surface, scale)
        left.plot(of_run["revolution"], of_run["element_increment_mm3"], label=name, **look)
        right.plot(of_run["revolution"], of_run["increment_mm3"], label=name, **look)
    ends = [published_value(published, f"plain_{which}_increment", "simulation") for which in ("first", "last")]
    last = published_value(published, "last_revolution", "simulation")
    left.plot([1.0, last], ends, label="Yan 2022, Fig 6.12, plain", **PUBLISHED)
    theirs = published_value(published, "increments_cross_at", "simulation")
    words = "Yan 2022, convex of scale 4 overtakes plain"
    left.axvline(theirs, color="black", linewidth=0.8, linestyle=SCALE_STYLES[4], label=words)
    largest = increments["revolution"].max()
    for row in crossings.itertuples():
        if row.rate_crossing <= largest:
            right.axvline(
                row.rate_crossing,
                color=OTHER_COLOUR,
                linewidth=0.8,
                linestyle=SCALE_STYLES.get(round(row.particle_scale), "-"),
            )
    name = patterned_name(increments["surface"])
    said = "\n".join(crossing_words(row, name) for row in crossings.itertuples())
    right.set_title(said, loc="left", fontsize=SMALLEST_FONT)
    left.set(xlabel="Revolution", ylabel="Lost per revolution by an element (mm³)", ylim=(0.0, None))
    right.set(xlabel="Revolution", ylabel="Lost per revolution by the sample (mm³)", ylim=(0.0, None))
    figure.legend(*left.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def crossing_words(row: tuple, patterned: str) -> str:
    """Say when a patterned surface overtakes plain, in rate and in sum."""
    if not np.isfinite(row.rate_crossing):
        return f"scale {row.particle_scale:g}: {patterned} never wears faster"
    words = f"{patterned} faster from {row.rate_crossing:.3g}, more in sum from {row.crossing:.3g}"
    return f"scale {row.particle_scale:g}: {words}"


def benchmark(
    predicted: pd.DataFrame, published: pd.DataFrame, published_fits: pd.DataFrame, remarks: Sequence[str]
) -> Figure:
    """Draw volumes (mm3) after 56 hours: experiment, thesis and ours by particle scale (Fig 6.10).

    predicted: as from `volume.predictions`; published: circular_tester.csv; published_fits: Eq 6.2 to
    6.6 at the thesis' two revolutions.
    """
    hours = published_value(published, "short_test", "laboratory")
    theirs_at = published_value(published, "revolutions_of_short_test", "simulation")
    chosen = predicted[np.isclose(predicted["hours"], hours)]
    scales = sorted({*chosen["particle_scale"], *published_fits["particle_scale"]})
    figure = new_figure(remarks, 4.4)
    axes = figure.subplots()
    patterned = patterned_name(chosen["surface"])
    kinds = [(THESIS, PLAIN), (THESIS, CONVEX), (OURS, PLAIN), (OURS, patterned)]
    for index, (source, surface) in enumerate(kinds):
        values = []
        for scale in scales:
            ours = of_surface(chosen[chosen["particle_scale"] == scale], surface)["volume_mm3"]
            theirs = volume_at(published_terms(published_fits, surface, scale), theirs_at)
            values.append(theirs if source == THESIS else (ours.mean() if len(ours) else np.nan))
        places = np.arange(1, len(scales) + 1) + BARS * ((index + 0.5) / len(kinds) - 0.5)
        look = {"color": colour(surface), "hatch": "///" if source == THESIS else None, "edgecolor": "white"}
        axes.bar(places, values, BARS / len(kinds), label=f"{surface}, {source}", **look)
    for place, surface in zip((-0.2, 0.2), (PLAIN, CONVEX), strict=True):
        value = published_value(published, f"{surface}_volume_56_h", "laboratory")
        axes.bar(place, value, 0.35, color=colour(surface), alpha=0.5)
        axes.axhline(value, color=colour(surface), linewidth=0.8, linestyle=":")
    axes.set_xticks(range(len(scales) + 1), [LABORATORY, *(f"particle scale {scale:g}" for scale in scales)])
    axes.set_ylabel(f"Volume after {hours:g} h (mm³)")
    figure.legend(loc="outside upper center", ncols=4)
    return figure


def volume_by_hours(
    fits: pd.DataFrame,
    hours_per_revolution: float,
    table: pd.DataFrame,
    published: pd.DataFrame,
    remarks: Sequence[str],
) -> Figure:
    """Draw lost volume (mm3) against hours: measured points and rates, our fits, and the table below (Fig 6.4).

    fits: of the runs to draw, as from `volume.volume_fits`; table: as from `tables.comparison_table`.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    axes, printed = figure.subplots(2, 1, height_ratios=(3, 2))
    longest = published_value(published, "long_test", "laboratory")
    hours = np.linspace(0.0, longest, CURVE_POINTS)
    interval = published_value(published, "interval", "laboratory")
    for surface in (PLAIN, CONVEX):
        rate = published[published["quantity"] == f"{surface}_volume_per_interval"].iloc[0]
        low, high = ((rate["value"] + sign * rate["uncertainty"]) / interval * hours for sign in (-1.0, 1.0))
        words = f"{surface}, measured per {interval:g} h"
        axes.fill_between(hours, low, high, color=colour(surface), alpha=0.15, linewidth=0.0, label=words)
        for length in ("short", "long"):
            end = published_value(published, f"{length}_test", "laboratory")
            value = published_value(published, f"{surface}_volume_{end:g}_h", "laboratory")
            extrapolated = surface == PLAIN and length == "long"
            fill = "none" if extrapolated else colour(surface)
            axes.plot(
                end,
                value,
                marker(surface),
                color=colour(surface),
                markerfacecolor=fill,
                markersize=7,
                label=f"{surface}, measured" if length == "short" else None,
            )
    for (run, surface, scale), _ in fits.groupby(["run", "surface", "particle_scale"], sort=False):
        curve = [volume_at(fit_at(fits, run, each), each) for each in hours / hours_per_revolution]
        look = {"color": colour(surface), "linestyle": SCALE_STYLES.get(round(scale), "-")}
        axes.plot(hours, curve, label=f"{_case_name(surface, scale)}, ours", **look)
    axes.set_title(
        "open mark: extrapolated, plain was tested for 56 h; the plain sample sets our hours",
        loc="left",
        fontsize=SMALLEST_FONT,
    )
    axes.set(xlabel="Hours of the test", ylabel="Lost volume (mm³)", xlim=(0.0, None), ylim=(0.0, None))
    figure.legend(*named_once([axes]), loc="outside upper center", ncols=3)
    _numbers(printed, table)
    return figure


def _numbers(axes: Axes, table: pd.DataFrame) -> None:
    """Print the volumes compared; numbers in brackets lead to the notes in its title."""
    columns = [LABORATORY, THESIS, THESIS_ALIKE, OURS]
    shown = table[table["unit"] != "mm"]
    notes = list(dict.fromkeys(note for words in shown["note"] if words for note in words.split("; ")))
    cells = []
    for _, row in shown.iterrows():
        marks = ", ".join(str(notes.index(note) + 1) for note in row["note"].split("; ") if note)
        words = f"{row['quantity']} ({row['unit'].replace('mm3', 'mm³')}){f' [{marks}]' if marks else ''}"
        values = ["" if np.isnan(row[name]) else f"{row[name]:.4g}" for name in columns]
        cells.append([f"{row['hours']:g} h", words, *values])
    said = "\n".join(
        textwrap.wrap("; ".join(f"[{k}] {note}" for k, note in enumerate(notes, start=1)), NOTE_CHARACTERS)
    )
    axes.set_title(said, loc="left", fontsize=SMALLEST_FONT)
    printed_table(axes, ["", "", *columns], cells)


def channel_and_ring(
    volumes: pd.DataFrame, means: pd.DataFrame, ratios: pd.DataFrame, remarks: Sequence[str]
) -> Figure:
    """Draw volumes (mm3) and the ratio of patterned to plain in channel and ring by revolution.

    volumes: as from `volume.volumes`; ratios, means: as from `comparison`.
    """
    figure = new_figure(remarks, 4.4)
    left, right = figure.subplots(1, 2)
    for (_, surface, shape, scale), rows in volumes.groupby(["run", "surface", "shape", "particle_scale"], sort=False):
        look = {"color": colour(surface), "linestyle": MACHINE_STYLES[shape], "marker": marker(surface)}
        name, volume = f"{surface}, {shape}, scale {scale:g}", CUBIC_MILLIMETRES * rows["volume_m3"]
        left.plot(rows["revolution"], volume, markersize=3, linewidth=1.0, label=name, **look)
    said = []
    for place, ((shape, scale), rows) in enumerate(ratios.groupby(["shape", "particle_scale"], sort=False)):
        mean = means[(means["shape"] == shape) & (means["particle_scale"] == scale)].iloc[0]
        said.append(f"{shape}, scale {scale:g}: {mean['ratio']:.3f} ± {mean['standard_error']:.2g}")
        look = {"color": OTHER_COLOUR, "linestyle": MACHINE_STYLES[shape], "marker": "o^sD"[place % 4], "markersize": 4}
        right.plot(rows["revolution"] + 0.5 + SHIFT * place, rows["ratio"], linewidth=1.0, label=said[-1], **look)
    right.axhline(1.0, color="black", linewidth=0.8)
    shared, own = int(means["revolutions"].iloc[0]), patterned_name(volumes["surface"]).capitalize()
    words = f"Mean ± standard error of the first {shared} revolution{'s' * (shared > 1)}"
    right.set_title("\n".join([words, *said]), loc="left", fontsize=SMALLEST_FONT)
    left.set(xlabel="Revolutions", ylabel="Lost volume (mm³)", xlim=(0.0, None), ylim=(0.0, None))
    right.set(xlabel="Revolution", ylabel=f"{own} over plain, lost in a revolution (-)", ylim=(0.0, None))
    figure.legend(*named_once([left]), loc="outside upper center", ncols=3)
    return figure


def worn_out(left_of: pd.DataFrame, ends: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw what is left of the pattern, and what the sample loses per revolution, until the pattern is gone.

    left_of, ends: as from `comparison.pattern_left` and `worn_out_at`.
    """
    figure = new_figure(remarks, 4.4)
    share, rate = figure.subplots(1, 2, sharex=True)
    styles = dict(zip(ends["run"], ("-", "--", ":", "-.") * len(ends), strict=False))
    for run, rows in left_of.groupby("run", sort=False):
        end = ends[ends["run"] == run].iloc[0]
        times = rows["coefficient"].iloc[0] / left_of["coefficient"].min()
        name = f"{run.replace('_', ' ')}{f', coefficient x {times:g}' if times > 1.0 else ''}"
        look = {"color": BLUE, "linestyle": styles[run], "linewidth": 1.2}
        share.plot(rows["revolution"], 100.0 * rows["pattern_share"], label=name, **look)
        rate.plot(rows["revolution"], rows["mean_per_revolution_mm3"], label=name, **look)
        if np.isfinite(end["worn_out_revolution"]):
            share.axvline(end["worn_out_revolution"], color=OTHER_COLOUR, linewidth=0.8, linestyle=styles[run])
    share.axhline(100.0 * WORN_OUT_SHARE, color="black", linewidth=0.8, label=f"{100.0 * WORN_OUT_SHARE:g} %")
    rate.axhline(left_of["plain_per_revolution_mm3"].iloc[0], color=colour(PLAIN), linewidth=1.2, label="plain sample")
    share.set_title("\n".join(map(_end_words, ends.itertuples())), loc="left", fontsize=SMALLEST_FONT)
    rate.set_title("\n".join(_faster_words(row) for row in ends.itertuples()), loc="left", fontsize=SMALLEST_FONT)
    words = "Revolutions at the study's coefficient"
    share.set(xlabel=words, ylabel="Pattern left (% of its volume)", ylim=(0.0, None), xlim=(0.0, None))
    rate.set(xlabel=words, ylabel="Lost per revolution (mm³)", ylim=(0.0, None))
    figure.legend(*named_once([share, rate]), loc="outside upper center", ncols=3)
    return figure


def _end_words(row: tuple) -> str:
    name = row.run.replace("_", " ")
    if np.isfinite(row.worn_out_revolution):
        return f"{name}: gone at {row.worn_out_revolution:.3g}"
    return f"{name}: {100.0 * row.last_share:.3g} % left"


def _faster_words(row: tuple) -> str:
    name = row.run.replace("_", " ")
    if not np.isfinite(row.faster_revolution):
        return f"{name}: slower than plain throughout"
    return f"{name}: first faster than plain at {row.faster_revolution:.3g}, {100.0 * row.faster_share:.2g} % left"
