"""Refuse what cannot be mended, with its place; tell which parts cut or touch one another."""

from __future__ import annotations

import numpy as np

from bulkwear.meshes.own.orient import one_sided_edges
from bulkwear.meshes.own.repairs import Repairs
from bulkwear.meshes.own.solids import RefusedMeshError, Solids, place_text
from bulkwear.meshes.own.weld import nodes_at_open_edges
from bulkwear.postproc.mesh import SurfaceMesh, centroids, directed_edges, edge_lengths_per_triangle, smallest_angles
from bulkwear.postproc.mesh_checks import LEAST_SOLVER_ANGLE, intersecting_faces, overlapping_faces

GAP = 10.0  # -, over the weld tolerance: open edges and nodes closer than that are a gap that should be none
SOLVER_PRECISION = 1e-8  # m; LIGGGHTS takes nodes that are closer for one
EDGES_APART = 10.0  # -, over the solver's precision: the shortest edge that stays one


def refusal(
    solids: Solids, faces: np.ndarray, place: np.ndarray, said: str, allowed: str, unit: str
) -> RefusedMeshError:
    """The error for faces (k,) at fault, the first of them at a place (3,) m: what was found, and what is allowed."""
    name = solids.names[solids.part[faces[0]]]
    surface = SurfaceMesh(solids.points, solids.triangles, {"part": solids.part})
    return RefusedMeshError(
        f"{solids.source}: part '{name}' {said} at {place_text(place, unit)}; allowed {allowed}", surface, faces, place
    )


def check_gaps(solids: Solids, tolerance: float, unit: str) -> None:
    """Raise `RefusedMeshError` where a node lies beside an open edge of its part, by more than is mended, but hardly.

    Nodes must belong to one part each: before parts are joined.
    """
    corner, node, _, distance = nodes_at_open_edges(solids, GAP * tolerance)
    if len(corner):
        first = int(np.argmin(distance))
        raise refusal(
            solids,
            np.unique(corner // 3),
            solids.points[node[first]],
            f"has {len(corner)} nodes beside open edges that they miss, the nearest by {1e3 * distance[first]:.3g} mm,",
            f"are nodes within the weld tolerance of {1e3 * tolerance:.3g} mm, which may be set larger",
            unit,
        )


def check_manifold(solids: Solids, unit: str) -> None:
    """Raise `RefusedMeshError` where three or more triangles have one edge, or a piece has one side only."""
    edges = np.sort(directed_edges(solids.triangles), axis=1)
    _, inverse, counts = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    inverse = inverse.reshape(-1)
    faulty = np.flatnonzero(counts[inverse] > 2)
    if len(faulty):
        place = solids.points[edges[faulty[0]]].mean(axis=0)
        said = f"has {np.count_nonzero(counts > 2)} edges with three or more faces ({counts.max()} at most), the first"
        allowed = "are one or two: make each body or sheet a part of its own, or unite them in CAD"
        raise refusal(solids, np.unique(faulty // 3), place, said, allowed, unit)
    twisted = one_sided_edges(solids.triangles)
    if len(twisted):
        faces = np.unique(np.flatnonzero((edges[:, None] == twisted[None, :1]).all(axis=2).any(axis=1)) // 3)
        place = solids.points[twisted[0]].mean(axis=0)
        said = "has a piece with one side only, like a Moebius strip, whose winding breaks"
        raise refusal(solids, faces, place, said, "are pieces with two sides", unit)


def check_cuts(solids: Solids, tolerance: float, unit: str, repairs: Repairs) -> None:
    """Raise `RefusedMeshError` where a part cuts or covers itself; tell where two parts do."""
    for search, itself, other in (
        (intersecting_faces, "cuts itself, faces pass through one another", "cuts"),
        (overlapping_faces, "covers itself, faces lie on one another", "touches with its faces"),
    ):
        pairs = search(solids.points, solids.triangles, clearance_m=tolerance)
        middle = solids.points[solids.triangles[pairs]].mean(axis=(1, 2))
        part = np.sort(solids.part[pairs], axis=1)
        own = np.flatnonzero(part[:, 0] == part[:, 1])
        if len(own):
            said = f"{itself}, {len(own)} pairs, the first"
            allowed = "are faces that meet at common edges and nodes only"
            raise refusal(solids, np.unique(pairs[own]), middle[own[0]], said, allowed, unit)
        for second in np.unique(part[:, 1]):
            mine = part[:, 1] == second
            repairs.add(f"warning: {other} part '{solids.names[second]}', pairs of faces", part[mine, 0], middle[mine])


def sharp_faces(solids: Solids) -> np.ndarray:
    """Faces (k,) with an angle that the solver refuses, the sharpest first."""
    angle = smallest_angles(solids.points, solids.triangles)
    sharp = np.flatnonzero(angle <= LEAST_SOLVER_ANGLE)
    return sharp[np.argsort(angle[sharp], kind="stable")]


def check_for_solver(solids: Solids, tolerance: float, unit: str) -> None:
    """Raise `RefusedMeshError` where LIGGGHTS would refuse or drop a triangle: too sharp, or edges too short."""
    sharp = sharp_faces(solids)
    if len(sharp):
        sharpest = solids.triangles[sharp[:1]]
        angle, place = smallest_angles(solids.points, sharpest)[0], centroids(solids.points, sharpest)[0]
        said = f"has {len(sharp)} faces that are too sharp for the solver, the sharpest of {angle:.2g} degrees"
        wider = f"a weld tolerance above {1e3 * tolerance:.3g} mm"
        allowed = f"are angles above {LEAST_SOLVER_ANGLE} degrees: give a target edge, or {wider}"
        raise refusal(solids, sharp, place, said, allowed, unit)
    shortest = edge_lengths_per_triangle(solids.points, solids.triangles).min(axis=1)
    at = int(np.argmin(shortest))
    if shortest[at] < EDGES_APART * SOLVER_PRECISION:
        place = centroids(solids.points, solids.triangles[[at]])[0]
        said = f"has an edge of {shortest[at]:.2g} m, which the solver may take for none,"
        raise refusal(solids, np.array([at]), place, said, f"are {EDGES_APART * SOLVER_PRECISION:g} m or more", unit)
