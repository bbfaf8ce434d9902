"""Figures of a screening regression: coefficients, residuals, half-normal plot and contours of the response."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import NullLocator

from bulkwear.postproc.plots.style import LARGEST_HEIGHT, MAP, OTHER_COLOUR, SMALLEST_FONT, facet_columns, new_figure
from bulkwear.postproc.statistics.regression import CONSTANT

BRIGHT = "#ffb000"  # of lines on the colour map
OURS, PUBLISHED = "#0072B2", "#D55E00"
NAMED_RESIDUALS = 3  # runs with the largest residuals, which are named
NOTED = 1.5  # -, pseudo errors from which on a contrast is named
SMALLEST_PROBABILITY = 0.001  # that three digits show
ROOM = 0.12  # -, of an axis, for names beside points
CONTOURS = 9
PUBLISHED_LEVELS = (0.02, 0.05, 0.1, 0.2, 0.5)  # of dashed lines
LINE = 0.42  # inches, of a term of the coefficient figure
SHIFT = 0.2  # of a line of the coefficient figure, between ours and published


def coefficients(table: pd.DataFrame, published: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw coefficients in coded units with their standard errors, published ones beside them, p values at the edge.

    table: as from `study_regression.chosen_coefficients`; published: term, coefficient, p_value, source.
    """
    terms = list(dict.fromkeys([*table["term"], *published["term"]]))
    figure = new_figure(remarks, min(LARGEST_HEIGHT, 1.9 + LINE * len(terms)))
    axes = figure.subplots()
    line = {term: -k for k, term in enumerate(terms)}
    ours = np.array([line[term] for term in table["term"]]) + SHIFT
    theirs = np.array([line[term] for term in published["term"]]) - SHIFT
    label = "this study, with one standard error"
    axes.errorbar(table["coefficient"], ours, xerr=table["standard_error"], fmt="o", color=OURS, capsize=3, label=label)
    source = published["source"].iloc[0].partition(" (")[0] if len(published) else ""
    hollow = {"color": PUBLISHED, "markerfacecolor": "white", "label": source}
    axes.plot(published["coefficient"], theirs, "D", **hollow)
    axes.axvline(0.0, color="black", linewidth=0.8)
    axes.set_yticks(list(line.values()), [_typeset(term) for term in line])
    axes.set_ylim(min(line.values()) - 0.6, 0.9)
    axes.set_xlabel("Coefficient of ln(wear / largest wear), factors in coded units (-)")
    axes.set_ylabel("Term")
    right = axes.get_yaxis_transform()
    for term, place, after, chance in zip(
        table["term"], ours, table["p_value_after_selection"], table["p_value_permutation"], strict=True
    ):
        text = f"p {_probability(after)}" + ("" if term == CONSTANT else f", by permutation {_probability(chance)}")
        axes.text(1.01, place, text, transform=right, va="center", fontsize=SMALLEST_FONT, color=OURS)
    for place, value in zip(theirs, published["p_value"], strict=True):
        axes.text(
            1.01,
            place,
            f"p {_probability(value)}",
            transform=right,
            va="center",
            fontsize=SMALLEST_FONT,
            color=PUBLISHED,
        )
    note = "p after selection: as if the terms had been given, so too small; by permutation: the whole choice repeated"
    axes.set_title(note, loc="left", fontsize=SMALLEST_FONT, pad=3)
    figure.legend(loc="outside upper center", ncols=2)
    return figure


def residual_plots(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw residuals of ln(normalised wear) as a normal probability plot and against the fitted value.

    table: as from `study_regression.residuals`. The line is that of normal residuals of the same deviation.
    """
    figure = new_figure(remarks)
    normal, fitted = figure.subplots(1, 2)
    normal.plot(table["residual"], table["normal_score"], "o", color=OURS)
    ends = np.array([table["normal_score"].min(), table["normal_score"].max()])
    normal.plot(ends * table["residual"].std(), ends, color=OTHER_COLOUR, linewidth=1.0)
    normal.set(xlabel="Residual of ln(normalised wear) (-)", ylabel="Normal score (-)")
    normal.set_title("normal probability plot; line: normal", loc="left", fontsize=SMALLEST_FONT)
    fitted.plot(table["fitted"], table["residual"], "o", color=OURS)
    fitted.axhline(0.0, color=OTHER_COLOUR, linewidth=1.0)
    fitted.set(xlabel="Fitted ln(normalised wear) (-)", ylabel="Residual of ln(normalised wear) (-)")
    fitted.set_title("residual against fitted value", loc="left", fontsize=SMALLEST_FONT)
    largest = table.loc[table["residual"].abs().nlargest(NAMED_RESIDUALS).index]
    _name_points(normal, largest["residual"], largest["normal_score"], largest["row"])
    _name_points(fitted, largest["fitted"], largest["residual"], largest["row"])
    return figure


def half_normal(table: pd.DataFrame, remarks: Sequence[str]) -> Figure:
    """Draw sizes of contrasts against half-normal scores; the line is where contrasts of pure error would lie.

    table: as from `effects.half_normal_table`.
    """
    figure = new_figure(remarks)
    axes = figure.subplots()
    size, score = table["contrast"].abs(), table["half_normal_score"]
    error = float(table["pseudo_error"].iloc[0])
    axes.plot(score, size, "o", color=OURS)
    ends = np.array([0.0, 1.05 * score.max()])
    axes.plot(ends, error * ends, color=OTHER_COLOUR, linewidth=1.0)
    named = (size > NOTED * error) | (np.arange(len(table)) >= len(table) - 4)
    _name_points(axes, score[named], size[named], table["term"][named])
    axes.set(xlabel="Half-normal score (-)", ylabel="Size of contrast of ln(normalised wear) (-)")
    axes.set_xlim(0.0, 1.12 * score.max())
    axes.set_ylim(bottom=0.0)
    title = f"line: contrasts of error alone, pseudo standard error {error:.3g} (Lenth 1989)"
    axes.set_title(title, loc="left", fontsize=SMALLEST_FONT)
    return figure


def response_contours(
    surface: pd.DataFrame, labels: Mapping[str, str], log_factors: Sequence[str], remarks: Sequence[str]
) -> Figure:
    """Draw contours of the predicted normalised wear over pairs of factors, others at their middle level; those of the
    published regression, if known, as dashed lines at the same levels.

    surface: as from `regression_tables.contour_table`; labels: {short name: name and unit for the axis}
    log_factors: short names of factors whose levels double; their axes are logarithmic
    """
    pairs = list(surface.groupby(["x_factor", "y_factor"], sort=False))
    figure = new_figure(remarks, LARGEST_HEIGHT)
    columns = facet_columns(len(pairs)) if len(pairs) != 4 else 2
    rows = -(-len(pairs) // columns)
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    low, high = surface["normalised_wear"].min(), surface["normalised_wear"].max()
    levels = np.geomspace(low, high, CONTOURS) if high > low else np.array([low, low + 1.0])
    for axes, ((first, second), table) in zip(grid, pairs, strict=False):
        shape = (table["y"].nunique(), table["x"].nunique())
        x, y, wear = (table[name].to_numpy().reshape(shape) for name in ("x", "y", "normalised_wear"))
        drawn = axes.contourf(x, y, np.clip(wear, levels[0], levels[-1]), levels, cmap=MAP)
        lines = axes.contour(x, y, wear, levels[1:-1], colors="white", linewidths=0.7)
        theirs = table["published_wear"].to_numpy().reshape(shape)
        if np.isfinite(theirs).all():  # whose labels need the room; the bar tells the others
            dashed = axes.contour(x, y, theirs, PUBLISHED_LEVELS, colors=BRIGHT, linewidths=1.4, linestyles="--")
            for label in axes.clabel(dashed, fmt="%.2g", fontsize=SMALLEST_FONT, colors=BRIGHT):
                label.set_path_effects([withStroke(linewidth=2.0, foreground="black")])
        else:
            axes.clabel(lines, fmt="%.2g", fontsize=SMALLEST_FONT, colors="white")
        _factor_axis(axes, "x", labels[first], x[0], first in log_factors)
        _factor_axis(axes, "y", labels[second], y[:, 0], second in log_factors)
        axes.grid(False)
    for spare in grid[len(pairs) :]:
        spare.remove()
    bar = figure.colorbar(drawn, ax=list(grid[: len(pairs)]), format="%.2g")
    bar.set_label("Predicted wear / largest wear (-)")
    if surface["published_wear"].notna().all():
        handles = [Line2D([], [], color=BRIGHT, linestyle="--", label="by the published regression (Yan 2022)")]
        figure.legend(handles=handles, loc="outside upper center")
    return figure


def _factor_axis(axes: Axes, which: str, label: str, levels: np.ndarray, doubling: bool) -> None:
    """Label an axis with a factor and its three levels as ticks."""
    middle = np.sqrt(levels[0] * levels[-1]) if doubling else 0.5 * (levels[0] + levels[-1])
    axis = axes.xaxis if which == "x" else axes.yaxis
    getattr(axes, f"set_{which}scale")("log" if doubling else "linear")
    ticks = [levels[0], middle, levels[-1]]
    axis.set_ticks(ticks, [f"{tick:.4g}" for tick in ticks])
    axis.set_minor_locator(NullLocator())
    axis.set_label_text(label)


def _typeset(term: str) -> str:
    return str(term).replace("*", "·").replace("^2", "²")


def _probability(value: float) -> str:
    return f"{value:.3f}" if value >= SMALLEST_PROBABILITY else f"< {SMALLEST_PROBABILITY:g}"


def _name_points(axes: Axes, x: pd.Series, y: pd.Series, names: pd.Series) -> None:
    axes.margins(ROOM)
    for place, height, name in zip(x, y, names, strict=True):
        axes.annotate(_typeset(name), (place, height), (6, -3), textcoords="offset points", fontsize=SMALLEST_FONT)
