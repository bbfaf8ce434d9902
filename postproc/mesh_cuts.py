"""Whether two faces cut one another along a line: compiled, because a surface has several close pairs per face.

Both meet the line common to their planes in an interval; they cut where the intervals overlap. Source: T. Moeller,
J. Graphics Tools 2 (1997) 25.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from bulkwear.postproc.triangle import area_vector, cross, dot

IN_PLANE = 1e-9  # -, height over distance: faces that lie in one plane up to rounding do not cut one another
TINY = np.finfo(np.float64).tiny


@njit(cache=True)
def cutting(points: np.ndarray, triangles: np.ndarray, pairs: np.ndarray, clearance: float) -> np.ndarray:
    """Mask (p,) of the pairs (p, 2) of faces that pass through one another; neighbours at an edge never do.

    points (n, 3) m; triangles (m, 3); clearance: m, see `postproc.mesh_checks.intersecting_faces`
    """
    result = np.zeros(len(pairs), dtype=np.bool_)
    heights, interval = np.empty((2, 3)), np.empty((2, 2))
    for row in range(len(pairs)):
        first, second = triangles[pairs[row, 0]], triangles[pairs[row, 1]]
        if _common_nodes(first, second) >= 2:
            continue
        other_normal = area_vector(points, second)
        _heights_over(points, first, second, other_normal, heights[0])
        if not _on_both_sides(heights[0], 0.0):
            continue
        normal = area_vector(points, first)
        _heights_over(points, second, first, normal, heights[1])
        least = max(IN_PLANE * _reach(points, first, second), clearance)
        if not (_on_both_sides(heights[0], least) and _on_both_sides(heights[1], least)):
            continue
        x, y, z = cross(normal, other_normal)
        length = max(np.sqrt(dot((x, y, z), (x, y, z))), TINY)
        line = x / length, y / length, z / length
        _interval_on(points, first, points[first[0]], heights[0], line, interval[0])
        _interval_on(points, second, points[first[0]], heights[1], line, interval[1])
        result[row] = min(interval[0, 1], interval[1, 1]) - max(interval[0, 0], interval[1, 0]) > least
    return result


@njit(cache=True)
def _on_both_sides(heights, least) -> bool:
    """Whether heights (3,) m are above and below a plane, by more than so much."""
    lowest, highest = min(heights[0], heights[1], heights[2]), max(heights[0], heights[1], heights[2])
    return lowest < -least and highest > least


@njit(cache=True)
def _common_nodes(ours, theirs) -> int:
    count = 0
    for i in range(3):
        for j in range(3):
            count += ours[i] == theirs[j]
    return count


@njit(cache=True)
def _reach(points, ours, theirs) -> float:
    """Largest distance (m) of our corners from the first of theirs."""
    largest = 0.0
    for i in range(3):
        square = 0.0
        for axis in range(3):
            square += (points[ours[i], axis] - points[theirs[0], axis]) ** 2
        largest = max(largest, square)
    return np.sqrt(largest)


@njit(cache=True)
def _heights_over(points, ours, theirs, normal, heights) -> None:
    """Fill in the heights (3,) m of our corners over their plane; 0 at common nodes, so that rounding tells no side."""
    length = max(np.sqrt(dot(normal, normal)), TINY)
    for i in range(3):
        height = 0.0
        if ours[i] != theirs[0] and ours[i] != theirs[1] and ours[i] != theirs[2]:
            for axis in range(3):
                height += (points[ours[i], axis] - points[theirs[0], axis]) * normal[axis]
        heights[i] = height / length


@njit(cache=True)
def _interval_on(points, face, origin, heights, line, interval) -> None:
    """Fill in where (from, to, m) a face with corners on both sides of a plane crosses it, along a line."""
    interval[0], interval[1] = np.inf, -np.inf
    for i in range(3):
        j = (i + 1) % 3
        if (heights[i] > 0.0) == (heights[j] > 0.0):
            continue
        here, there = 0.0, 0.0
        for axis in range(3):
            here += (points[face[i], axis] - origin[axis]) * line[axis]
            there += (points[face[j], axis] - origin[axis]) * line[axis]
        place = here + heights[i] / (heights[i] - heights[j]) * (there - here)
        interval[0], interval[1] = min(interval[0], place), max(interval[1], place)
