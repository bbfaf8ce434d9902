"""A patch cut out of a worn surface: its triangles, edges and stars."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bulkwear.postproc.wear.edge_kernels import edge_table, on_border, sorted_edges
from bulkwear.postproc.wear.face_kernels import any_corner
from bulkwear.postproc.wear.remesh_kernels import opposite_areas

INNER, CURVE, FIXED = 0, 1, 2  # freedom of a node: anywhere, along the curve between two labels, nowhere


@dataclass(frozen=True, eq=False)
class Patch:
    """Part of a surface, with its own node indices.

    points (n, 3) m; triangles (m, 3); label (m,) int, one number per combination of labels;
    size (n,) m, target edge; fixed (n,) bool, nodes that keep their place: all on the patch's border; origin (n,)
    node of the whole surface, -1 for new ones.
    """

    points: np.ndarray
    triangles: np.ndarray
    label: np.ndarray
    size: np.ndarray
    fixed: np.ndarray
    origin: np.ndarray

    def changed(self, **parts: np.ndarray) -> Patch:
        """A copy with other arrays."""
        return replace(self, **parts)


@dataclass(frozen=True, eq=False)
class Edges:
    """Undirected edges of a patch.

    ends (e, 2): the first of the two faces runs from the first end to the second; faces (e, 2), opposite (e, 2): the
    two faces and their third nodes, -1 on the border; curve (e,): between two labels.
    """

    ends: np.ndarray
    faces: np.ndarray
    opposite: np.ndarray
    curve: np.ndarray


def edges_of(patch: Patch) -> Edges:
    """Edges of the patch in the order of their node indices."""
    in_order = sorted_edges(patch.triangles, len(patch.points), True)
    ends, faces, opposite = edge_table(patch.triangles, *in_order)
    curve = (faces[:, 1] >= 0) & (patch.label[faces[:, 0]] != patch.label[faces[:, 1]])
    return Edges(ends, faces, opposite, curve)


def freedom(patch: Patch, edges: Edges) -> np.ndarray:
    """INNER, CURVE or FIXED for each node, (n,); where curves branch or end a node is fixed."""
    degree = np.bincount(edges.ends[edges.curve].ravel(), minlength=len(patch.points))
    result = np.where(degree == 0, INNER, np.where(degree == 2, CURVE, FIXED))
    result[patch.fixed] = FIXED
    return result


def lowest_beside(rank: np.ndarray, edges: Edges) -> np.ndarray:
    """Lowest rank among the neighbours of each node, (n,)."""
    result = np.full(len(rank), np.inf)
    np.minimum.at(result, edges.ends[:, 0], rank[edges.ends[:, 1]])
    np.minimum.at(result, edges.ends[:, 1], rank[edges.ends[:, 0]])
    return result


def six_volumes(points: np.ndarray, triangles: np.ndarray, origin: np.ndarray) -> np.ndarray:
    """Six times the signed volume between each triangle and `origin`, (m,) m3."""
    first = triangles[:, 0].copy()
    across = opposite_areas(points, triangles, first, np.full((len(triangles), 3), origin))
    return np.einsum("ij,ij->i", points[first] - origin, across)


def rings(triangles: np.ndarray, faces: np.ndarray, count: int, allowed: np.ndarray, n_points: int) -> np.ndarray:
    """Mask (m,) of the faces within `count` rings of nodes round the mask `faces`, among the mask `allowed`."""
    mask = faces & allowed
    for _ in range(count):
        near = np.zeros(n_points, dtype=bool)
        near[triangles[mask]] = True
        mask = any_corner(near, triangles) & allowed
    return mask


def barycentric(places: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Weights (k, 3) of the corners (k, 3, 3) at places on their triangles: >= 0, sum 1."""
    spokes = corners - places[:, None]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    parts = np.cross(np.roll(spokes, -1, axis=1), np.roll(spokes, -2, axis=1))
    weight = np.maximum((parts * normal[:, None]).sum(axis=2), 0.0)
    total = weight.sum(axis=1, keepdims=True)
    return np.divide(weight, total, out=np.full_like(weight, 1.0 / 3.0), where=total > 0.0)


def border_nodes(triangles: np.ndarray) -> np.ndarray:
    """Sorted nodes on edges of a single triangle, (k,): as `boundary_nodes`, much faster."""
    count = triangles.max(initial=-1) + 1
    return np.flatnonzero(on_border(triangles, *sorted_edges(triangles, count, False), count))


def neighbours(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of faces that share an edge, (k, 2), and the corner of each that lies opposite to it, (k, 2)."""
    held, new = sorted_edges(triangles, triangles.max(initial=-1) + 1, False)
    same = np.flatnonzero(~new[1:-1])
    both = np.column_stack([held[same], held[same + 1]])
    return both // 3, (both % 3 + 2) % 3
