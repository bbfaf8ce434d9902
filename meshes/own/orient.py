"""Give each connected piece one winding, and turn closed pieces outward."""

from __future__ import annotations

from dataclasses import replace

import igl
import numpy as np

from bulkwear.meshes.own.repairs import Repairs
from bulkwear.meshes.own.solids import Solids
from bulkwear.meshes.own.weld import open_corners
from bulkwear.postproc.mesh import areas, centroids, nonmanifold_edges

INSIDE = 0.5  # -, winding number of a place within a closed piece: 1, outside 0


def consistently_wound(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (m, 3) of one winding in each piece connected by edges, and the number of the piece of each, (m,).

    Edges must have at most two triangles. A piece with one side only, like a Moebius strip, keeps edges that two of its
    triangles run through in the same sense (`nonmanifold_edges`).
    """
    return igl.bfs_orient(np.ascontiguousarray(triangles))


def _closed(triangles: np.ndarray, piece: np.ndarray) -> np.ndarray:
    """Mask of the pieces without an open edge."""
    closed = np.ones(piece.max() + 1, dtype=bool)
    closed[piece[open_corners(triangles) // 3]] = False
    return closed


def oriented(solids: Solids, repairs: Repairs) -> Solids:
    """Solids with one winding in each piece, closed pieces outward.

    A closed piece within another one of its part is a cavity and looks into it. An open piece keeps the winding that
    most of its area has. The pieces must be orientable.
    """
    points, given = solids.points, solids.triangles
    turned, piece = consistently_wound(given)
    against = ~_same_winding(given, turned)
    closed = _closed(given, piece)
    area = areas(points, given)
    mostly_against = np.bincount(piece, area * np.where(against, 1.0, -1.0)) > 0.0
    inward = _volumes(points, turned, piece) < 0.0
    cavity = _cavities(points, turned, piece, solids.part, closed)
    back = np.where(closed, inward ^ cavity, mostly_against)[piece]
    triangles = np.where(back[:, None], turned[:, ::-1], turned)
    changed = against ^ back
    middle = centroids(points, given)
    repairs.add("facets turned round", solids.part[changed], middle[changed])
    first = np.unique(piece, return_index=True)[1]
    repairs.add("cavities found, turned inward", solids.part[first[cavity]], middle[first[cavity]])
    repairs.add("open pieces, touched side unknown", solids.part[first[~closed]], middle[first[~closed]])
    return replace(solids, triangles=triangles)


def one_sided_edges(triangles: np.ndarray) -> np.ndarray:
    """Edges (k, 2) at which no winding of the triangles fits together: their piece has one side only."""
    return nonmanifold_edges(consistently_wound(triangles)[0])


def _same_winding(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Mask (m,) of rows with the same nodes in the same cyclic order."""
    start = np.argmax(second == first[:, :1], axis=1)
    return np.take_along_axis(second, (start[:, None] + 1) % 3, axis=1)[:, 0] == first[:, 1]


def _volumes(points: np.ndarray, triangles: np.ndarray, piece: np.ndarray) -> np.ndarray:
    """Volume (m3) within each closed piece, negative where it is wound inward; without meaning for an open one."""
    origin = points[triangles[np.unique(piece, return_index=True)[1], 0]]
    corners = points[triangles] - origin[piece][:, None]
    return np.bincount(piece, np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6.0


def _cavities(points, triangles, piece, part, closed) -> np.ndarray:
    """Mask of the closed pieces that lie within an odd number of closed pieces of their part."""
    count = len(closed)
    first = np.unique(piece, return_index=True)[1]
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, piece, points[triangles].min(axis=1))
    np.maximum.at(high, piece, points[triangles].max(axis=1))
    depth = np.zeros(count, dtype=np.int64)
    for outer in np.flatnonzero(closed):
        within = closed & (part[first] == part[first[outer]]) & (low >= low[outer]).all(axis=1)
        within &= (high <= high[outer]).all(axis=1)
        within[outer] = False
        inner = np.flatnonzero(within)
        if len(inner):
            mine = np.ascontiguousarray(triangles[piece == outer])
            number = igl.winding_number(points, mine, centroids(points, triangles[first[inner]]))
            depth[inner] += np.abs(number) > INSIDE
    return depth % 2 == 1
