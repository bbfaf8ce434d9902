"""What the figures of the pin-on-disc study share: colours and names of schemes, published values, tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from matplotlib.artist import Artist
from matplotlib.axes import Axes

from postproc.plots.style import SMALLEST_FONT

SCHEME_COLOURS = {"conserving": "#0072B2", "per_triangle": "#D55E00"}
SCHEME_NAMES = {"conserving": "conserving", "per_triangle": "per triangle (Yan 2022, Eq 5.7)"}
SCHEME_MARKERS = {"conserving": "o", "per_triangle": "s"}
PUBLISHED = {"color": "black", "linestyle": "--", "linewidth": 1.2}
LAW_COLOUR = "#009E73"
LABORATORY_COLOUR = "#CC79A7"
TABLE_LINE = 0.5  # pt


def coefficient_name(coefficient: float) -> str:
    """A wear coefficient (1/Pa) as people read it."""
    exponent = f"{coefficient:.1e}".partition("e")[2]
    digits = coefficient / 10.0 ** int(exponent)
    return rf"$\alpha$ = {digits:.3g}·10$^{{{int(exponent)}}}$ Pa$^{{-1}}$"


def named_once(panels: Iterable[Axes]) -> tuple[list[Artist], list[str]]:
    """Handles and labels for one legend of several panels: each label once."""
    named = {text: handle for axes in panels for handle, text in zip(*axes.get_legend_handles_labels(), strict=True)}
    return list(named.values()), list(named)


def printed_table(axes: Axes, head: Sequence[str], cells: Sequence[Sequence[str]]) -> None:
    """Print a table that fills axes of its own; lines of type in the head by its line breaks."""
    axes.set_axis_off()
    drawn = axes.table(cells, colLabels=head, bbox=(0.0, 0.0, 1.0, 1.0), cellLoc="center", edges="horizontal")
    drawn.auto_set_font_size(False)
    drawn.set_fontsize(SMALLEST_FONT)
    drawn.auto_set_column_width(range(len(head)))
    lines = 1.0 + max(text.count("\n") for text in head)
    for (row, _), cell in drawn.get_celld().items():
        cell.set_linewidth(TABLE_LINE)
        cell.set_height(cell.get_height() * (lines if row == 0 else 1.0))
