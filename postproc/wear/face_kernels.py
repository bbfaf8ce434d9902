"""Compiled loops over the faces of a whole surface: their measures, and which two surfaces have in common."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from bulkwear.postproc.triangle import area_vector, between, dot, smallest_angle

WORDS = 9  # of eight bytes, in the corners of a face
MIXER = np.uint64(0x9E3779B97F4A7C15)  # odd, its bits without order: spreads alike words over a table
SHIFT = np.uint64(32)


@njit(cache=True)
def face_measures(points, triangles):
    """Smallest angle (m,) degrees, lengths of the edges 0-1, 1-2, 2-0 (m, 3) m, their longest (m,) m and the area (m,)
    m2 of each face. points (n, 3) m; triangles (m, 3)
    """
    angle, lengths = np.empty(len(triangles)), np.empty((len(triangles), 3))
    longest, area = np.empty(len(triangles)), np.empty(len(triangles))
    for row in range(len(triangles)):
        face = triangles[row]
        angle[row] = smallest_angle(points, face)
        for k in range(3):
            edge = between(points, face[k], face[(k + 1) % 3])
            lengths[row, k] = math.sqrt(dot(edge, edge))
        longest[row] = max(lengths[row, 0], lengths[row, 1], lengths[row, 2])
        vector = area_vector(points, face)
        area[row] = math.sqrt(dot(vector, vector))
    return angle, lengths, longest, area


@njit(cache=True)
def folds(points, triangles, held, new, least_cosine) -> np.ndarray:
    """Mask (m,) of the faces of no area, and of those whose normals at a common edge have a smaller cosine.

    held, new : see `postproc.wear.edge_kernels.sorted_edges`, of the triangles (m, 3)
    """
    normals, result = np.zeros((len(triangles), 3)), np.zeros(len(triangles), dtype=np.bool_)
    for row in range(len(triangles)):
        vector = area_vector(points, triangles[row])
        size = math.sqrt(dot(vector, vector))
        result[row] = not size > 0.0
        for axis in range(3):
            if size > 0.0:
                normals[row, axis] = vector[axis] / size
    for at in range(1, len(held)):
        if not new[at]:
            one, other = held[at - 1] // 3, held[at] // 3
            if dot(normals[one], normals[other]) < least_cosine:
                result[one] = result[other] = True
    return result


@njit(cache=True)
def any_corner(mask, triangles) -> np.ndarray:
    """Mask (m,) of the triangles (m, 3) one of whose nodes is in a mask (n,)."""
    result = np.empty(len(triangles), dtype=np.bool_)
    for row in range(len(triangles)):
        face = triangles[row]
        result[row] = mask[face[0]] or mask[face[1]] or mask[face[2]]
    return result


@njit(cache=True)
def acute_faces(points, triangles, bound: float) -> np.ndarray:
    """Mask (m,) of the faces whose smallest angle is below a bound, degrees."""
    result = np.empty(len(triangles), dtype=np.bool_)
    for row in range(len(triangles)):
        result[row] = smallest_angle(points, triangles[row]) < bound
    return result


@njit(cache=True)
def angles(points, triangles) -> np.ndarray:
    """Smallest interior angle of each face, (m,) degrees."""
    result = np.empty(len(triangles))
    for row in range(len(triangles)):
        result[row] = smallest_angle(points, triangles[row])
    return result


@njit(cache=True)
def faces_in_box(points, triangles, low, high) -> np.ndarray:
    """Mask (m,) of the triangles whose own boxes reach into that from `low` (3,) m to `high` (3,) m, or touch it."""
    result = np.ones(len(triangles), dtype=np.bool_)
    for row in range(len(triangles)):
        a, b, c = triangles[row]
        for axis in range(3):
            lowest = min(points[a, axis], points[b, axis], points[c, axis])
            highest = max(points[a, axis], points[b, axis], points[c, axis])
            result[row] &= highest >= low[axis] and lowest <= high[axis]
    return result


def corner_words(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Coordinates of the corners of each face as unsigned words, (m, 9), to compare them bit for bit."""
    return np.ascontiguousarray(points[triangles].reshape(-1, WORDS)).view(np.uint64)


@njit(cache=True)
def _slot(words, row, others, table) -> int:
    """Place in a table of rows of `others` where the same nine words stand, or that is empty (-1)."""
    key = np.uint64(0)
    for k in range(WORDS):
        key = (key ^ words[row, k]) * MIXER
        key ^= key >> SHIFT
    slot = np.int64(key & np.uint64(len(table) - 1))
    while table[slot] >= 0:
        same = True
        for k in range(WORDS):
            same = same and words[row, k] == others[table[slot], k]
        if same:
            break
        slot = (slot + 1) & (len(table) - 1)
    return slot


@njit(cache=True)
def rows_among(words, others) -> np.ndarray:
    """Mask (k,) of the rows (k, 9) of unsigned words that occur among others (m, 9)."""
    size = 2
    while size < 2 * len(others):
        size *= 2
    table, result = np.full(size, -1), np.empty(len(words), dtype=np.bool_)
    for row in range(len(others)):
        table[_slot(others, row, others, table)] = row
    for row in range(len(words)):
        result[row] = table[_slot(words, row, others, table)] >= 0
    return result
