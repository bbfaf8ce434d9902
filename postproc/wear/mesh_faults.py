"""What is wrong with a worn surface: stated bounds on its triangles, folds, and faces that cut one another.

* angle: smallest interior angle of a face; aspect: longest edge over smallest altitude (1.15 when equilateral);
* edge: length over the target, the mean target of its two nodes (`TARGET_EDGE`, kept with the mesh);
* folded: the normals of two faces at an edge differ by more than `Bounds.largest_fold_deg`, or a face has no area;
* intersecting: an edge of one face passes through another face that it does not touch by a shared node.

Faces of the holder never wear: they count in the search for folds and intersections, not in the other bounds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bulkwear.postproc.mesh import (
    SurfaceMesh,
    area_vectors,
    edge_lengths_per_triangle,
    sum_over_nodes,
    worn_faces,
)
from bulkwear.postproc.mesh_checks import intersecting_faces
from bulkwear.postproc.wear.edge_kernels import sorted_edges
from bulkwear.postproc.wear.face_kernels import face_measures, folds
from bulkwear.postproc.wear.remesh_patch import border_nodes

TARGET_EDGE = "target_edge_m"  # point data: edge length that the mesh should have at a node
METRES_TO_MM = 1e3


@dataclass(frozen=True)
class Bounds:
    """When a face counts as bad.

    smallest_angle_deg: degrees; largest_aspect: longest edge over smallest altitude; smallest_edge and largest_edge:
    over the target edge; largest_fold_deg: between the normals of two faces at an edge, degrees. Raises ValueError
    when no triangle could be good.
    """

    smallest_angle_deg: float = 15.0
    largest_aspect: float = 10.0
    smallest_edge: float = 0.3
    largest_edge: float = 2.5
    largest_fold_deg: float = 165.0

    def __post_init__(self) -> None:
        for name, low, high in (
            ("smallest_angle_deg", 0.0, 30.0),
            ("largest_aspect", 3.0, np.inf),
            ("smallest_edge", 0.0, 0.5),
            ("largest_edge", 2.0, np.inf),
            ("largest_fold_deg", 90.0, 180.0),
        ):
            value = getattr(self, name)
            if not low <= value <= high:
                raise ValueError(f"bound {name} is {value}, allowed is {low} <= value <= {high}")


DEFAULT_BOUNDS = Bounds()


@dataclass(frozen=True, eq=False)
class MeshFaults:
    """Faults of a surface; masks are (m,) bool over its faces.

    smallest_angle_deg, largest_aspect, smallest_edge, largest_edge: worst of the worn faces, units as in `Bounds`;
    acute, stretched, edges: faces beyond the bounds of angle, aspect and edge length; folded: faces at an edge folded
    too far, or without area; intersecting: (p, 2) pairs of faces that cut one another.
    """

    smallest_angle_deg: float
    largest_aspect: float
    smallest_edge: float
    largest_edge: float
    acute: np.ndarray
    stretched: np.ndarray
    edges: np.ndarray
    folded: np.ndarray
    intersecting: np.ndarray

    @property
    def tangled(self) -> np.ndarray:
        """Faces (m,) that no solver may see: folded or intersecting."""
        mask = self.folded.copy()
        mask[self.intersecting.ravel()] = True
        return mask

    @property
    def faces(self) -> np.ndarray:
        """All bad faces, (m,)."""
        return self.acute | self.stretched | self.edges | self.tangled


def with_target_edges(mesh: SurfaceMesh, target_edge_m: float | np.ndarray | None = None) -> SurfaceMesh:
    """The mesh with its target edge as point data, which remeshing hands on.

    target_edge_m: scalar or (n,) m; None: the mean length of the edges that meet at each node now. Call it once, on
    the pristine mesh. Raises ValueError when a target is not above 0.
    """
    if target_edge_m is None:
        lengths = edge_lengths_per_triangle(mesh.points, mesh.triangles)
        at_corner = 0.5 * (lengths + np.roll(lengths, 1, axis=1))  # edges 0-1 and 2-0 meet in corner 0
        total, count = (
            np.bincount(mesh.triangles.ravel(), weights=values.ravel(), minlength=len(mesh.points))
            for values in (at_corner, np.ones_like(at_corner))
        )
        target_edge_m = np.where(count > 0, total / np.maximum(count, 1), lengths.mean())
    target = np.broadcast_to(np.asarray(target_edge_m, dtype=np.float64), len(mesh.points)).copy()
    if not (target > 0.0).all():
        raise ValueError(f"the target edge is {target.min()} m somewhere, allowed is a length above 0")
    return SurfaceMesh(mesh.points, mesh.triangles, mesh.cell_data, mesh.point_data | {TARGET_EDGE: target})


def mesh_faults(
    mesh: SurfaceMesh,
    bounds: Bounds = DEFAULT_BOUNDS,
    among: np.ndarray | None = None,
    known: np.ndarray | None = None,
) -> MeshFaults:
    """Faults of a surface against the bounds; without target edges (`with_target_edges`) edges are never bad.

    Pairs of faces that cut one another are looked for `among` (m,) bool only, if given, and taken over from `known`
    (p, 2) elsewhere.
    """
    points, triangles = mesh.points, mesh.triangles
    worn = worn_faces(mesh)
    angle, lengths, longest, area = face_measures(points, triangles)
    aspect = _aspects(longest, area)
    relative = edges_over_target(mesh, lengths)
    within = ((relative >= bounds.smallest_edge) & (relative <= bounds.largest_edge)).T
    edge = worn & ~(within[0] & within[1] & within[2])
    return MeshFaults(
        float(angle[worn].min(initial=60.0)),
        float(aspect[worn].max(initial=0.0)),
        float(relative[worn].min(initial=1.0)),
        float(relative[worn].max(initial=1.0)),
        worn & (angle < bounds.smallest_angle_deg),
        worn & (aspect > bounds.largest_aspect),
        edge,
        folded_faces(points, triangles, bounds.largest_fold_deg),
        _cuts(points, triangles, among, known),
    )


def _cuts(points, triangles, among, known) -> np.ndarray:
    """Pairs of faces that cut one another, found `among` (None: all) or `known` before."""
    found = intersecting_faces(points, triangles, among)
    return found if known is None else np.unique(np.concatenate([found, known]), axis=0)


def tangle_message(mesh: SurfaceMesh, faults: MeshFaults) -> str:
    """One phrase: cause and place (mm) of the first tangled face, and how many there are."""
    count = np.count_nonzero(faults.tangled)
    if len(faults.intersecting):
        first, second = faults.intersecting[0]
        cause = f"faces {first} and {second} of the worn surface cut one another"
    else:
        first = int(np.argmax(faults.folded))
        cause = f"face {first} of the worn surface is folded over or has no area"
    place = ", ".join(f"{value:.4g}" for value in METRES_TO_MM * mesh.points[mesh.triangles[first]].mean(axis=0))
    return f"{cause} at ({place}) mm; {count} such faces"


def _aspects(longest: np.ndarray, area: np.ndarray) -> np.ndarray:
    """Longest edge over smallest altitude (m,), - of faces with these longest edges (m,) m and areas (m,) m2."""
    return np.divide(longest**2, 2.0 * area, out=np.full(len(area), np.inf), where=area > 0.0)


def edges_over_target(mesh: SurfaceMesh, lengths: np.ndarray) -> np.ndarray:
    """Lengths (m, 3) m of the edges 0-1, 1-2, 2-0 over their target, (m, 3) -; ones where the mesh has no targets.

    Edges whose length remeshing may not change, those between two boundary nodes of the worn faces, count as 1.
    """
    if TARGET_EDGE not in mesh.point_data:
        return np.ones((len(mesh.triangles), 3))
    target = np.asarray(mesh.point_data[TARGET_EDGE])[mesh.triangles]
    kept = np.zeros(len(mesh.points), dtype=bool)
    kept[border_nodes(mesh.triangles[worn_faces(mesh)])] = True
    at_corner = kept[mesh.triangles]
    return np.where(
        at_corner & np.roll(at_corner, -1, axis=1), 1.0, 2.0 * lengths / (target + np.roll(target, -1, axis=1))
    )


def folded_faces(points: np.ndarray, triangles: np.ndarray, largest_fold_deg: float) -> np.ndarray:
    """Mask (m,) of faces at an edge whose two normals differ by more than that many degrees, or of no area."""
    edges = sorted_edges(triangles, len(points), False)
    return folds(points, triangles, *edges, np.cos(np.radians(largest_fold_deg)))


def node_normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Outward unit normal (n, 3) at each node, area-weighted; zero where the normals cancel."""
    vectors = sum_over_nodes(triangles, area_vectors(points, triangles), len(points))
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0.0)
