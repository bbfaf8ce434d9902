"""Figures of the circular wear tester that compare channel and ring, and follow a pattern until it is gone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from postproc.plots.style import COLOURS, MARKERS, OTHER_COLOUR, SMALLEST_FONT, named_once, new_figure
from postproc.tables.display import CUBIC_MILLIMETRES
from postproc.tables.summary import PLAIN
from workflows.cases.circular_tester.comparison import WORN_OUT_SHARE

STYLES = {"channel": "-", "ring": "--"}
SHIFT = 0.05  # revolutions that two machines stand apart


def channel_and_ring(
    volumes: pd.DataFrame, means: pd.DataFrame, ratios: pd.DataFrame, remarks: Sequence[str]
) -> Figure:
    """Draw volumes (mm3) and the ratio of convex to plain in channel and ring by revolution.

    volumes: as from `analysis.tester_runs.volumes`; ratios, means: as from `analysis.tester_comparison`.
    """
    figure = new_figure(remarks, 4.4)
    left, right = figure.subplots(1, 2)
    for (_, surface, shape, scale), rows in volumes.groupby(["run", "surface", "shape", "particle_scale"], sort=False):
        look = {"color": COLOURS[surface], "linestyle": STYLES[shape], "marker": MARKERS[surface], "markersize": 3}
        name = f"{surface}, {shape}, scale {scale:g}"
        left.plot(rows["revolution"], CUBIC_MILLIMETRES * rows["volume_m3"], linewidth=1.0, label=name, **look)
    said = []
    for place, ((shape, scale), rows) in enumerate(ratios.groupby(["shape", "particle_scale"], sort=False)):
        mean = means[(means["shape"] == shape) & (means["particle_scale"] == scale)].iloc[0]
        said.append(f"{shape}, scale {scale:g}: {mean['ratio']:.3f} ± {mean['standard_error']:.2g}")
        look = {"color": OTHER_COLOUR, "linestyle": STYLES[shape], "marker": "o^sD"[place % 4], "markersize": 4}
        right.plot(rows["revolution"] + 0.5 + SHIFT * place, rows["ratio"], linewidth=1.0, label=said[-1], **look)
    right.axhline(1.0, color="black", linewidth=0.8)
    shared = int(means["revolutions"].iloc[0])
    words = f"Mean ± standard error of the first {shared} revolution{'s' * (shared > 1)}"
    right.set_title("\n".join([words, *said]), loc="left", fontsize=SMALLEST_FONT)
    left.set(xlabel="Revolutions", ylabel="Lost volume (mm³)", xlim=(0.0, None), ylim=(0.0, None))
    right.set(xlabel="Revolution", ylabel="Convex over plain, lost in a revolution (-)", ylim=(0.0, None))
    figure.legend(*named_once([left]), loc="outside upper center", ncols=3)
    return figure


def worn_out(left_of: pd.DataFrame, ends: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw what is left of the pattern, and what the sample loses per revolution, until the pattern is gone.

    left_of, ends: as from `analysis.tester_comparison.pattern_left` and `worn_out_at`.
    """
    figure = new_figure(remarks, 4.4)
    share, rate = figure.subplots(1, 2, sharex=True)
    styles = dict(zip(ends["run"], ("-", "--", ":", "-.") * len(ends), strict=False))
    for run, rows in left_of.groupby("run", sort=False):
        end = ends[ends["run"] == run].iloc[0]
        times = rows["coefficient"].iloc[0] / left_of["coefficient"].min()
        name = f"{run.replace('_', ' ')}{f', coefficient x {times:g}' if times > 1.0 else ''}"
        look = {"color": COLOURS["convex"], "linestyle": styles[run], "linewidth": 1.2}
        share.plot(rows["revolution"], 100.0 * rows["pattern_share"], label=name, **look)
        rate.plot(rows["revolution"], rows["mean_per_revolution_mm3"], label=name, **look)
        if np.isfinite(end["worn_out_revolution"]):
            share.axvline(end["worn_out_revolution"], color=OTHER_COLOUR, linewidth=0.8, linestyle=styles[run])
    share.axhline(100.0 * WORN_OUT_SHARE, color="black", linewidth=0.8, label=f"{100.0 * WORN_OUT_SHARE:g} %")
    rate.axhline(left_of["plain_per_revolution_mm3"].iloc[0], color=COLOURS[PLAIN], linewidth=1.2, label="plain sample")
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
