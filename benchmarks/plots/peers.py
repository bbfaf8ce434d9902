"""The figure of `benchmarks.peers`."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from bulkwear.postproc.plots.style import BLUE, PUBLISHED, new_figure

HEIGHT = 3.4  # inches
LABELLED = "125"  # first digits of ticks that get a number


def rates_by_code(rates: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw how many particle-steps each code makes in a second of processor time, over ours: median and range.

    rates: a row per code with `code`, `ratio`, `ratio_low`, `ratio_high` (-), NaN where none is told
    """
    told = rates.dropna(subset=["ratio"])[::-1]
    figure = new_figure(remarks, HEIGHT)
    axes = figure.subplots()
    reach = [told["ratio"] - told["ratio_low"], told["ratio_high"] - told["ratio"]]
    axes.errorbar(told["ratio"], told["code"], xerr=reach, fmt="o", color=BLUE, capsize=3.0)
    axes.axvline(1.0, **PUBLISHED)
    axes.set_xscale("log")
    for set_formatter in (axes.xaxis.set_major_formatter, axes.xaxis.set_minor_formatter):
        set_formatter(FuncFormatter(lambda value, _: f"{value:g}" if f"{value:e}"[0] in LABELLED else ""))
    axes.set(xlabel="Particle-steps per second of processor time over ours (-)")
    return figure
