"""Figures of volumes in the circular wear tester: by revolution and hours, by machine, until a pattern is gone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.container import BarContainer
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
)
from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.tables.summary import patterned_name, published_value
from bulkwear.workflows.cases.circular_tester.comparison import WORN_OUT_SHARE
from bulkwear.workflows.cases.circular_tester.packings import HIGH, LOW, errorbars
from bulkwear.workflows.cases.circular_tester.source import CONVEX
from bulkwear.workflows.cases.circular_tester.tables import LABORATORY, OURS, THESIS
from bulkwear.workflows.cases.circular_tester.volume import (
    TERMS,
    of_surface,
    published_terms,
    settings_of,
    volume_of_terms,
)

CURVE_POINTS = 101
SCALE_STYLES = {1: "-", 2: "--", 3: "-.", 4: ":"}
LABORATORY_COLOUR = "#CC79A7"
GIVEN = 1e-6  # -, of the measured volume: as near is the sample that sets the scale of time
BARS = 0.8  # of the space of a case
MACHINE_STYLES = {"channel": "-", "ring": "--"}
SHIFT = 0.05  # revolutions that two machines stand apart


def _case_name(surface: str, scale: float) -> str:
    return f"{surface}, particle scale {scale:g}"


def volume_by_revolution(volumes: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw lost volume (mm3) against revolutions, the published fits beside (Fig 6.11).

    volumes: as from `volume.mean_volumes`; published: Eq 6.2 to 6.6. Published cases that no run has are drawn thin and
    grey.
    """
    figure = new_figure(remarks, 4.6)
    axes = figure.subplots()
    x = np.linspace(0.0, volumes["revolution"].max(), CURVE_POINTS)
    ours = set()
    for setting, rows in settings_of(volumes):
        surface, scale = setting["surface"], setting["particle_scale"]
        ours.add((surface, scale))
        _with_intervals(axes, rows, "volume_mm3", _case_name(surface, scale), _look(surface, scale))
    for row in published.itertuples():
        same = (row.surface, row.particle_scale) in ours
        look = PUBLISHED if same else PUBLISHED | {"color": "#999999", "linewidth": 0.7}
        name = row.source.partition(" (")[0] if same else "Yan 2022, other cases"
        axes.plot(x, volume_of_terms(np.array([getattr(row, term) for term in TERMS]), x), label=name, **look)
    axes.set(xlabel="Revolutions", ylabel="Lost volume (mm³)", xlim=(0.0, None), ylim=(0.0, None))
    figure.legend(*named_once([axes]), loc="outside upper center", ncols=3)
    return figure


def _look(surface: str, scale: float) -> dict[str, object]:
    return {"color": colour(surface), "linestyle": SCALE_STYLES.get(round(scale), "-"), "marker": marker(surface)}


def _with_intervals(axes: Axes, rows: pd.DataFrame, value: str, label: str, look: dict[str, object]) -> None:
    """Draw means over packings against revolutions with their intervals, where these are known."""
    reach = errorbars(rows, value)
    bars = {"capsize": 2.0, "elinewidth": 0.7, "markersize": 3.5, "linewidth": 1.0}
    axes.errorbar(
        rows["revolution"], rows[value], reach if np.isfinite(reach).any() else None, label=label, **look, **bars
    )


def interval_text(row: tuple, name: str) -> str:
    """Return a mean with its interval from a row with <name>, <name>_low and <name>_high, in few words."""
    value, low, high = (getattr(row, f"{name}{ending}") for ending in ("", "_low", "_high"))
    if not np.isfinite(low):
        return f"{value:.3g}, {UNKNOWN}"
    return f"{value:.3g} ({low:.3g} to {high:.3g})"


def element_increments(
    increments: pd.DataFrame, ratios: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]
) -> Figure:
    """Draw what an element and what the sample lose per revolution (Eq 6.7, Fig 6.12).

    increments: as from `volume.mean_increments`; ratios: as from `comparison.mean_ratios`; published:
    circular_tester.csv.
    """
    figure = new_figure(remarks, 4.4)
    left, right = figure.subplots(1, 2)
    for setting, rows in settings_of(increments):
        surface, scale = setting["surface"], setting["particle_scale"]
        look, name = _look(surface, scale), _case_name(surface, scale)
        left.plot(rows["revolution"], rows["element_increment_mm3"], label=name, markersize=3.5, linewidth=1.0, **look)
        _with_intervals(right, rows, "increment_mm3", name, look)
    ends = [published_value(published, f"plain_{which}_increment", "simulation") for which in ("first", "last")]
    last = published_value(published, "last_revolution", "simulation")
    left.plot([1.0, last], ends, label="Yan 2022, Fig 6.12, plain", **PUBLISHED)
    theirs = published_value(published, "increments_cross_at", "simulation")
    words = "Yan 2022, convex of scale 4 overtakes plain"
    left.axvline(theirs, color="black", linewidth=0.8, linestyle=SCALE_STYLES[4], label=words)
    said = "\n".join(ratio_words(row) for row in ratios.itertuples())
    right.set_title(said, loc="left", fontsize=SMALLEST_FONT)
    left.set(xlabel="Revolution", ylabel="Lost per revolution by an element (mm³)", ylim=(0.0, None))
    right.set(xlabel="Revolution", ylabel="Lost per revolution by the sample (mm³)", ylim=(0.0, None))
    figure.legend(*left.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def ratio_words(row: tuple) -> str:
    """Say what patterned loses over plain, and how that changes over the run; row: of `comparison.mean_ratios`."""
    words = f"scale {row.particle_scale:g}: patterned over plain {row.ratio:.3g}"
    if not np.isfinite(row.ratio_low):
        return f"{words}, change {row.change_percent:.3g} %\n({UNKNOWN})"
    ends = f"{row.ratio_low:.3g} to {row.ratio_high:.3g}"
    change = f"{row.change_percent:.3g} % ({row.change_percent_low:.3g} to {row.change_percent_high:.3g})"
    return f"{words}\n({ends}), its change {change}"


def benchmark(
    predicted: pd.DataFrame, published: pd.DataFrame, published_fits: pd.DataFrame, remarks: Sequence[str]
) -> Figure:
    """Draw volumes (mm3) after 56 hours: experiment, thesis and ours by particle scale (Fig 6.10).

    predicted: as from `hours.predictions`; published: circular_tester.csv; published_fits: Eq 6.2 to
    6.6 at the thesis' two revolutions.
    """
    hours = published_value(published, "short_test", "laboratory")
    theirs_at = published_value(published, "revolutions_of_short_test", "simulation")
    chosen = predicted[np.isclose(predicted["hours"], hours)]
    plain_volume = published_value(published, f"{PLAIN}_volume_56_h", "laboratory")
    scales = sorted({*chosen["particle_scale"], *published_fits["particle_scale"]})
    figure = new_figure(remarks, 4.4)
    axes = figure.subplots()
    patterned = patterned_name(chosen["surface"])
    kinds = [(THESIS, PLAIN), (THESIS, CONVEX), (OURS, PLAIN), (OURS, patterned)]
    for index, (source, surface) in enumerate(kinds):
        if source == THESIS:
            terms = [published_terms(published_fits, surface, scale) for scale in scales]
            values, reach = [float(volume_of_terms(each, theirs_at)) for each in terms], None
        else:
            ours = of_surface(chosen, surface).drop_duplicates("particle_scale").set_index("particle_scale")
            ours = ours.reindex(scales)
            values = ours["volume_mm3"]
            reach = np.abs(ours[["volume_mm3_low", "volume_mm3_high"]].to_numpy(float).T - values.to_numpy(float))
        places = np.arange(1, len(scales) + 1) + BARS * ((index + 0.5) / len(kinds) - 0.5)
        look = {"color": colour(surface), "hatch": "///" if source == THESIS else None, "edgecolor": "white"}
        bars = {"yerr": reach, "capsize": 2.5} if reach is not None and np.isfinite(reach).any() else {}
        drawn = axes.bar(places, values, BARS / len(kinds), label=f"{surface}, {source}", **look, **bars)
        if source == OURS and surface == PLAIN:
            _mark_given(drawn, np.isclose(values, plain_volume, rtol=GIVEN))
    for place, surface in zip((-0.2, 0.2), (PLAIN, CONVEX), strict=True):
        value = published_value(published, f"{surface}_volume_56_h", "laboratory")
        axes.bar(place, value, 0.35, color=colour(surface), alpha=0.5)
        axes.axhline(value, color=colour(surface), linewidth=0.8, linestyle=":")
    axes.set_xticks(range(len(scales) + 1), [LABORATORY, *(f"particle scale {scale:g}" for scale in scales)])
    axes.set_ylabel(f"Volume after {hours:g} h (mm³)")
    figure.legend(loc="outside upper center", ncols=2)
    return figure


def _mark_given(bars: BarContainer, given: np.ndarray) -> None:
    """Draw hollow which bars (k,) are no result, as they set the scale of time, and say so in the legend."""
    for bar, is_given in zip(bars, given, strict=True):
        if is_given:
            bar.set(facecolor="white", edgecolor=colour(PLAIN), hatch="..")
    if given.any():
        bars.set_label(f"{bars.get_label()}: dotted sets the scale of time")


def volume_by_hours(
    curves: pd.DataFrame,
    hours_per_revolution: float,
    published: pd.DataFrame,
    remarks: Sequence[str],
) -> Figure:
    """Draw lost volume (mm3) against hours: measured points and rates, and our runs (Fig 6.4).

    curves: as from `volume.mean_volumes`.
    """
    figure = new_figure(remarks, LARGEST_HEIGHT)
    axes = figure.subplots()
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
    for setting, rows in settings_of(curves):
        surface, scale = setting["surface"], setting["particle_scale"]
        look = {"color": colour(surface), "linestyle": SCALE_STYLES.get(round(scale), "-")}
        told = rows["revolution"] * hours_per_revolution
        axes.plot(told, rows["volume_mm3"], label=f"{_case_name(surface, scale)}, ours", **look)
        axes.fill_between(told, rows[LOW], rows[HIGH], color=colour(surface), alpha=0.35, linewidth=0.0)
    axes.set_title(
        "open mark: extrapolated, plain was tested for 56 h; the plain sample sets our hours",
        loc="left",
        fontsize=SMALLEST_FONT,
    )
    axes.set(xlabel="Hours of the test", ylabel="Lost volume (mm³)", xlim=(0.0, None), ylim=(0.0, None))
    figure.legend(*named_once([axes]), loc="outside upper center", ncols=3)
    return figure


def channel_and_ring(
    volumes: pd.DataFrame, means: pd.DataFrame, ratios: pd.DataFrame, remarks: Sequence[str]
) -> Figure:
    """Draw volumes (mm3) and the ratio of patterned to plain in channel and ring by revolution.

    volumes: as from `volume.mean_volumes`; means: as from `comparison.mean_ratios`; ratios: over packings, by machine
    and revolution.
    """
    figure = new_figure(remarks, 4.4)
    left, right = figure.subplots(1, 2)
    for setting, rows in settings_of(volumes):
        surface, shape, scale = (setting[name] for name in ("surface", "shape", "particle_scale"))
        look = {"color": colour(surface), "linestyle": MACHINE_STYLES[shape], "marker": marker(surface)}
        _with_intervals(left, rows, "volume_mm3", f"{surface}, {shape}, scale {scale:g}", look)
    said = []
    for place, row in enumerate(means.itertuples()):
        rows = ratios[(ratios["shape"] == row.shape) & (ratios["particle_scale"] == row.particle_scale)]
        said.append(f"{row.shape}, scale {row.particle_scale:g}: {interval_text(row, 'ratio')}")
        look = {"color": OTHER_COLOUR, "linestyle": MACHINE_STYLES[row.shape], "marker": "o^sD"[place % 4]}
        shifted = rows.assign(revolution=rows["revolution"] + 0.5 + SHIFT * place)
        _with_intervals(right, shifted, "ratio", said[-1], look)
    right.axhline(1.0, color="black", linewidth=0.8)
    shared, own = int(means["revolutions"].iloc[0]), patterned_name(volumes["surface"]).capitalize()
    words = f"Over the first {shared} revolution{'s' * (shared > 1)}, 95 % interval over packings"
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
    return f"{name}: first faster than plain at {row.faster_revolution:.3g}, {100.0 * row.faster_share:.3g} % left"
