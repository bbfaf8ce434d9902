"""Where bumps stand, and which patterns are refused."""

from dataclasses import replace

import numpy as np
import pytest

from bulkwear.meshes.lattice import narrowest_gap, pattern_centres, pattern_faults, pattern_rows
from bulkwear.meshes.pattern import ConvexPattern

R5 = ConvexPattern(4e-3, 8e-3, 6e-3, row_spacing=40e-3, column_spacing=60e-3)
R9 = ConvexPattern(8e-3, 2e-3, 6e-3, row_spacing=40e-3, column_spacing=20e-3)
R12 = ConvexPattern(8e-3, 8e-3, 1.5e-3, row_spacing=40e-3, column_spacing=20e-3)
OUTLINE = 1e-7  # m: a quarter of an ellipse of some 10 mm in 720 steps
ROUNDING = 1e-12  # m: coordinates of 0.1 m in float64


def per_row(pattern, width, length):
    """Number of bumps in each row."""
    return np.bincount(pattern_rows(pattern, width, length))[1:].tolist()


@pytest.mark.parametrize(
    ("pattern", "size", "counts"),
    [
        (R5, 0.2, [3, 4, 3, 4, 3]),
        (R12, 0.2, [9, 10, 9, 10, 9]),
        (R9, 0.1, [5, 4, 5]),
        (replace(R9, row_spacing=20e-3), 0.1, [5, 4, 5, 4, 5]),
        (replace(R9, row_offset=0.0), 0.1, [5, 5, 5]),
    ],
)
def test_rows(pattern, size, counts):
    """Bumps per row follow the stated rule; shifted rows lose or gain one."""
    assert per_row(pattern, size, size) == counts


def test_every_bump_is_whole_and_no_place_is_left():
    """Feet keep the margin to the rim, and the next row or bump of the lattice would not."""
    for pattern in (R5, R9, R12, replace(R9, major_axis="across_travel", column_spacing=25e-3)):
        centres, _ = pattern_centres(pattern, 0.2, 0.15)
        half = np.array([pattern.half_width, pattern.half_length]) + pattern.rim_margin
        room = np.array([0.1, 0.075]) - half
        assert (np.abs(centres) <= room + 1e-9).all()
        rows = np.unique(centres[:, 1])
        assert rows.max() + pattern.row_spacing / 2 > room[1]  # one row more, centred again, would not fit
        for y in rows:
            assert centres[centres[:, 1] == y, 0].max() + pattern.column_spacing > room[0]


def test_half_offset_is_symmetric():
    """With an offset of one half the pattern is its own mirror image in x and y."""
    centres, _ = pattern_centres(R5, 0.2, 0.2)
    for mirror in ((-1, 1), (1, -1)):
        order = np.lexsort((centres * mirror).round(9).T)
        assert (centres * mirror)[order] == pytest.approx(centres[np.lexsort(centres.round(9).T)], abs=ROUNDING)


def test_offset_shifts_every_second_row():
    """Neighbouring rows differ by the offset times the column spacing, rows two apart by nothing."""
    pattern = replace(R9, row_offset=0.25)
    centres, _ = pattern_centres(pattern, 0.2, 0.2)
    row = pattern_rows(pattern, 0.2, 0.2)
    phase = np.mod(centres[:, 0] / pattern.column_spacing + 1e-6, 1.0)
    assert phase == pytest.approx(np.where(row % 2 == 0, 0.25, 0.0) + 1e-6, abs=1e-9)


def test_column_and_order():
    """Columns count the distinct x from 1; bumps run row by row from -y, in a row from -x."""
    centres, column = pattern_centres(R9, 0.1, 0.1)
    assert column.dtype == np.int64
    assert sorted(set(column.tolist())) == list(range(1, 10))  # -40 to 40 mm every 10 mm
    assert centres[:, 0] == pytest.approx((column - 5) * 10e-3, abs=ROUNDING)
    assert (np.lexsort(centres.round(9).T) == np.arange(len(centres))).all()
    assert (np.diff(pattern_rows(R9, 0.1, 0.1)) >= 0).all()


def test_major_axis_turns_the_foot():
    """The major radius points along y or along x."""
    assert (R9.half_width, R9.half_length) == (2e-3, 8e-3)
    turned = replace(R9, major_axis="across_travel")
    assert (turned.half_width, turned.half_length) == (8e-3, 2e-3)


@pytest.mark.parametrize(
    ("change", "size", "phrase"),
    [
        (
            {"column_spacing": 12e-3},
            0.2,
            "minor radius 8 mm needs a column spacing of more than 16 mm, found 12 mm",
        ),
        ({"column_spacing": 16e-3}, 0.2, "needs a column spacing of more than 16 mm, found 16 mm"),
        ({"row_spacing": 8e-3}, 0.2, "major radius 8 mm needs each row more than 8 mm from the next, found 8 mm"),
        ({"row_spacing": 12e-3}, 0.2, "neighbours stand 10 mm across and 12 mm along the travel apart"),
        (
            {},
            0.017,
            "no bump fits: one with its margin is 18 mm wide and 18 mm long, the sample 17 mm and 17 mm",
        ),
        ({"height": 0.0}, 0.2, "height must be greater than 0 mm, found 0 mm"),
        ({"row_spacing": float("nan")}, 0.2, "row spacing must be greater than 0 mm, found nan mm"),
        ({"major_axis": "along"}, 0.2, "major axis must be along_travel or across_travel, found 'along'"),
        ({"row_offset": 1.0}, 0.2, "row offset must be at least 0 and less than 1, found 1"),
        ({}, -0.1, "sample width must be greater than 0 mm, found -100 mm"),
    ],
)
def test_faults_are_named(change, size, phrase):
    """Each faulty pattern is refused with what is needed and what was found."""
    assert phrase in pattern_faults(replace(R12, **change), size, size)


def test_overlap_is_exact():
    """Diagonal neighbours touch when (dx / 2 rx)^2 + (dy / 2 ry)^2 = 1: allowed just above, not below."""
    limit = 16e-3 * np.sqrt(1 - (10 / 16) ** 2)  # R12: dx = 10 mm, feet of radius 8 mm
    assert pattern_faults(replace(R12, row_spacing=limit * 1.001), 0.2, 0.2) is None
    assert "bumps overlap" in pattern_faults(replace(R12, row_spacing=limit * 0.999), 0.2, 0.2)


def test_gaps_between_feet_are_exact():
    """Of circles beside and behind one another; of the diagonal neighbours of ellipses by walking both outlines."""
    assert narrowest_gap(R12, 0.2, 0.2) == pytest.approx(20e-3 - 2 * 8e-3, abs=OUTLINE)
    close = replace(R12, row_spacing=14e-3)
    assert narrowest_gap(close, 0.2, 0.2) == pytest.approx(np.hypot(10e-3, 14e-3) - 2 * 8e-3, abs=OUTLINE)
    slanted = replace(R5, column_spacing=24e-3, row_spacing=6e-3)
    angle = np.linspace(0.0, 2.0 * np.pi, 1440)
    foot = np.column_stack([slanted.half_width * np.cos(angle), slanted.half_length * np.sin(angle)])
    other = foot + np.array([12e-3, 6e-3])
    apart = np.linalg.norm(foot[:, None] - other, axis=2).min()
    assert narrowest_gap(slanted, 0.2, 0.2) == pytest.approx(apart, abs=10 * OUTLINE)
    assert narrowest_gap(R12, 0.019, 0.019) == np.inf


def test_only_neighbours_that_exist_can_overlap():
    """A spacing too small for two bumps is no fault on a sample that holds only one."""
    alone = replace(R12, column_spacing=12e-3, row_spacing=7e-3)
    assert len(pattern_centres(alone, 0.019, 0.019)[0]) == 1
    assert pattern_faults(alone, 0.019, 0.019) is None
