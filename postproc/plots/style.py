"""One look for all figures: size, fonts, colours, small multiples, the remarks at the bottom."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from PIL import Image

from bulkwear.postproc.mesh import PLAIN

PUBLISHED = {"color": "black", "linestyle": "--", "linewidth": 1.2}
RESOLUTION = 200  # dots per inch
PALETTE = 256  # colours
ROUND_PICTURES = 1.9  # inches of height, of titles, a bar below and remarks
WIDTH, LARGEST_HEIGHT = 8.0, 5.0  # inches: 1600 x 1000 pixels, which every report shows whole
SMALLEST_FONT = 9.0  # pt
REMARK_LINE = 0.16  # inches, height of a line of remarks
LABEL_LINE = 0.2  # inches, height of a label of the whole figure
REMARK_CHARACTERS = 108  # of a line of remarks across the figure
SMALLEST_PLAIN, LARGEST_PLAIN = 0.01, 1e4  # numbers on an axis without a power of ten
COARSER, THOUSAND = {"µm": "mm"}, 3  # unit of a thousand of another one; its power of ten
CHARACTER = 0.073  # inches, of a letter of a label, on average
AXES_ROOM = 0.9  # inches, of a figure's height for its legend, titles and the axis below
WHOLE = (0.0, 0.0, 1.0, 1.0)  # of a figure: left, bottom, width, height
FOLDED = 0.6  # -, of a label's letters in the longer of its two lines, at most
TOP_ROOM = 0.04  # inches above the topmost text
MOST_FACET_COLUMNS = 5
OTHER_COLOUR = "#595959"
MAP = "viridis"
SKIRT_COLOUR = "#c9c9c9"
# distinguishable with colour-blindness and in grey (M. Okabe and K. Ito, 2008)
BLUE, ORANGE = "#0072B2", "#D55E00"
BASE_COLOUR, PATTERN_COLOUR = "#56B4E9", BLUE
SERIES_COLOURS = (BLUE, ORANGE, "#009E73", "#CC79A7", BASE_COLOUR, "#E69F00", OTHER_COLOUR)
PATTERNED_LOOK, PLAIN_LOOK, OTHER_LOOK = (BLUE, "o"), (ORANGE, "s"), (OTHER_COLOUR, "^")  # colour and marker
LOOK = {
    "font.family": "sans-serif",
    "font.size": 10.0,
    "axes.titlesize": 10.0,
    "axes.labelsize": 10.0,
    "xtick.labelsize": SMALLEST_FONT,
    "ytick.labelsize": SMALLEST_FONT,
    "legend.fontsize": SMALLEST_FONT,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e3e3e3",
    "legend.frameon": False,
    "figure.dpi": RESOLUTION,
}


def new_figure(remarks: Sequence[str], height: float = 4.0, compressed: bool = False) -> Figure:
    """Return an empty figure of full width with the study's remarks in small type below the drawing.

    height: inches, at most `LARGEST_HEIGHT`; remarks: phrases, all are printed; compressed: axes whose scales are equal
    stand close together, in the middle
    """
    mpl.rcParams.update(LOOK)
    height = min(height, LARGEST_HEIGHT)
    figure = Figure(figsize=(WIDTH, height), layout="compressed" if compressed else "constrained")
    lines = textwrap.wrap("; ".join(remarks), REMARK_CHARACTERS)
    if lines:
        text = "\n".join(lines)
        figure.text(0.008, 0.008, text, fontsize=SMALLEST_FONT, color="#555555", va="bottom", gid="remarks")
    taken = (REMARK_LINE * len(lines) + 0.06 * bool(lines)) / height
    figure.get_layout_engine().set(rect=(0.0, taken, 1.0, 1.0 - taken - TOP_ROOM / height))
    return figure


def height_of_pictures(views: Sequence[np.ndarray], columns: int) -> float:
    """Return the height (inches) of a figure of rendered pictures (h, w, 3) in some columns, with titles and a bar."""
    rows, (height, width) = math.ceil(len(views) / columns), views[0].shape[:2]
    return rows * WIDTH / columns * height / width + ROUND_PICTURES


def facets(figure: Figure, names: Sequence[str], sharey: bool = False, most: int | None = None) -> dict[str, Axes]:
    """Return one axes per name, in a grid that is read line by line; spare places stay empty.

    most: columns at most, where titles are long
    """
    columns = min(facet_columns(len(names)), most or len(names))
    rows = math.ceil(len(names) / columns)
    grid = figure.subplots(rows, columns, sharex=True, sharey=sharey, squeeze=False).ravel()
    for spare in grid[len(names) :]:
        spare.remove()
    for axes in grid[max(len(names) - columns, 0) : len(names)]:
        axes.xaxis.set_tick_params(labelbottom=True)
    return dict(zip(names, grid, strict=False))


def facet_columns(count: int) -> int:
    """Return the number of columns of a grid of small multiples."""
    return count if count <= 3 else min(MOST_FACET_COLUMNS, math.ceil(math.sqrt(count * 1.6)))


def _look(surface: str) -> tuple[str, str]:
    """Return colour and marker of a surface; "" where the case knows no surfaces."""
    return {PLAIN: PLAIN_LOOK, "": OTHER_LOOK}.get(surface, PATTERNED_LOOK)


def colour(surface: str) -> str:
    """Return the colour of a kind of surface."""
    return _look(surface)[0]


def marker(surface: str) -> str:
    """Return the marker of a kind of surface."""
    return _look(surface)[1]


def remarks_of(figure: Figure) -> str:
    """Return the remarks printed on a figure, unwrapped."""
    return " ".join(text.get_text().replace("\n", " ") for text in figure.texts if text.get_gid() == "remarks")


def label_all(figure: Figure, several: bool, x: str, y: str) -> None:
    """Label the axes: once for the whole figure when it has several, else on its only one."""
    if several:
        engine = figure.get_layout_engine()
        left, bottom, width, height = engine.get()["rect"]  # above the remarks
        room = LABEL_LINE / figure.get_figheight()
        engine.set(rect=(left, bottom + room, width, height - room))
        figure.supxlabel(x, y=bottom + 0.1 * room, fontsize=10.0)
        figure.supylabel(y, fontsize=10.0)
    else:
        figure.axes[0].set(xlabel=x, ylabel=y)


def scaled(unit: str, largest: float) -> tuple[str, FuncFormatter]:
    """Return a unit with a power of ten where numbers would be hard to read, or the coarser one that people know, and
    what writes ticks in it.

    largest: the largest value on the axis, in the unit itself. What is drawn stays in the unit.
    """
    exponent = 3 * math.floor(math.log10(largest) / 3.0 + 1e-9) if largest > 0.0 else 0
    coarser = COARSER.get(unit) if exponent == THOUSAND else None
    if not coarser and (SMALLEST_PLAIN <= largest < LARGEST_PLAIN or largest <= 0.0):
        exponent = 0
    formatter = FuncFormatter(lambda value, _: f"{value / 10.0**exponent:.4g}")
    return coarser or (f"$10^{{{exponent}}}$ {unit}" if exponent else unit), formatter


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure as its name ends: PNG, SVG or PDF; without the date, so that equal figures are equal files.

    It is laid out the first time: all its forms have the same places, and are drawn once each.
    """
    fold_labels(figure)
    kind = Path(path).suffix[1:]
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(kind)
    with mpl.rc_context({"svg.hashsalt": "bulkwear"}):
        figure.savefig(path, dpi=RESOLUTION, metadata=undated)
    figure.set_layout_engine(None)


def fold_labels(figure: Figure) -> None:
    """Write labels of vertical axes in two lines where they would be longer than their axes are high, by far.

    A formula between two $ is not broken.
    """
    engine = figure.get_layout_engine()
    share = engine.get().get("rect", WHOLE)[3] if engine else 1.0
    for axes in figure.axes:
        text, place = axes.get_ylabel(), axes.get_subplotspec()
        if place is None or "\n" in text or " " not in text:
            continue
        ratios = list(place.get_gridspec().get_height_ratios())
        rows = sum(ratios[place.rowspan.start : place.rowspan.stop]) / sum(ratios)
        room = (share * figure.get_figheight() - AXES_ROOM) * rows
        lines = textwrap.wrap(text, math.ceil(FOLDED * len(text)))
        if len(text) * CHARACTER > room and len(lines) == 2 and lines[0].count("$") % 2 == 0:
            axes.set_ylabel("\n".join(lines))


def save_small(figure: str | Path, path: str | Path) -> None:
    """Write a figure's PNG with a palette, a third as large: for pages under version control."""
    Image.open(figure).convert("RGB").quantize(PALETTE, dither=Image.Dither.NONE).save(path, optimize=True)


def picture(axes: Axes, pixels: np.ndarray, extent: tuple[float, float, float, float] | None = None) -> None:
    """Show a rendered picture (h, w, 3) on axes without frame; with an extent (axes units), with its axes."""
    axes.imshow(pixels, extent=extent, interpolation="antialiased", aspect="equal")
    axes.grid(False)
    if extent is None:
        axes.set_axis_off()


def named_once(panels: Iterable[Axes]) -> tuple[list[Artist], list[str]]:
    """Handles and labels for one legend of several panels: each label once."""
    named = {text: handle for axes in panels for handle, text in zip(*axes.get_legend_handles_labels(), strict=True)}
    return list(named.values()), list(named)


def draw_circles(
    axes: Axes, places: np.ndarray, radii: np.ndarray, values: np.ndarray, norm: Normalize, colours: str
) -> None:
    """Draw a circle round each place.

    places (n, 2) and radii (n,): in the units of the axes; values (n,): coloured by `norm` in the map `colours`
    """
    size = 2.0 * radii
    circles = EllipseCollection(
        size,
        size,
        np.zeros(len(size)),
        units="xy",
        offsets=places,
        offset_transform=axes.transData,
        array=values,
        cmap=colours,
        norm=norm,
        linewidths=0.0,
        rasterized=True,  # thousands of them
    )
    axes.add_collection(circles)
