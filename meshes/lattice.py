"""A pattern: one shape, a bump or a dimple, repeated on a plane in rows across the travel (Yan 2022, Figure 3.7).

The travel is along y, the width along x. Rows lie across the travel, `row_spacing` apart; within a row the shapes lie
`column_spacing` apart; every second row is shifted by `row_offset` of the column spacing (parallelogram arrangement).
Which shapes there are stands in `meshes.pattern`.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import Field, field, fields
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from bulkwear.meshes.shell import Shell, height_area, height_shell, shell_element_size

RIM_MARGIN = 0.125  # of the foot's smaller radius: plane left between a shape and the rim, so that triangles fit there
NEIGHBOURS = 8  # of a shape, that its gaps are looked for to
OUTLINE_POINTS = 721  # of a quarter of an ellipse
ROUNDING = 1e-9  # relative: a shape that fits exactly is not lost to the last digit


def dimension(unit: str, least: float, most: float, meaning: str) -> Any:
    """Field of a pattern for a length (unit mm) or an angle (deg), in SI, with its limits in that unit."""
    return field(metadata={"unit": unit, "least": least, "most": most, "meaning": meaning})


def option(default: str, allowed: Sequence[str], meaning: str) -> Any:
    """Field of a pattern for one of some words."""
    return field(default=default, metadata={"allowed": tuple(allowed), "meaning": meaning})


class Pattern(ABC):
    """A shape on its lattice, lengths in m; subclasses are frozen dataclasses and stand in `meshes.pattern.PATTERNS`.

    A subclass declares its own measures with `dimension` and `option`, and restates the lattice as fields: row_spacing
    (between one row and the next, along the travel), column_spacing (d, within a row) and row_offset (shift of every
    second row as a fraction of the column spacing, at least 0 and less than 1).
    name: of a surface that bears it; noun: what one of its shapes is called
    creases: where its slope jumps, as sizes of the foot's outline over the foot itself (-), above 0 and below 1
    """

    name: ClassVar[str]
    noun: ClassVar[str]
    row_spacing: float
    column_spacing: float
    row_offset: float

    @property
    @abstractmethod
    def foot(self) -> tuple[tuple[str, float], tuple[str, float]]:
        """Outline in the plane, an ellipse or circle: name and length (m) of its radius across and along the travel."""

    @abstractmethod
    def height_at(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Height (m) over the plane at places (m) from a shape's centre, within its foot; negative below the plane."""

    @property
    @abstractmethod
    def highest_point(self) -> float:
        """Height (m) of the highest point over the plane, at least 0."""

    @property
    @abstractmethod
    def deepest_point(self) -> float:
        """Depth (m) of the lowest point under the plane, at least 0."""

    @property
    def bump_axes(self) -> tuple[float, float, float] | None:
        """Radii a and b and height h (m) for ratios of particle to bump (Yan 2022, Eq 4.18); None for no such shape."""
        return None

    @property
    def creases(self) -> tuple[float, ...]:
        return ()

    @property
    def own_fault(self) -> str | None:
        """What is wrong with the shape itself, lengths that are not above 0 aside; a phrase, or None."""
        return None

    def shell(self, element_size: float) -> Shell:
        """Mesh one shape with elements of about that size (m) on its plane; finer ones where it is small.

        A shape that stands upright at its foot has no height function to be meshed by, and overrides this.
        """
        size = shell_element_size(self.half_width, self.half_length, element_size)
        return height_shell(self.half_width, self.half_length, self.height_at, self.creases, size)

    @property
    def shell_area(self) -> float:
        """Area (m2) of one shape's surface."""
        return height_area(self.half_width, self.half_length, self.height_at)

    @property
    def half_width(self) -> float:
        """Radius of the foot across the travel (x), m."""
        return self.foot[0][1]

    @property
    def half_length(self) -> float:
        """Radius of the foot along the travel (y), m."""
        return self.foot[1][1]

    @property
    def rim_margin(self) -> float:
        """Smallest distance between a shape and the rim of the sample, m."""
        return RIM_MARGIN * min(self.half_width, self.half_length)

    @classmethod
    def dimensions(cls) -> Iterator[Field]:
        """Fields of the lengths and angles of one shape."""
        return (each for each in fields(cls) if "unit" in each.metadata)

    @classmethod
    def options(cls) -> Iterator[Field]:
        """Fields of the words that describe one shape."""
        return (each for each in fields(cls) if "allowed" in each.metadata)


def _places(extent: float, half_shape: float, spacing: float, start: float) -> np.ndarray:
    """Positions `start` + i `spacing`, any integer i, where a shape of `half_shape` fits into `extent`, m."""
    room = extent / 2 - half_shape + ROUNDING * extent
    first, last = math.ceil((-room - start) / spacing), math.floor((room - start) / spacing)
    return start + spacing * np.arange(first, last + 1)


def pattern_centres(pattern: Pattern, width: float, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Centres (k, 2) m of the shapes on a sample of `width` (x) by `length` (y) m, and their column (k,).

    The rule: the sample is centred at the origin and bears only whole shapes, `rim_margin` or more from the
    rim. As many rows as fit into the length are centred in it. The first, third ... row (counted from -y) has
    a shape on the centre line x = 0 and one every column spacing to either side, as many as fit. The second,
    fourth ... row is that lattice shifted by `row_offset` of the column spacing, as far as shapes fit: it
    drops the one that would leave the sample, and holds one more than a straight row where that fits. R5 of
    Table 3.8 on 200 x 200 mm with rows 40 mm apart has 3 + 4 + 3 + 4 + 3 = 17 bumps.

    Shapes are numbered row by row from -y (the edge that meets the bed first), in a row from -x. The column is
    1 for the smallest x that occurs, 2 for the next ...: shifted rows therefore have columns of their own.
    """
    half_width = pattern.half_width + pattern.rim_margin
    half_length = pattern.half_length + pattern.rim_margin
    rows = _places(length, half_length, pattern.row_spacing, 0.0)
    between = _places(length, half_length, pattern.row_spacing, pattern.row_spacing / 2)
    rows = between if len(between) > len(rows) else rows
    spacing = pattern.column_spacing
    straight, shifted = (_places(width, half_width, spacing, s * spacing) for s in (0.0, pattern.row_offset))
    per_row = [shifted if row % 2 else straight for row in range(len(rows))]
    if not per_row:
        return np.empty((0, 2)), np.empty(0, dtype=np.int64)
    centres = np.column_stack([np.concatenate(per_row), np.repeat(rows, [len(x) for x in per_row])])
    _, column = np.unique(np.round(centres[:, 0] / spacing, 6), return_inverse=True)
    return centres, column.astype(np.int64) + 1


def pattern_rows(pattern: Pattern, width: float, length: float) -> np.ndarray:
    """Row of each shape, (k,): 1 at -y, where the bed arrives. Figures 6.1 and 6.13 call a row "column"."""
    centres, _ = pattern_centres(pattern, width, length)
    _, row = np.unique(np.round(centres[:, 1] / pattern.row_spacing, 6), return_inverse=True)
    return row.astype(np.int64) + 1


def pattern_faults(pattern: Pattern, width: float, length: float) -> str | None:
    """What is wrong with a pattern on a `width` by `length` m sample, as one phrase, or None when nothing is.

    Two equal ellipses with parallel axes overlap when the centre of one lies within the other grown to twice
    its size: so every pair of neighbours is tested exactly, diagonal ones included.
    """
    return (
        _argument_fault(pattern, width, length)
        or pattern.own_fault
        or _fit_fault(pattern, width, length)
        or _overlap_fault(pattern, width, length)
    )


def millimetres(metres: float) -> str:
    """A length (m) as phrases show it."""
    return f"{1e3 * metres:.4g} mm"


def _argument_fault(pattern: Pattern, width: float, length: float) -> str | None:
    names = [each.name for each in pattern.dimensions() if each.metadata["unit"] == "mm"]
    lengths = {name: getattr(pattern, name) for name in (*names, "row_spacing", "column_spacing")}
    for name, value in (lengths | {"sample width": width, "sample length": length}).items():
        if not (math.isfinite(value) and value > 0):
            return f"{name.replace('_', ' ')} must be greater than 0 mm, found {millimetres(value)}"
    for each in pattern.options():
        allowed, found = each.metadata["allowed"], getattr(pattern, each.name)
        if found not in allowed:
            return f"{each.name.replace('_', ' ')} must be {' or '.join(allowed)}, found '{found}'"
    if not 0 <= pattern.row_offset < 1:
        return f"row offset must be at least 0 and less than 1, found {pattern.row_offset:.4g}"
    return None


def _fit_fault(pattern: Pattern, width: float, length: float) -> str | None:
    needed = [2 * (half + pattern.rim_margin) for half in (pattern.half_width, pattern.half_length)]
    if needed[0] <= (1 + ROUNDING) * width and needed[1] <= (1 + ROUNDING) * length:
        return None
    return (
        f"no {pattern.noun} fits: one with its margin is {millimetres(needed[0])} wide and {millimetres(needed[1])} "
        f"long, the sample {millimetres(width)} and {millimetres(length)}"
    )


def _overlap_fault(pattern: Pattern, width: float, length: float) -> str | None:
    (across_name, across), (along_name, lengthwise) = pattern.foot
    room = width - 2 * (across + pattern.rim_margin)
    if pattern.column_spacing <= min(2 * across, room):
        return (
            f"{pattern.noun}s overlap: {across_name} {millimetres(across)} needs a column spacing of more than "
            f"{millimetres(2 * across)}, found {millimetres(pattern.column_spacing)}"
        )
    room = length - 2 * (lengthwise + pattern.rim_margin)
    if 2 * pattern.row_spacing <= min(2 * lengthwise, room):
        return (
            f"{pattern.noun}s overlap: {along_name} {millimetres(lengthwise)} needs each row more than "
            f"{millimetres(lengthwise)} from the next, found {millimetres(pattern.row_spacing)}"
        )
    from scipy.spatial import cKDTree  # slow to import, and every start of Snakemake reads this module

    centres, _ = pattern_centres(pattern, width, length)
    pairs = cKDTree(centres / (2 * across, 2 * lengthwise)).query_pairs(1.0, output_type="ndarray")
    if not len(pairs):
        return None
    gap = np.abs(centres[pairs[:, 1]] - centres[pairs[:, 0]])
    worst = gap[np.argmin(((gap / (2 * across, 2 * lengthwise)) ** 2).sum(axis=1))]
    return (
        f"{pattern.noun}s overlap: neighbours stand {millimetres(worst[0])} across and {millimetres(worst[1])} along "
        f"the travel apart, too close for feet of {millimetres(2 * across)} by {millimetres(2 * lengthwise)}"
    )


@lru_cache(maxsize=256)  # rows of a design, and packings of a row, have few patterns
def narrowest_gap(pattern: Pattern, width: float, length: float) -> float:
    """Smallest distance (m) between the feet of a pattern on a `width` by `length` m sample, inf of a single one.

    Two equal ellipses with parallel axes are as far apart as the centre of one is from the other grown to twice its
    size. The pattern is one without a fault.
    """
    from scipy.spatial import cKDTree  # slow to import, and every start of Snakemake reads this module

    centres, _ = pattern_centres(pattern, width, length)
    if len(centres) < 2:
        return math.inf
    grown = np.array([2 * pattern.half_width, 2 * pattern.half_length])
    _, near = cKDTree(centres / grown).query(centres / grown, min(NEIGHBOURS, len(centres) - 1) + 1)
    apart = np.abs(centres[near[:, 1:]] - centres[:, None]).reshape(-1, 2)
    apart = np.unique(np.round(apart / grown, 9), axis=0) * grown
    angle = np.linspace(0.0, math.pi / 2, OUTLINE_POINTS)
    outline = grown * np.column_stack([np.cos(angle), np.sin(angle)])
    return float(np.linalg.norm(apart[:, None] - outline, axis=2).min())
