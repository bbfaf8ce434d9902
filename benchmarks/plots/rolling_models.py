"""The figures of `benchmarks.rolling_models`, `benchmarks.calibration_models` and `benchmarks.tilted_bed`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pandas as pd
from matplotlib.figure import Figure

from benchmarks.rolling_case import MODELS
from benchmarks.rolling_page import differences
from bulkwear.postproc.plots.style import BLUE, ORANGE, OTHER_COLOUR, facets, label_all, new_figure
from bulkwear.postproc.statistics.intervals import Estimate, estimate
from bulkwear.workflows.cases.calibration.outcome import Calibrated
from bulkwear.workflows.cases.calibration.plots.responses import draw_family, family_handles
from bulkwear.workflows.cases.calibration.responses import parameter_name, response_name

LOOKS = dict(zip(MODELS, ((BLUE, "o"), (ORANGE, "s"), ("#009E73", "^"), (OTHER_COLOUR, "D")), strict=True))
HEIGHT = 6.2  # inches
ROOM = 0.08  # -, of the range of a panel
APART = 0.015  # of that range, models beside one another
LOW = 2.8  # inches, of a figure of one panel
BESIDE = 0.12  # of the distance of two models, packings beside their mean


def against_source(runs: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw a panel per response: ours over the source's, a mark per pair and model (mean of packings, with its 95 %
    interval where there are several; a wide one leaves the panel); on the line both are alike.

    runs, published: as in `rolling_page.differences`
    """
    found = differences(runs, published)
    keys = ["response", "model", "pair", "published"]
    means = found.groupby(keys, sort=False)["ours"].apply(lambda ours: estimate(ours.to_numpy())).reset_index()
    means["mean"] = [each.value for each in means["ours"]]
    figure = new_figure(remarks, HEIGHT)
    responses = list(dict.fromkeys(means["response"]))
    panels = figure.subplots(-(-len(responses) // 2), 2, squeeze=False).ravel()
    for axes, response in zip(panels, responses, strict=False):
        of = means[means["response"] == response]
        low, high = (getattr(of[["published", "mean"]].to_numpy(), end)() for end in ("min", "max"))
        room = ROOM * (high - low or high)
        axes.plot([low - room, high + room], [low - room, high + room], color="#a0a0a0", linewidth=0.8)
        for number, (model, (colour, marker)) in enumerate(LOOKS.items()):
            some = of[of["model"] == model]
            places = some["published"] + APART * (number - 0.5 * (len(LOOKS) - 1)) * (high - low or high)
            axes.plot(places, some["mean"], marker, color=colour, markersize=5.0, alpha=0.8, label=model)
            for at, mean in zip(places, some["ours"], strict=True):
                axes.vlines(at, *mean.interval(), color=colour, linewidth=0.8)  # nothing where it is unknown
        name = response_name(response)  # ends with its unit in brackets
        axes.set(xlabel=f"{name}, Yan 2022", ylabel=f"Ours, mean ({name.rpartition('(')[2]}")
        axes.set(ylim=(low - 2.0 * room, high + 2.0 * room))
    for axes in panels[len(responses) :]:
        axes.set_axis_off()
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=len(MODELS))
    return figure


def packings_by_model(
    runs: pd.DataFrame, column: str, label: str, means: Mapping[str, Estimate], remarks: Sequence[str]
) -> Figure:
    """Draw a column of runs by model: packings, and beside them their mean with its 95 % interval, where it is known.

    runs: model and that column, a row per packing; label: of the axis, with its unit
    """
    figure = new_figure(remarks, LOW)
    axes = figure.subplots()
    for place, (model, mean) in enumerate(means.items()):
        colour, marker = LOOKS[model]
        values = runs.loc[runs["model"] == model, column]
        axes.plot([place - BESIDE] * len(values), values, marker, color=colour, markersize=3.0, alpha=0.6)
        reach = [[mean.value - mean.interval()[0]], [mean.interval()[1] - mean.value]] if mean.known else None
        axes.errorbar(place + BESIDE, mean.value, reach, marker=marker, color=colour, markersize=6.0, capsize=4.0)
    axes.set_xticks(range(len(means)), list(means))
    axes.set(xlabel="Rolling model", ylabel=label, xlim=(-0.5, len(means) - 0.5))
    axes.grid(axis="x", visible=False)
    return figure


def families(done: Mapping[str, Calibrated], remarks: Sequence[str]) -> Figure:
    """Draw a panel per model: the pairs of frictions that hold 50 and 95 % of what fits, the simulations, the
    recommended pair and the one that it is compared with.

    done: finished calibrations of two parameters, by model
    """
    figure = new_figure(remarks, HEIGHT)
    panels = facets(figure, list(done), sharey=True, most=2)
    for model, each in done.items():
        draw_family(panels[model], each.family, each.everything, each.pairs)
        panels[model].set_title(model, loc="left")
    names = [parameter_name(name) for name in each.problem.names]
    label_all(figure, len(done) > 1, *names)
    handles = family_handles({pair: "the source's pair" if pair == each.compared else pair for pair in each.pairs})
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))
    return figure
