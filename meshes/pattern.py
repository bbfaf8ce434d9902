"""The convex pattern: identical semi-ellipsoids on a plane, in rows across the travel (Yan 2022, Figure 3.7).

The travel is along y, the width along x. Rows lie across the travel, `row_spacing` apart; within a row the
bumps lie `column_spacing` apart; every second row is shifted by `row_offset` of the column spacing
(parallelogram arrangement).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

MAJOR_AXES = ("along_travel", "across_travel")
RIM_MARGIN = 0.125  # of the smaller radius: plane left between a bump and the rim, so that triangles fit there
ROUNDING = 1e-9  # relative: a bump that fits exactly is not lost to the last digit


@dataclass(frozen=True)
class ConvexPattern:
    """Dimensions of the pattern, in m unless said otherwise.

    major_radius, minor_radius: semi-axes a and b of a bump's foot (a may be the smaller, as in Table 3.8);
    height: h; row_spacing: between one row and the next, along the travel; column_spacing: d, within a row;
    major_axis: along_travel (a along y) or across_travel (a along x);
    row_offset: shift of every second row as a fraction of the column spacing, at least 0 and less than 1.
    """

    major_radius: float
    minor_radius: float
    height: float
    row_spacing: float
    column_spacing: float
    major_axis: str = "along_travel"
    row_offset: float = 0.5

    @property
    def half_width(self) -> float:
        """Semi-axis of the foot across the travel (x), m."""
        return self.minor_radius if self.major_axis == "along_travel" else self.major_radius

    @property
    def half_length(self) -> float:
        """Semi-axis of the foot along the travel (y), m."""
        return self.major_radius if self.major_axis == "along_travel" else self.minor_radius

    @property
    def rim_margin(self) -> float:
        """Smallest distance between a bump and the rim of the sample, m."""
        return RIM_MARGIN * min(self.major_radius, self.minor_radius)


def _places(extent: float, half_bump: float, spacing: float, start: float) -> np.ndarray:
    """Positions `start` + i `spacing`, any integer i, where a bump of `half_bump` fits into `extent`, m."""
    room = extent / 2 - half_bump + ROUNDING * extent
    first, last = math.ceil((-room - start) / spacing), math.floor((room - start) / spacing)
    return start + spacing * np.arange(first, last + 1)


def bump_centres(pattern: ConvexPattern, width: float, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Centres (k, 2) m of the bumps on a sample of `width` (x) by `length` (y) m, and their column (k,).

    The rule: the sample is centred at the origin and bears only whole bumps, `rim_margin` or more from the
    rim. As many rows as fit into the length are centred in it. The first, third ... row (counted from -y) has
    a bump on the centre line x = 0 and one every column spacing to either side, as many as fit. The second,
    fourth ... row is that lattice shifted by `row_offset` of the column spacing, as far as bumps fit: it
    drops the bump that would leave the sample, and holds one more than a straight row where that fits. R5 of
    Table 3.8 on 200 x 200 mm with rows 40 mm apart has 3 + 4 + 3 + 4 + 3 = 17 bumps.

    Bumps are numbered row by row from -y (the edge that meets the bed first), in a row from -x. The column is
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


def bump_rows(pattern: ConvexPattern, width: float, length: float) -> np.ndarray:
    """Row of each bump, (k,): 1 at -y, where the bed arrives. Figures 6.1 and 6.13 call a row "column"."""
    centres, _ = bump_centres(pattern, width, length)
    _, row = np.unique(np.round(centres[:, 1] / pattern.row_spacing, 6), return_inverse=True)
    return row.astype(np.int64) + 1


def pattern_faults(pattern: ConvexPattern, width: float, length: float) -> str | None:
    """What is wrong with a pattern on a `width` by `length` m sample, as one phrase, or None when nothing is.

    Two equal ellipses with parallel axes overlap when the centre of one lies within the other grown to twice
    its size: so every pair of neighbours is tested exactly, diagonal ones included.
    """
    return (
        _argument_fault(pattern, width, length)
        or _fit_fault(pattern, width, length)
        or _overlap_fault(pattern, width, length)
    )


def _mm(metres: float) -> str:
    return f"{1e3 * metres:.4g} mm"


def _argument_fault(pattern: ConvexPattern, width: float, length: float) -> str | None:
    lengths = {name: getattr(pattern, name) for name in ("major_radius", "minor_radius", "height")}
    lengths |= {name: getattr(pattern, name) for name in ("row_spacing", "column_spacing")}
    for name, value in (lengths | {"sample width": width, "sample length": length}).items():
        if not (math.isfinite(value) and value > 0):
            return f"{name.replace('_', ' ')} must be greater than 0 mm, found {_mm(value)}"
    if pattern.major_axis not in MAJOR_AXES:
        return f"major axis must be {' or '.join(MAJOR_AXES)}, found '{pattern.major_axis}'"
    if not 0 <= pattern.row_offset < 1:
        return f"row offset must be at least 0 and less than 1, found {pattern.row_offset:.4g}"
    return None


def _fit_fault(pattern: ConvexPattern, width: float, length: float) -> str | None:
    needed = [2 * (half + pattern.rim_margin) for half in (pattern.half_width, pattern.half_length)]
    if needed[0] <= (1 + ROUNDING) * width and needed[1] <= (1 + ROUNDING) * length:
        return None
    return (
        f"no bump fits: one with its margin is {_mm(needed[0])} wide and {_mm(needed[1])} long, "
        f"the sample {_mm(width)} and {_mm(length)}"
    )


def _overlap_fault(pattern: ConvexPattern, width: float, length: float) -> str | None:
    along = pattern.major_axis == "along_travel"
    radii = [("major", pattern.major_radius), ("minor", pattern.minor_radius)]
    (across_name, across), (along_name, lengthwise) = radii[::-1] if along else radii
    room = width - 2 * (across + pattern.rim_margin)
    if pattern.column_spacing <= min(2 * across, room):
        return (
            f"bumps overlap: {across_name} radius {_mm(across)} needs a column spacing of more than "
            f"{_mm(2 * across)}, found {_mm(pattern.column_spacing)}"
        )
    room = length - 2 * (lengthwise + pattern.rim_margin)
    if 2 * pattern.row_spacing <= min(2 * lengthwise, room):
        return (
            f"bumps overlap: {along_name} radius {_mm(lengthwise)} needs a row spacing of more than "
            f"{_mm(lengthwise)}, found {_mm(pattern.row_spacing)}"
        )
    centres, _ = bump_centres(pattern, width, length)
    pairs = cKDTree(centres / (2 * across, 2 * lengthwise)).query_pairs(1.0, output_type="ndarray")
    if not len(pairs):
        return None
    gap = np.abs(centres[pairs[:, 1]] - centres[pairs[:, 0]])
    worst = gap[np.argmin(((gap / (2 * across, 2 * lengthwise)) ** 2).sum(axis=1))]
    return (
        f"bumps overlap: neighbours stand {_mm(worst[0])} across and {_mm(worst[1])} along the travel apart, "
        f"too close for feet of {_mm(2 * across)} by {_mm(2 * lengthwise)}"
    )
