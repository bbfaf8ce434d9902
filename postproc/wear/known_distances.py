"""Signed distances that were measured before, found again by the coordinates of their places.

Operations of remeshing are tried in many ways near one place: about half of all places are asked for more than once.
A table of fixed size keeps the last place in each of its rows, so that memory does not grow with the work.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numba import njit

from bulkwear.postproc.wear.face_kernels import MIXER, SHIFT

ROWS_PER_FACE = 8  # at least: a patch of a surface has some seven places per face
MOST_ROWS = 2**17  # 5 MB


class KnownDistances:
    """What `measured` told of places: the signed distance in m and the closest face.

    faces : how many the surface has; measured : places (k, 3) m to distance (k,) m and face (k,)
    """

    def __init__(self, faces: int, measured: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]):
        rows = 2
        while rows < min(ROWS_PER_FACE * faces, MOST_ROWS):
            rows *= 2
        self._measured = measured
        self._held = np.empty((rows, 3), dtype=np.uint64), np.empty(rows), np.full(rows, -1, dtype=np.int64)

    def at(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Signed distance (k,) m and closest face (k,) of places (k, 3) m: of those not known, by measuring them."""
        words = np.ascontiguousarray(places).view(np.uint64)
        distance, face, unknown = _recalled(words, *self._held)
        if len(unknown):
            distance[unknown], face[unknown] = self._measured(places[unknown])
            _keep(words, unknown, distance, face, *self._held)
        return distance, face


@njit(cache=True)
def _row(place, rows) -> int:
    """Row of a table of so many, a power of 2, where the words (3,) of a place belong."""
    key = np.uint64(0)
    for axis in range(3):
        key = (key ^ place[axis]) * MIXER
        key ^= key >> SHIFT
    return np.int64(key & np.uint64(rows - 1))


@njit(cache=True)
def _recalled(words, places, distances, faces):
    """Distance (k,) and face (k,) of the words (k, 3) of places in a table, and which rows (u,) are not in it."""
    distance, face = np.empty(len(words)), np.empty(len(words), dtype=np.int64)
    unknown, count = np.empty(len(words), dtype=np.int64), 0
    for row in range(len(words)):
        at = _row(words[row], len(faces))
        same = faces[at] >= 0
        for axis in range(3):
            same = same and places[at, axis] == words[row, axis]
        if same:
            distance[row], face[row] = distances[at], faces[at]
        else:
            unknown[count] = row
            count += 1
    return distance, face, unknown[:count].copy()


@njit(cache=True)
def _keep(words, rows, distance, face, places, distances, faces):
    """Put those rows (u,) of words (k, 3), distance and face (k,) into a table, each in place of what stood there."""
    for row in rows:
        at = _row(words[row], len(faces))
        for axis in range(3):
            places[at, axis] = words[row, axis]
        distances[at], faces[at] = distance[row], face[row]
