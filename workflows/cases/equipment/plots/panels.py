"""Pictures in a grid, a line per setting and a column per view or the other way round, with scales and marks."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bulkwear.postproc.plots.style import SMALLEST_FONT
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.workflows.cases.equipment.plots.views import View

POINTS = 72.0  # pt per inch
LINE = 0.16  # inches, height of a line of type
BELOW = 0.28  # inches, below a picture for its scale
APART = 0.12  # inches, between two pictures
WIDEST_GAP = 0.5  # inches, between two pictures
LETTER = 0.072  # inches, width of a letter of a title
SIDE_ROOM = 0.36  # inches, for the names of lines: two lines of type
UNITS = re.compile(r"(\d) (h|mm|t/h|rpm)\b")  # a number stays with its unit
FEWEST_LETTERS = 13  # of a line of type: narrower columns do not get
NUMBER_AWAY = 13.0  # pt, from a marked place to its number
MUCH_LARGER = 1.6  # -, area of pictures with whole names over that in lines and columns, for which these are given up
BAR_SHARE = 0.3  # -, of the width of a picture that its scale bar may have
BAR_COLOUR = "#333333"


@dataclass(frozen=True, eq=False)
class Picture:
    """A rendered picture, true to scale.

    pixels: (h, w, 3); view: from where; marks: {text: place (3,) m} seen on it; note: a line below its title
    """

    pixels: np.ndarray
    view: View
    marks: Mapping[str, np.ndarray] = field(default_factory=dict)
    note: str = ""

    @property
    def aspect(self) -> float:
        """Return width over height."""
        return self.view.width / self.view.height


@dataclass(frozen=True)
class Box:
    """A part of a figure, inches from its left and lower edge."""

    left: float
    bottom: float
    width: float
    height: float


@dataclass(frozen=True, eq=False)
class _Plan:
    """Where pictures stand: a matrix of keys, None where there is none, widths and heights of its cells in inches.

    side: which word of the keys stands beside the lines, the other one over the columns; None: both over each picture
    beside: inches that the words beside lines take; turned: whether they are read from below
    """

    cells: Sequence[Sequence[tuple[str, str] | None]]
    widths: Sequence[float]
    heights: Sequence[float]
    side: int | None = None
    beside: float = 0.0
    turned: bool = True

    def heads(self, pictures: Mapping[tuple[str, str], Picture]) -> list[list[str]]:
        """Return what stands over each picture; a word of all pictures is left out where both stand there."""
        told = [len({key[k] for key in pictures}) > 1 for k in (0, 1)]
        found = []
        for line, keys in enumerate(self.cells):
            words = []
            for key in keys:
                if key is None:
                    words.append("")
                    continue
                own = [word for word, several in zip(key, told, strict=True) if several] or [key[1]]
                own = own if self.side is None else [key[1 - self.side]] if line == 0 else []
                words.append("\n".join(filter(None, [*own, pictures[key].note])))
            found.append(words)
        return found

    def area(self, pictures: Mapping[tuple[str, str], Picture]) -> float:
        """Return the area of all pictures, square inches."""
        sizes = [self.height_of(line, column, pictures) for line, column in self.places()]
        keys = [self.cells[line][column] for line, column in self.places()]
        return sum(size**2 * pictures[key].aspect for key, size in zip(keys, sizes, strict=True))

    def places(self) -> list[tuple[int, int]]:
        """Return the lines and columns with a picture."""
        return [(i, j) for i, line in enumerate(self.cells) for j, key in enumerate(line) if key is not None]

    def height_of(self, line: int, column: int, pictures: Mapping[tuple[str, str], Picture]) -> float:
        """Return the height of a picture in its cell, inches."""
        return max(min(self.heights[line], self.widths[column] / pictures[self.cells[line][column]].aspect), 0.0)


def picture_grid(figure: Figure, pictures: Mapping[tuple[str, str], Picture], box: Box) -> None:
    """Draw pictures by (setting, view) into a box of a figure.

    Settings are lines or columns, whichever gives larger pictures, or pictures follow one another with their whole
    names where they are much larger then.
    """
    plan = _best_plan(pictures, (box.width, box.height))
    slack = box.width - plan.beside - sum(plan.widths) - APART * (len(plan.widths) - 1)
    gap = APART + min(max(slack, 0.0) / len(plan.widths), WIDEST_GAP - APART)
    block = sum(plan.widths) + gap * (len(plan.widths) - 1)
    start = box.left + plan.beside + 0.5 * max(box.width - plan.beside - block, 0.0)
    tops = _tops(plan, pictures, box)
    for line, column in plan.places():
        key = plan.cells[line][column]
        shown, high = pictures[key], plan.height_of(line, column, pictures)
        left = start + sum(plan.widths[:column]) + gap * column + 0.5 * (plan.widths[column] - high * shown.aspect)
        axes = figure.add_axes(part_of(figure, Box(left, tops[line] - high, high * shown.aspect, high)))
        draw_picture(axes, shown, high)
        words = plan.heads(pictures)[line][column]
        axes.set_title(_broken(words, plan.widths[column]), fontsize=SMALLEST_FONT, pad=3)
        if plan.side is not None and column == 0:
            words = _broken(key[plan.side], plan.heights[line] if plan.turned else plan.beside)
            style = {"va": "center", "ha": "right", "ma": "center", "fontsize": SMALLEST_FONT}
            place = (start - APART, tops[line] - 0.5 * plan.heights[line]) / figure.get_size_inches()
            figure.text(*place, words, rotation=90 if plan.turned else 0, **style)


def _tops(plan: _Plan, pictures: Mapping[tuple[str, str], Picture], box: Box) -> list[float]:
    """Return how high (inches) the upper edges of the lines of pictures are; what is left over lies between lines."""
    above = [LINE * max(map(_lines, heads)) for heads in plan.heads(pictures)]
    slack = box.height - sum(above) - sum(plan.heights) - BELOW * len(above) - APART * (len(above) - 1)
    gap, top, found = APART + max(slack, 0.0) / (len(above) + 1), box.bottom + box.height, []
    top -= max(slack, 0.0) / (len(above) + 1)
    for head, height in zip(above, plan.heights, strict=True):
        found.append(top - head)
        top -= head + height + BELOW + gap
    return found


def part_of(figure: Figure, box: Box) -> tuple[float, float, float, float]:
    """Return a box as parts of a figure, as its axes have it."""
    width, height = figure.get_size_inches()
    return box.left / width, box.bottom / height, box.width / width, box.height / height


def _best_plan(pictures: Mapping[tuple[str, str], Picture], room: tuple[float, float]) -> _Plan:
    """Return how pictures are placed so that they are largest."""
    settings, views = (list(dict.fromkeys(key[k] for key in pictures)) for k in (0, 1))
    ordered = [(setting, view) for view in views for setting in settings if (setting, view) in pictures]
    wrapped = []
    for columns in range(1, len(ordered) + 1):
        lines = [ordered[k : k + columns] for k in range(0, len(ordered), columns)]
        lines[-1] += [None] * (columns - len(lines[-1]))
        wrapped.append(_plan_of(_Plan(lines, [], []), pictures, room))
    best = max(wrapped, key=lambda plan: plan.area(pictures))
    if min(len(settings), len(views)) == 1:
        return best
    matrix = [[(setting, view) if (setting, view) in pictures else None for view in views] for setting in settings]
    turned = [list(line) for line in zip(*matrix, strict=True)]
    plans = []
    for side, cells in enumerate((matrix, turned)):
        letters = LETTER * max(_letters(key[side]) for key in pictures) + APART
        for beside, is_turned in ((SIDE_ROOM, True), (letters, False)):
            plans.append(_plan_of(_Plan(cells, [], [], side, beside, is_turned), pictures, room))
    named = max(plans, key=lambda plan: plan.area(pictures))
    return best if best.area(pictures) > MUCH_LARGER * named.area(pictures) else named


def _plan_of(plan: _Plan, pictures: Mapping[tuple[str, str], Picture], room: tuple[float, float]) -> _Plan:
    """Return a plan with the largest cells in which lines of pictures fit into a room (inches), and their names."""
    cells, heads = plan.cells, plan.heads(pictures)
    spare = room[1] - sum(BELOW + LINE * max(map(_lines, line)) for line in heads) - APART * (len(cells) - 1)
    columns = list(zip(*cells, strict=True))
    needs = [LETTER * max(map(_letters, column)) for column in zip(*heads, strict=True)]
    wide = [max(pictures[key].aspect for key in column if key) for column in columns]
    flat = [max(1.0 / pictures[key].aspect for key in line if key) for line in cells]
    lowest = _lowest(plan, pictures)
    across = room[0] - plan.beside - APART * (len(columns) - 1)
    best = replace(plan, widths=[max(across / len(columns), 0.1)] * len(columns), heights=[0.1] * len(cells))
    for high in np.linspace(0.0, max(spare, 0.0), 60)[1:]:
        # lines of equal height, or pictures of equal width, whichever: both fit into the same columns
        for heights in ([high / len(cells)] * len(cells), [high * each / sum(flat) for each in flat]):
            widths = [max(need, max(heights) * each) for need, each in zip(needs, wide, strict=True)]
            if len(set(flat)) > 1:
                widths = [
                    max(need, *(heights[i] * pictures[key].aspect for i, key in enumerate(column) if key))
                    for need, column in zip(needs, columns, strict=True)
                ]
            found = replace(plan, widths=widths, heights=heights)
            if sum(widths) <= across and min(heights) >= lowest and found.area(pictures) > best.area(pictures):
                best = found
    return best


def _lowest(plan: _Plan, pictures: Mapping[tuple[str, str], Picture]) -> float:
    """Return how high (inches) lines of pictures must be for the words beside them."""
    if plan.side is None:
        return 0.0
    words = [key[plan.side] for key in pictures]
    return LETTER * max(map(_letters, words)) if plan.turned else LINE * max(map(_lines, words))


def _lines(text: str) -> int:
    """Return in how many lines a text stands where letters are fewest."""
    return sum(max(math.ceil(len(line) / FEWEST_LETTERS), 1) for line in text.split("\n")) if text else 0


def _letters(text: str) -> int:
    """Return how many letters a text needs at least in a line: no word is broken."""
    longest = max((len(word) for word in text.split()), default=0)
    return max(min(max(map(len, text.split("\n"))), FEWEST_LETTERS), longest)


def _broken(text: str, width: float) -> str:
    """Return a text in lines that fit into a width (inches)."""
    letters = max(int(width / LETTER), FEWEST_LETTERS)
    text = UNITS.sub("\\1\N{NO-BREAK SPACE}\\2", text)
    return "\n".join(textwrap.fill(line, letters, break_long_words=False) for line in text.split("\n"))


def draw_picture(axes: Axes, shown: Picture, height: float) -> None:
    """Draw a picture, about `height` inches high, with its marks and a bar of round length."""
    left, right, low, high = shown.view.extent_mm
    axes.imshow(shown.pixels, extent=(left, right, low, high), interpolation="antialiased", aspect="equal")
    axes.set(xlim=(left, right), ylim=(low, high), xticks=[], yticks=[])
    axes.grid(False)
    for spine in axes.spines.values():
        spine.set_visible(False)
    length = round_length(BAR_SHARE * (right - left))
    ends = {"arrowstyle": "|-|,widthA=0.15,widthB=0.15", "color": BAR_COLOUR, "shrinkA": 0, "shrinkB": 0}
    below = {"xycoords": ("data", "axes fraction"), "annotation_clip": False}
    start, end = (left, 0.0), (left + length, 0.0)
    axes.annotate("", start, end, textcoords=below["xycoords"], arrowprops=ends, **below)
    text = {"va": "top", "fontsize": SMALLEST_FONT, "color": BAR_COLOUR}
    axes.annotate(f"{length:g} mm", start, (1.0, -3.5), textcoords="offset points", **text, **below)
    _marks(axes, shown, MILLIMETRES * shown.view.height / (POINTS * max(height, 0.1)))


def _marks(axes: Axes, shown: Picture, point_mm: float) -> None:
    """Draw a ring round each marked place with its number beside it, as far as there is room. point_mm: mm of a pt."""
    left, right, low, high = shown.view.extent_mm
    away, taken = NUMBER_AWAY * point_mm, []
    for text, point in shown.marks.items():
        place = shown.view.places_mm(point)[0]
        turns = [np.array([np.cos(turn), np.sin(turn)]) for turn in np.pi * (0.25 + 0.5 * np.arange(4))]
        spots = [place + reach * away * turn for reach in (1.0, 1.7, 2.4) for turn in turns]
        free = (spot for spot in spots if _is_free(spot, taken, away, (left, right, low, high)))
        spot = next(free, None)
        if spot is None:
            continue
        taken += [spot, place]
        axes.plot(*place, "o", markersize=4.0, markerfacecolor="none", markeredgecolor="white", markeredgewidth=2.0)
        axes.plot(*place, "o", markersize=4.0, markerfacecolor="none", markeredgecolor="black", markeredgewidth=0.9)
        ring = {"boxstyle": "circle,pad=0.12", "facecolor": "white", "edgecolor": "black", "linewidth": 0.7}
        style = {"ha": "center", "va": "center", "fontsize": SMALLEST_FONT, "bbox": ring}
        line = {"arrowstyle": "-", "linewidth": 0.7, "color": "black", "shrinkB": 2.0}
        axes.annotate(text, place, spot, arrowprops=line, annotation_clip=False, **style)


def _is_free(spot: np.ndarray, taken: Sequence[np.ndarray], away: float, sides: tuple[float, ...]) -> bool:
    left, right, low, high = sides
    edge = 0.5 * away
    inside = left < spot[0] - edge and spot[0] + edge < right and low < spot[1] - edge and spot[1] + edge < high
    return inside and all(np.linalg.norm(spot - other) > away for other in taken)


def round_length(most: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above a length."""
    power = 10.0 ** math.floor(math.log10(most))
    return max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= most * (1.0 + 1e-9))
