"""The surface before remeshing: how far a new one stands outside or inside it."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bulkwear.postproc.mesh import unit_normals
from bulkwear.postproc.wear.edge_kernels import sorted_edges
from bulkwear.postproc.wear.face_kernels import faces_in_box
from bulkwear.postproc.wear.known_distances import KnownDistances
from bulkwear.postproc.wear.remesh_kernels import edge_normals, heights, node_normals_by_angle, probes, ranges

ON_EDGE = 1e-6  # -, barycentric: closer to an edge or a corner, its own normal tells inside from outside
WIDER = 12.0  # -, over the longest of the faces near which places lie: more than the rings of an attempt
LARGEST_PART = 0.5  # -, of the faces: from there on all are sorted at once


def _tree(points: np.ndarray, triangles: np.ndarray):
    import igl  # only a surface that really is remeshed needs it

    tree = igl.AABB()
    tree.init(points, triangles)
    return tree


@dataclass(frozen=True, eq=False)
class _Part:
    """The faces (k,) of a large surface that reach into a box, (3,) m to (3,) m: all others are not nearer than its
    sides."""

    faces: np.ndarray
    triangles: np.ndarray
    tree: object
    low: np.ndarray
    high: np.ndarray

    @classmethod
    def round(cls, points: np.ndarray, triangles: np.ndarray, near: np.ndarray) -> _Part | None:
        """That round the faces of a mask (m,), None where it would have most of the faces."""
        corners = points[triangles[near]]
        width = WIDER * np.ptp(corners, axis=1).max(initial=0.0)
        low, high = corners.min(axis=(0, 1)) - width, corners.max(axis=(0, 1)) + width
        faces = np.flatnonzero(faces_in_box(points, triangles, low, high))
        if len(faces) > LARGEST_PART * len(triangles):
            return None
        return cls(faces, triangles[faces], _tree(points, triangles[faces]), low, high)

    def nearest(self, points: np.ndarray, places: np.ndarray):
        """As `OldSurface.nearest`, and a mask (k,) of the places to which a face that is not here may be nearer."""
        square, row, point = self.tree.squared_distance(points, self.triangles, places)
        room = np.minimum(places - self.low, self.high - places).min(axis=1)
        return square, self.faces[row], point, ~(np.sqrt(square) < room)


class OldSurface:
    """The surface before remeshing, to measure how far a new one stands outside or inside it.

    The sign comes from the normal of the closest face, edge or corner, weighted by angle at a corner (J. A. Baerentzen
    and H. Aanaes, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243). Faces that are folded or cut others bound no body:
    nothing counts as outside of those marked `tangled` (m,), see `without`. `near` (m,): faces round which most places
    will lie, so that not all of a large surface is sorted.
    """

    def __init__(self, points: np.ndarray, triangles: np.ndarray, near: np.ndarray | None = None):
        self.points, self.triangles = points, triangles
        self.tangled = np.zeros(len(triangles), dtype=bool)
        self._part = None if near is None else _Part.round(points, triangles, near)

    def without(self, tangled: np.ndarray) -> OldSurface:
        """The same surface, with other faces (m,) that bound no body."""
        other = copy(self)
        other.tangled = tangled
        return other

    @cached_property
    def _normals(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Normals of the faces (m, 3), of their edges by the opposite corner (m, 3, 3) and of the nodes (n, 3)."""
        of_face = np.nan_to_num(unit_normals(self.points, self.triangles))
        edges = sorted_edges(self.triangles, len(self.points), False)
        of_edge = edge_normals(of_face, *edges)
        return of_face, of_edge, node_normals_by_angle(self.points, self.triangles, of_face)

    @cached_property
    def _known(self) -> KnownDistances:
        """Distances without regard to what is tangled: surfaces made by `without` share them."""
        return KnownDistances(len(self.triangles), lambda places: self.closest(places)[:2])

    @cached_property
    def _tree(self):
        return _tree(self.points, self.triangles)

    def nearest(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Square of the distance (k,) m2, the closest face (k,) and the closest point (k, 3) m."""
        if not len(places):
            return np.empty(0), np.empty(0, dtype=np.int64), np.empty((0, 3))
        if self._part is None:
            return self._tree.squared_distance(self.points, self.triangles, places)
        square, face, point, beyond = self._part.nearest(self.points, places)
        if beyond.any():
            others = self._tree.squared_distance(self.points, self.triangles, places[beyond])
            square[beyond], face[beyond], point[beyond] = others
        return square, face, point

    def closest(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Signed distance (k,) m, outside > 0, the closest face (k,) and the closest point (k, 3) m."""
        square, face, point = self.nearest(places)
        above = heights(places, point, face, self.points, self.triangles, *self._normals, ON_EDGE)
        return np.copysign(np.sqrt(square), above), face, point

    def range_over_faces(self, points: np.ndarray, triangles: np.ndarray, size: np.ndarray, held=probes) -> np.ndarray:
        """Smallest and largest signed distance of each face over its mean target edge, (k, 2).

        Taken at the corners, the middles of the edges and the centroid, or at what else `held` gives as `probes` does.
        `size` (n,) m: target edge at the nodes.
        """
        places, at = held(points, triangles)
        distance, face = self._known.at(places)
        distance = np.where(self.tangled[face], np.minimum(distance, 0.0), distance)
        return ranges(distance, at, triangles, size)
