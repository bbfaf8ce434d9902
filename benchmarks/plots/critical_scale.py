"""What a change does to the convex sample's wear over the plain one's: a line of dots per change."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from postproc.plots.style import BLUE, ORANGE, OTHER_COLOUR, new_figure

KINDS = {  # what the source says of a thing -> words, colour, marker
    "": ("the study", "black", "D"),
    "open": ("left open by the source", BLUE, "o"),
    "ours": ("a choice of the simulation", OTHER_COLOUR, "^"),
    "published": ("published, changed to see what it does", ORANGE, "s"),
}
SOURCE_COLOUR = "#009E73"
LINE_HEIGHT = 0.19  # inches


def ratio_by_candidate(table: pd.DataFrame, source: Mapping[int, float], remarks: Sequence[str]) -> Figure:
    """Draw wear over plain of every candidate with its interval, where there is one; a panel per particle scale.

    table: candidate, kind (of KINDS), particle_scale, wear_over_plain, ratio_low, ratio_high (NaN: not known); the
        first line of a scale is the reference
    source: the source's ratio by particle scale
    """
    names = list(dict.fromkeys(table["candidate"]))
    figure = new_figure(remarks, 1.6 + LINE_HEIGHT * len(names))
    scales = list(dict.fromkeys(table["particle_scale"]))
    panels = figure.subplots(1, len(scales), sharey=True, squeeze=False)[0]
    for axes, scale in zip(panels, scales, strict=True):
        rows = table[table["particle_scale"] == scale]
        axes.axvline(1.0, color="#a0a0a0", linewidth=0.8)
        axes.axvline(rows["wear_over_plain"].iloc[0], color="black", linewidth=0.8, linestyle=":", label="the study's")
        axes.axvline(source[scale], color=SOURCE_COLOUR, linewidth=1.4, linestyle="--", label="Yan 2022, Eq 4.14, 4.15")
        for kind, (words, shade, marker) in KINDS.items():
            some = rows[rows["kind"] == kind]
            if some.empty:
                continue
            places = [names.index(name) for name in some["candidate"]]
            value, low, high = (some[name].to_numpy() for name in ("wear_over_plain", "ratio_low", "ratio_high"))
            axes.hlines(places, low, high, color=shade, linewidth=0.8)
            axes.plot(value, places, marker, color=shade, markersize=5.0, label=words)
        largest = np.nanmax([source[scale], *rows["wear_over_plain"], *rows["ratio_high"]])
        axes.set(xlim=(0.0, 1.08 * largest), xlabel="Wear, convex over plain (-)")
        axes.set_title(f"particle scale {scale:g}", loc="left")
        axes.grid(axis="y", visible=False)
    panels[0].set_yticks(range(len(names)), names)
    panels[0].set_ylim(len(names) - 0.5, -0.5)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure
