"""Depth fields of a worn surface against its pristine one; all are >= 0 m, 0 where nothing was removed.

* removed thickness: length of the path of a node, summed over the updates. Follows the node; always defined.
* height loss: vertical distance from the present node up to the pristine surface right above it, that is the
  difference of the two height maps at the node's present place. Chosen over the difference in z of one node
  because nodes on flanks also move sideways: contours of the worn and the pristine surface then subtract
  exactly.
* ray depth: distance from the present node along its outward normal to the pristine surface. The thickness
  that a gauge held square to the worn surface would read.
* normal depth: distance from the present node along the normal of the pristine surface to that surface, or to its
  nearest place where there is none along it.

NaN says undefined: no pristine surface above, or none within `LARGEST_RAY_OVER_THICKNESS` removed
thicknesses.
"""

from __future__ import annotations

from itertools import chain, pairwise

import igl
import numpy as np
from scipy.spatial import cKDTree

from bulkwear.postproc.mesh import centroids, unit_normals

LARGEST_RAY_OVER_THICKNESS = 2.0  # -, present and pristine normals then differ by 60 degrees
OUTSIDE_TOLERANCE = 0.01  # -, of a triangle's edge: a remeshed node may lie that far outside, depth 0
EDGE_TOLERANCE = 1e-9  # -, barycentric: a ray through an edge or a corner must not slip between the triangles
LARGEST_PAIR_BLOCK = 100_000  # pairs of ray and triangle handled at once: bounds the memory at some 50 MB
SIZE_CLASS_RATIO = 2.0  # -, triangles are searched in classes of alike size, so few candidates are far away


def add_removed_thickness(removed_thickness: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Removed thickness (n,) m after an update: the one before plus the step (n,) m along the node's path."""
    return removed_thickness + step


def height_loss(points: np.ndarray, pristine_points: np.ndarray, pristine_triangles: np.ndarray) -> np.ndarray:
    """Vertical distance (k,) m from each point up to the pristine surface above it, NaN where there is none.

    Parameters: points (k, 3) m; pristine_points (n, 3) m; pristine_triangles (m, 3).
    """
    flat = pristine_points * (1.0, 1.0, 0.0)
    up = np.broadcast_to((0.0, 0.0, 1.0), points.shape)
    at = points * (1.0, 1.0, 0.0)
    classes = _size_classes(flat, pristine_triangles)
    return _along_rays(points, up, pristine_points, pristine_triangles, at, classes, 0.0, np.inf)[0]


def ray_depth(
    points: np.ndarray,
    outward: np.ndarray,
    removed_thickness: np.ndarray,
    pristine_points: np.ndarray,
    pristine_triangles: np.ndarray,
) -> np.ndarray:
    """Distance (k,) m from each point along its outward normal to the pristine surface, NaN where undefined.

    Parameters: points (k, 3) m; outward (k, 3) unit vectors; removed_thickness (k,) m, bounds the length of
    the ray by `LARGEST_RAY_OVER_THICKNESS` times it; pristine_points (n, 3) m; pristine_triangles (m, 3).
    """
    old = pristine_points, pristine_triangles
    return _to_pristine(points, outward, removed_thickness, *old, _size_classes(*old))[0]


def pristine_normal_depth(
    points: np.ndarray,
    outward: np.ndarray,
    removed_thickness: np.ndarray,
    pristine_points: np.ndarray,
    pristine_triangles: np.ndarray,
) -> np.ndarray:
    """Distance (k,) m from each point along the pristine surface's normal to that surface.

    Parameters as in `ray_depth`. The normal is that of the pristine face which the ray of `ray_depth` meets. Where
    either meets none, as at rims and in corners, it is the distance to the nearest place of the pristine surface.
    """
    return ray_and_normal_depth(points, outward, removed_thickness, pristine_points, pristine_triangles)[1]


def ray_and_normal_depth(
    points: np.ndarray,
    outward: np.ndarray,
    removed_thickness: np.ndarray,
    pristine_points: np.ndarray,
    pristine_triangles: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Both `ray_depth` and `pristine_normal_depth`, (k,) m each: they share the search along the outward normals."""
    old = pristine_points, pristine_triangles
    classes = _size_classes(*old)
    along, face = _to_pristine(points, outward, removed_thickness, *old, classes)
    found = np.flatnonzero(face >= 0)
    normal = unit_normals(pristine_points, pristine_triangles[face[found]])
    result = np.full(len(points), np.nan)
    result[found] = _to_pristine(points[found], normal, removed_thickness[found], *old, classes)[0]
    if (missing := np.flatnonzero(np.isnan(result))).size:
        at, surface = np.ascontiguousarray(points[missing]), map(np.ascontiguousarray, old)
        result[missing] = np.sqrt(igl.point_mesh_squared_distance(at, *surface)[0])
    return along, result


def _to_pristine(points, directions, removed_thickness, pristine_points, pristine_triangles, classes):
    """Distance (k,) m along each direction to the pristine surface, and the face (k,) there; NaN and -1 where none."""
    reach = LARGEST_RAY_OVER_THICKNESS * removed_thickness
    middle = points + 0.5 * reach[:, None] * directions
    return _along_rays(points, directions, pristine_points, pristine_triangles, middle, classes, 0.5 * reach, reach)


def _along_rays(origins, directions, points, triangles, search_at, classes, radius, reach):
    """Distance (k,) m to the nearest hit of each ray, 0 <= t <= reach, and its triangle (k,); NaN and -1 where none.

    Candidates are the triangles that may come within `radius` of `search_at`, both in the space of `classes`, see
    `_size_classes` (projected on the ground for vertical rays, so that any height difference is found).
    """
    radius, reach = np.broadcast_to(radius, len(origins)), np.broadcast_to(reach, len(origins))
    nearest, nearest_face = np.full(len(origins), np.inf), np.full(len(origins), -1)
    for members, tree, size in classes:
        counts = tree.query_ball_point(search_at, radius + size, return_length=True)
        for block in _blocks(counts):
            found = tree.query_ball_point(search_at[block], radius[block] + size)
            ray = np.repeat(np.arange(block.start, block.stop), counts[block])
            face = members[np.fromiter(chain.from_iterable(found), dtype=np.int64, count=len(ray))]
            distance = _ray_triangle(origins[ray], directions[ray], points[triangles[face]])
            distance[distance > reach[ray]] = np.inf
            np.minimum.at(nearest, ray, distance)
            best = np.isfinite(distance) & (distance == nearest[ray])
            nearest_face[ray[best]] = face[best]
    return np.where(nearest_face >= 0, nearest, np.nan), nearest_face


def _blocks(counts: np.ndarray) -> list[slice]:
    """Consecutive slices of the rays: at most `LARGEST_PAIR_BLOCK` candidates besides those of the first."""
    group = np.cumsum(counts) // LARGEST_PAIR_BLOCK
    limits = [*np.flatnonzero(np.diff(group, prepend=-1)).tolist(), len(counts)]
    return [slice(start, stop) for start, stop in pairwise(limits)]


def _size_classes(points: np.ndarray, triangles: np.ndarray) -> list[tuple[np.ndarray, cKDTree, float]]:
    """Member triangles, tree of their centroids, largest centroid-to-corner distance of each class of alike size."""
    centre = centroids(points, triangles)
    size = np.zeros(len(triangles))
    for k in range(3):
        np.maximum(size, np.linalg.norm(points[triangles[:, k]] - centre, axis=1), out=size)
    exponent = np.floor(np.log(np.maximum(size, np.finfo(float).tiny)) / np.log(SIZE_CLASS_RATIO))
    classes = []
    for value in np.unique(exponent):
        members = np.flatnonzero(exponent == value)
        classes.append((members, cKDTree(centre[members]), (1.0 + EDGE_TOLERANCE) * size[members].max()))
    return classes


def _ray_triangle(origins: np.ndarray, directions: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Distance (p,) along each ray to its triangle (p, 3, 3): inf where missed or behind, 0 just behind.

    Source: T. Moeller and B. Trumbore, J. Graphics Tools 2 (1997) 21.
    """
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    offset = origins - corners[:, 0]
    p, q = np.cross(directions, second), np.cross(offset, first)
    determinant = np.einsum("ij,ij->i", first, p)
    scale = np.divide(1.0, determinant, out=np.full(len(p), np.nan), where=determinant != 0.0)
    u = np.einsum("ij,ij->i", offset, p) * scale
    v = np.einsum("ij,ij->i", directions, q) * scale
    distance = np.einsum("ij,ij->i", second, q) * scale
    longest = np.sqrt(np.maximum((first**2).sum(axis=1), (second**2).sum(axis=1)))
    inside = (u >= -EDGE_TOLERANCE) & (v >= -EDGE_TOLERANCE) & (u + v <= 1.0 + EDGE_TOLERANCE)
    return np.where(inside & (distance >= -OUTSIDE_TOLERANCE * longest), np.maximum(distance, 0.0), np.inf)
