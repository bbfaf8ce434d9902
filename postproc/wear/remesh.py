"""Remeshing of a worn surface where a stated bound is crossed, without any change in removed volume.

Only the bad faces and a few rings round them are touched (`postproc.wear.remesh_operations`), and of these never: the
boundary, the nodes of the holder, the curves between labels as curves. What the operations change in volume is put
back by a shift of the nodes there along their normals. Nothing comes to lie outside the old surface by more than
1 % of the target edge: a surface that grows launches particles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, centroids, worn_faces
from bulkwear.postproc.wear.face_kernels import corner_words, rows_among
from bulkwear.postproc.wear.mesh_faults import (
    DEFAULT_BOUNDS,
    TARGET_EDGE,
    Bounds,
    MeshFaults,
    mesh_faults,
    tangle_message,
    with_target_edges,
)
from bulkwear.postproc.wear.old_surface import OldSurface
from bulkwear.postproc.wear.remesh_operations import LARGEST_OUTWARD, OUTWARD_BY_OPERATIONS, Limits, improve
from bulkwear.postproc.wear.remesh_patch import rings
from bulkwear.postproc.wear.remesh_piece import piece_round
from bulkwear.postproc.wear.remesh_repair import RemeshError, badness, faults_after, untangled
from bulkwear.postproc.wear.remesh_transfer import cut_out, transferred
from bulkwear.postproc.wear.remesh_volume import lower, restore_volume, volume_gained

__all__ = ["RemeshError", "Remeshed", "remesh"]

INWARD_BY_OPERATIONS = (0.1, 0.03, 0.01)  # -, tried one after the other until the volume can be restored
UNTRUSTED_RINGS = (0, 1, 2)  # of faces round tangled ones that bound no body for certain, tried one by one
MOST_LOWERINGS = 3  # of faces that stand out a little too far after all
RINGS = (1, 2, 3, 6)  # of faces round the bad ones, one attempt each


@dataclass(frozen=True, eq=False)
class Remeshed:
    """Outcome of remeshing.

    mesh : the very mesh given when nothing was bad
    faces_changed : faces of the new mesh that are not in the old one
    volume_change_m3 : of the body, rounding only, apart from the volume advanced
    advanced_volume_m3 : removed ahead of its wear to untangle the surface; the carried volume is lower by it
    largest_outward : how far the new surface stands outside the old one, over the target edge, -;
        not counted where the old surface was tangled
    faults : what is left; never a tangle
    """

    mesh: SurfaceMesh
    faces_changed: int
    volume_change_m3: float
    advanced_volume_m3: float
    largest_outward: float
    faults: MeshFaults


def remesh(mesh: SurfaceMesh, bounds: Bounds = DEFAULT_BOUNDS, moved: np.ndarray | None = None) -> Remeshed:
    """Bring a worn surface back within the bounds as far as its volume and shape allow.

    Parameters
    ----------
    mesh : normals out of the body; point data `target_edge_m` (see `with_target_edges`), else the present edges count
    bounds : when a face is bad
    moved : (m,) bool, faces with a corner that has moved since no two faces cut one another; None: look at all

    Returns
    -------
    Remeshed. Without a bad face the mesh comes back bit for bit. Acute or long faces that cannot be helped within the
    limits of shape stay and are told in `faults`.

    Raises
    ------
    RemeshError : folds or faces that cut one another remain.
    """
    present = mesh if TARGET_EDGE in mesh.point_data else with_target_edges(mesh)
    faults = mesh_faults(present, bounds, moved)
    if not faults.faces.any():
        return Remeshed(mesh, 0, 0.0, 0.0, 0.0, faults)
    start, tangled, advanced = present, faults.tangled, 0.0
    old = OldSurface(start.points, start.triangles, faults.faces)
    for widen in (None, *UNTRUSTED_RINGS):
        if widen is not None and not faults.tangled.any():
            break
        untrusted = rings(start.triangles, tangled, widen or 0, np.ones(len(tangled), bool), len(start.points))
        old = old.without(untrusted)
        present, ahead, faults = _improved(present, faults, bounds, old, widen is not None)
        advanced += ahead
    if faults.tangled.any():
        places = centroids(present.points, present.triangles[faults.tangled])
        raise RemeshError(f"the worn surface cannot be repaired: {tangle_message(present, faults)}", places)
    changed = _changed(start, present)
    gained = volume_gained(start, present, worn_faces(start), worn_faces(present))
    reach = old.range_over_faces(present.points, present.triangles[changed], present.point_data[TARGET_EDGE])
    largest = float(reach[:, 1].max(initial=0.0))
    return Remeshed(present, int(changed.sum()), gained + advanced, advanced, largest, faults)


def _improved(mesh: SurfaceMesh, faults: MeshFaults, bounds: Bounds, old: OldSurface, repair: bool):
    """(mesh, volume worn ahead in m3, faults) after all attempts; all but the first on a piece round the bad faces."""
    counts = RINGS
    if not repair:
        mesh, faults = _attempt(mesh, faults, bounds, RINGS[0], old)
        counts = RINGS[1:]
    if not faults.faces.any():
        return mesh, 0.0, faults
    piece = piece_round(mesh, faults.faces, bounds)
    if piece is None:
        return _attempts(mesh, faults, bounds, old, repair, counts)
    new, ahead, left = _attempts(piece.mesh, piece.faults, bounds, old, repair, counts)
    if new is piece.mesh:
        return mesh, 0.0, faults
    whole = piece.put_back(new)
    fresh = np.arange(len(whole.triangles)) >= np.count_nonzero(~piece.inside)
    fresh[fresh] = _changed(piece.mesh, new)
    known = left.intersecting + np.count_nonzero(~piece.inside)
    return whole, ahead, mesh_faults(whole, bounds, fresh, known)


def _attempts(mesh: SurfaceMesh, faults: MeshFaults, bounds: Bounds, old: OldSurface, repair: bool, counts):
    """(mesh, volume worn ahead in m3, faults) after attempts on so many rings each, after repair if wanted; where that
    leaves a tangle there are no attempts, for they have had their turn before it.
    """
    ahead = 0.0
    if repair:
        mesh, ahead, faults = untangled(mesh, faults, bounds, old)
    for count in counts:
        if faults.faces.any() and not (repair and faults.tangled.any()):
            mesh, faults = _attempt(mesh, faults, bounds, count, old)
    return mesh, ahead, faults


def _attempt(mesh: SurfaceMesh, faults: MeshFaults, bounds: Bounds, count: int, old: OldSurface):
    """The mesh and its faults after an attempt on the bad faces and `count` rings; or as they were."""
    worn = worn_faces(mesh)
    core = rings(mesh.triangles, faults.faces, count, worn, len(mesh.points))
    start, left = cut_out(mesh, core), OldSurface(mesh.points, mesh.triangles[core])
    for inward in INWARD_BY_OPERATIONS:
        patch = improve(start, old, Limits(OUTWARD_BY_OPERATIONS, inward, 1.5 * bounds.smallest_angle_deg))
        raw, changed = transferred(mesh, core, patch, left)
        gained = volume_gained(mesh, raw, core, changed)
        new = restore_volume(raw, gained, changed)
        if new is None:
            continue
        new = _within(new, changed, old)
        if new is None:
            break
        remaining = faults_after(faults, raw, new, bounds, core, changed)
        if badness(remaining) < badness(faults):
            return new, remaining
        break
    return mesh, faults


def _within(mesh: SurfaceMesh, changed: np.ndarray, old: OldSurface) -> SurfaceMesh | None:
    """The mesh with the few faces `changed` (m,) that stand out too far lowered, their volume restored; None if not."""
    for _ in range(MOST_LOWERINGS):
        reach = old.range_over_faces(mesh.points, mesh.triangles[changed], mesh.point_data[TARGET_EDGE])[:, 1]
        out = reach > LARGEST_OUTWARD
        if not out.any():
            return mesh
        lowered = lower(mesh, np.flatnonzero(changed)[out], reach[out] - OUTWARD_BY_OPERATIONS, changed)
        mesh = restore_volume(lowered, volume_gained(mesh, lowered, changed, changed), changed)
        if mesh is None:
            return None
    return None


def _changed(before: SurfaceMesh, after: SurfaceMesh) -> np.ndarray:
    """Mask of the faces of the new mesh whose corners are not, bit for bit, those of a face of the old one."""
    known, new = (corner_words(mesh.points, mesh.triangles) for mesh in (before, after))
    return ~rows_among(new, known)
