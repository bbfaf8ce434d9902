"""Better triangles on a smooth surface: nodes drift to the middle of their patch, edges flip to Delaunay."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bulkwear.postproc.mesh import area_vectors, areas, centroids, directed_edges, sum_over_nodes

FLIP_THRESHOLD = 1e-6  # rad above pi that the two opposite angles must exceed: ties do not flip for ever


def relax(
    points: np.ndarray,
    triangles: np.ndarray,
    fixed: np.ndarray,
    project: Callable[[np.ndarray], np.ndarray],
    sweeps: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Improve the angles of a triangulation (points (n, 3), triangles (m, 3)) of a smooth surface.

    Each sweep flips the edges that violate Delaunay's condition, moves every node that is not `fixed` (n,)
    to the centroid of the triangles round it and puts it back on the surface by `project`: Lloyd's iteration
    (Du, Faber and Gunzburger, SIAM Review 41, 1999) with that patch in place of the Voronoi cell. Nodes keep
    their number and order.
    """
    fixed = fixed[:, None]
    for _ in range(sweeps):
        triangles = flip_to_delaunay(points, triangles)
        area = areas(points, triangles)
        moments = sum_over_nodes(triangles, area[:, None] * centroids(points, triangles), len(points))
        middle = moments / sum_over_nodes(triangles, area, len(points))[:, None]
        points = np.where(fixed, points, project(middle))
    return points, flip_to_delaunay(points, triangles)


def flip_to_delaunay(points: np.ndarray, triangles: np.ndarray, passes: int = 20) -> np.ndarray:
    """Flip edges whose two opposite angles sum to more than pi until none is left, at most `passes` times."""
    for _ in range(passes):
        flipped = _flip_once(points, triangles)
        if flipped is None:
            break
        triangles = flipped
    return triangles


def _flip_once(points: np.ndarray, triangles: np.ndarray) -> np.ndarray | None:
    """Flip an independent set of faulty edges, the worst of each neighbourhood; None when there is none."""
    edge, twin = _interior_edges(triangles, len(points))
    start, end = directed_edges(triangles)[edge].T
    apex, other = np.roll(triangles, -2, axis=1).ravel()[[edge, twin]]
    excess = _angle(points, apex, start, end) + _angle(points, other, start, end) - np.pi
    left = np.stack([start, other, apex], axis=1)
    right = np.stack([other, end, apex], axis=1)
    mean_normal = area_vectors(points, triangles)[[edge // 3, twin // 3]].sum(axis=0)
    upright = [(area_vectors(points, new) * mean_normal).sum(axis=1) > 0 for new in (left, right)]
    known = np.isin(_key(apex, other, len(points)), _key(start, end, len(points)))
    excess[~(upright[0] & upright[1]) | known] = -np.inf
    worst = np.full(len(triangles), FLIP_THRESHOLD)
    rank = np.where(excess > FLIP_THRESHOLD, excess, -np.inf)
    np.maximum.at(worst, edge // 3, rank)
    np.maximum.at(worst, twin // 3, rank)
    chosen = np.flatnonzero((rank == worst[edge // 3]) & (rank == worst[twin // 3]))
    chosen = _without_ties(chosen, edge // 3, twin // 3)
    if not chosen.size:
        return None
    triangles = triangles.copy()
    triangles[edge[chosen] // 3], triangles[twin[chosen] // 3] = left[chosen], right[chosen]
    return triangles


def _interior_edges(triangles: np.ndarray, n_points: int) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the half-edges with start < end that have a twin, and of their twins."""
    start, end = directed_edges(triangles).T
    forward = np.flatnonzero(start < end)
    backward = np.flatnonzero(start > end)
    keys = [start[forward] * n_points + end[forward], end[backward] * n_points + start[backward]]
    _, at, twin_at = np.intersect1d(*keys, assume_unique=True, return_indices=True)
    return forward[at], backward[twin_at]


def _key(first: np.ndarray, second: np.ndarray, n_points: int) -> np.ndarray:
    return np.minimum(first, second) * n_points + np.maximum(first, second)


def _angle(points: np.ndarray, at: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Angle at node `at` between two others, rad."""
    one, two = points[first] - points[at], points[second] - points[at]
    return np.arctan2(np.linalg.norm(np.cross(one, two), axis=1), (one * two).sum(axis=1))


def _without_ties(chosen: np.ndarray, triangle: np.ndarray, neighbour: np.ndarray) -> np.ndarray:
    """Those of the chosen edges that share no triangle with another chosen edge of a lower number."""
    pairs = np.stack([triangle[chosen], neighbour[chosen]], axis=1).ravel()
    _, first = np.unique(pairs, return_index=True)
    is_first = np.zeros(len(pairs), dtype=bool)
    is_first[first] = True
    return chosen[is_first.reshape(-1, 2).all(axis=1)]
