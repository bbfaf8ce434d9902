"""Where surfaces and closed bodies of drawings lie to one another: places within them, surfaces on surfaces."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import igl
import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, areas, boundary_nodes
from bulkwear.postproc.wear.bodies import body
from bulkwear.postproc.wear.side import connected_pieces

WITHIN = 0.5  # -, winding number of a place within a closed body: 1, outside 0
SHARED_WITHIN = 2e-4  # -, of the smaller part's diagonal: surfaces that are closer count as one
FACETS_LOOKED_AT = 2000  # of a part at most


def diagonal(points: np.ndarray) -> float:
    """Return the diagonal (m) of the box round places (n, 3) m."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))


# ---------------------------------------------------------------- places within


def first_within(
    points: np.ndarray,
    triangles: np.ndarray,
    half: np.ndarray,
    spacing: float,
    inside: Callable[[np.ndarray], np.ndarray] | None = None,
) -> np.ndarray | None:
    """Return a place (3,) m of a surface within a box about the origin, and where `inside` says so; None without one.

    points: (n, 3) m; triangles: (m, 3); half: (3,) m, half the sides of the box; spacing: m, what is narrower may be
    missed; inside: of places (k, 3), whether each is within (k,)
    """
    if not (half > 0.0).all():
        return None
    for corners in _small_pieces(points[triangles], half, spacing):
        middle = corners.mean(axis=1)
        hits = (np.abs(middle) < half).all(axis=1)
        hits &= inside(middle) if inside else True
        if hits.any():
            return middle[np.argmax(hits)]
    return None


def _small_pieces(corners: np.ndarray, half: np.ndarray, spacing: float) -> Iterator[np.ndarray]:
    """Yield triangles (k, 3, 3) that may reach into a box, halved at their longest edges until those are short."""
    while len(corners):
        corners = corners[((corners.min(axis=1) < half) & (corners.max(axis=1) > -half)).all(axis=1)]
        lengths = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        small = lengths.max(axis=1, initial=0.0) <= spacing
        yield corners[small]
        corners, lengths = corners[~small], lengths[~small]
        rows = np.arange(len(corners))
        first = lengths.argmax(axis=1)
        a, b, c = (corners[rows, (first + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])


def closed_faces(triangles: np.ndarray) -> np.ndarray:
    """Return the mask (m,) of the faces whose connected piece has no open edge; triangles: (m, 3)."""
    piece, rim = connected_pieces(triangles), np.isin(triangles, boundary_nodes(triangles)).any(axis=1)
    return ~np.isin(piece, piece[rim])


def is_within(points: np.ndarray, triangles: np.ndarray, place: np.ndarray) -> bool:
    """Return whether a place (3,) m lies within closed bodies; points (n, 3) m, triangles (m, 3)."""
    corners = points[triangles].reshape(-1, 3)
    if not len(corners) or (place < corners.min(axis=0)).any() or (place > corners.max(axis=0)).any():
        return False
    number = igl.winding_number(np.ascontiguousarray(points), np.ascontiguousarray(triangles), np.array([place]))
    return bool(np.abs(number).max() > WITHIN)


# ---------------------------------------------------------------- surfaces on surfaces


def on_surface(mesh: SurfaceMesh, other: SurfaceMesh) -> float:
    """Return which share (-) of a surface's area lies on another surface, by the middles of facets; of many some."""
    near = SHARED_WITHIN * min(diagonal(mesh.points), diagonal(other.points))
    inside = (mesh.points.min(axis=0) >= other.points.min(axis=0) - near).all()
    if not (inside and (mesh.points.max(axis=0) <= other.points.max(axis=0) + near).all()):
        return 0.0
    chosen = mesh.triangles[:: max(1, len(mesh.triangles) // FACETS_LOOKED_AT)]
    middles = np.ascontiguousarray(mesh.points[chosen].mean(axis=1))
    distance, *_ = igl.point_mesh_squared_distance(middles, other.points, other.triangles.astype(np.int64))
    area = areas(mesh.points, chosen)
    return float(area[np.asarray(distance).ravel() <= near**2].sum() / area.sum())


def share_a_piece(mesh: SurfaceMesh, other: SurfaceMesh, least: float) -> bool:
    """Return whether a connected piece of a surface lies on one of the other, and that on it, by at least a share (-).

    A sheet behind a body lies on it, but the body not on the sheet.
    """
    near = SHARED_WITHIN * min(diagonal(mesh.points), diagonal(other.points))
    pieces, others = connected_pieces(mesh.triangles), connected_pieces(other.triangles)
    boxes, other_boxes = _boxes(mesh, pieces), _boxes(other, others)
    for number, box in enumerate(boxes):
        for alike in np.flatnonzero((np.abs(other_boxes - box) <= near).all(axis=1)):
            one, another = body(mesh, pieces == number), body(other, others == alike)
            if min(on_surface(one, another), on_surface(another, one)) > least:
                return True
    return False


def _boxes(mesh: SurfaceMesh, piece: np.ndarray) -> np.ndarray:
    """Return the lowest and the highest corner (pieces, 6) m of each piece; piece: (m,) of each face."""
    corners = mesh.points[mesh.triangles]
    order = np.argsort(piece, kind="stable")
    first = np.searchsorted(piece[order], np.arange(piece.max() + 1))
    return np.hstack(
        [np.minimum.reduceat(corners.min(axis=1)[order], first), np.maximum.reduceat(corners.max(axis=1)[order], first)]
    )
