"""Repair of a worn surface whose faces are folded or cut one another, by taking material away where it is too thin.

First, site by site, edges at the tangled faces are merged or flipped one at a time, always the one that leaves the
fewest tangled faces, then the least change of volume. What is still tangled is smoothed together with more and more
rings round it, nodes sinking into the body only. The volume lost that way is given back within the limits of
`restore_volume`; what cannot be is charged to the carried volume: worn ahead, paid for by the next wear there.
"""

from __future__ import annotations

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, smallest_angles, worn_faces
from bulkwear.postproc.mesh_checks import intersecting_faces
from bulkwear.postproc.wear.edge_kernels import common_neighbours
from bulkwear.postproc.wear.face_kernels import any_corner
from bulkwear.postproc.wear.mesh_faults import (
    TARGET_EDGE,
    Bounds,
    MeshFaults,
    folded_faces,
    mesh_faults,
)
from bulkwear.postproc.wear.old_surface import OldSurface
from bulkwear.postproc.wear.remesh_operations import (
    LARGEST_OUTWARD,
    OUTWARD_BY_OPERATIONS,
    Limits,
    all_fixed,
    flipped_faces,
    improve,
)
from bulkwear.postproc.wear.remesh_patch import (
    FIXED,
    Patch,
    edges_of,
    freedom,
    rings,
    six_volumes,
)
from bulkwear.postproc.wear.remesh_transfer import cut_out, transferred
from bulkwear.postproc.wear.remesh_volume import charge, restore_volume, volume_gained

MERGE_RINGS = 2  # of faces round the tangled ones that are looked at when edges are merged
MOST_MERGES = 12  # in one repair
MOST_CANDIDATES = 80  # edges tried for one merge, the shortest first
ACUTE_DEG = 5.0  # degrees; a merge that leaves such a face is a last resort
SINK_RINGS = (1, 2, 3, 5, 8)  # of faces round the tangled ones that sink, one attempt each
SINK_INWARD = 2.0  # -, over the target edge, how far sinking may cut into the body
SINK_COLLAPSE = 0.8  # -, edges over their target that are merged on the way


class RemeshError(RuntimeError):
    """The worn surface cannot be repaired; the message names the cause and the place in mm.

    places: (k, 3) m, of all faces that are at fault; None where they are not told
    """

    def __init__(self, message: str, places: np.ndarray | None = None):
        super().__init__(message)
        self.places = places


def untangled(mesh: SurfaceMesh, faults: MeshFaults, bounds: Bounds, old: OldSurface):
    """The mesh with fewer folds and cuts, if possible with none: (mesh, volume worn ahead (m3), faults)."""
    advanced, skipped = 0.0, 0
    while skipped < np.count_nonzero(faults.tangled):  # site by site: few edges to choose from, and local
        first = np.zeros(len(mesh.triangles), dtype=bool)
        first[_by_place(mesh, faults.tangled)[skipped]] = True
        site = faults.tangled & _near(mesh, first, MERGE_RINGS)
        new = _repaired(mesh, faults, bounds, old, _near(mesh, site, MERGE_RINGS), None)
        skipped += new is None
        mesh, faults, ahead = new or (mesh, faults, 0.0)
        advanced += ahead
    for count in SINK_RINGS:
        if faults.tangled.any():
            new = _repaired(mesh, faults, bounds, old, _near(mesh, faults.tangled, count), SINK_INWARD)
            mesh, faults, ahead = new or (mesh, faults, 0.0)
            advanced += ahead
    return mesh, advanced, faults


def _by_place(mesh: SurfaceMesh, faces: np.ndarray) -> np.ndarray:
    """Indices of the faces of a mask in the order of their nodes, whatever the order of the faces."""
    found = np.flatnonzero(faces)
    return found[np.lexsort(np.sort(mesh.triangles[found], axis=1).T)]


def _near(mesh: SurfaceMesh, faces: np.ndarray, count: int) -> np.ndarray:
    return rings(mesh.triangles, faces, count, worn_faces(mesh), len(mesh.points))


def _repaired(mesh: SurfaceMesh, faults: MeshFaults, bounds: Bounds, old: OldSurface, core, inward: float | None):
    """(mesh, faults, volume worn ahead in m3) after repair of the faces `core` (m,), None if no fewer are tangled.

    inward: how far nodes may sink into the body, over the target edge; None: edges are merged instead.
    """
    if not core.any():
        return None
    patch = cut_out(mesh, core)
    if inward is None:
        before, patch = patch, merged(patch, old, bounds)
        if patch is before:
            return None
    else:
        limits = Limits(OUTWARD_BY_OPERATIONS, inward, 1.5 * bounds.smallest_angle_deg, SINK_COLLAPSE)
        patch = improve(patch, old, limits, erode=True)
    raw, changed = transferred(mesh, core, patch, OldSurface(mesh.points, mesh.triangles[core]))
    new, ahead = _balanced(raw, volume_gained(mesh, raw, core, changed), changed)
    left = faults_after(faults, raw, new, bounds, core, changed)
    reach = old.range_over_faces(new.points, new.triangles[changed], new.point_data[TARGET_EDGE])[:, 1]
    better = left.tangled.sum() < faults.tangled.sum() and reach.max(initial=0.0) <= LARGEST_OUTWARD
    return (new, left, ahead) if better else None


def faults_after(
    faults: MeshFaults, raw: SurfaceMesh, mesh: SurfaceMesh, bounds: Bounds, core: np.ndarray, changed: np.ndarray
) -> MeshFaults:
    """Faults of a mesh in which the faces `core` (m,) of the old one gave way to those `changed`, see `transferred`.

    raw: the mesh before its volume was restored. Cuts are looked for at faces that changed or moved only.
    """
    outside = faults.intersecting[~core[faults.intersecting].any(axis=1)]
    number = np.cumsum(~core) - 1
    moved = (raw.points != mesh.points).any(axis=1)
    return mesh_faults(mesh, bounds, changed | any_corner(moved, mesh.triangles), number[outside])


def badness(faults: MeshFaults) -> tuple[int, int, float]:
    """What an attempt must lower: tangled faces, bad faces, minus the smallest angle."""
    return int(faults.tangled.sum()), int(faults.faces.sum()), -faults.smallest_angle_deg


def _balanced(mesh: SurfaceMesh, gained: float, changed: np.ndarray) -> tuple[SurfaceMesh, float]:
    """The mesh with its volume restored, else with the gain (m3) carried; and the volume worn ahead (m3)."""
    new = restore_volume(mesh, gained, changed)
    return (new, 0.0) if new is not None else (charge(mesh, gained, changed), -gained)


def merged(patch: Patch, old: OldSurface, bounds: Bounds) -> Patch:
    """The patch after merging or flipping edges at its tangled faces, as long as that leaves fewer of them."""
    count = int(_tangled(patch, bounds).sum())
    for _ in range(MOST_MERGES):
        if not count:
            break
        tried = [candidate for edge in _candidates(patch, bounds) for candidate in _merges(patch, *edge)]
        tried += _flips(patch, bounds)
        costs = [repair_cost(patch, candidate, old, bounds) for candidate in tried]
        best = min(range(len(tried)), key=costs.__getitem__, default=None)
        if best is None or costs[best][0] >= count:
            break
        patch, count = tried[best], int(costs[best][0])
    return patch


def _tangled(patch: Patch, bounds: Bounds) -> np.ndarray:
    """Mask (m,) of the folded faces of a patch and of those that cut one another."""
    result = folded_faces(patch.points, patch.triangles, bounds.largest_fold_deg)
    result[intersecting_faces(patch.points, patch.triangles).ravel()] = True
    return result


def _candidates(patch: Patch, bounds: Bounds) -> list[tuple[int, int, bool]]:
    """Edges near tangled faces that may be merged: (node that goes, node that stays, may it move), shortest first."""
    edges = edges_of(patch)
    kind = freedom(patch, edges)
    near = np.zeros(len(patch.points), dtype=bool)
    near[patch.triangles[_tangled(patch, bounds)]] = True
    wanted = near[edges.ends].any(axis=1) & (edges.faces[:, 1] >= 0) & (kind[edges.ends].min(axis=1) != FIXED)
    found = np.flatnonzero(wanted)
    found = found[common_neighbours(edges.ends, found, len(patch.points)) == 2]
    length = np.linalg.norm(np.diff(patch.points[edges.ends[found]], axis=1)[:, 0], axis=1)
    ends = edges.ends[found[np.argsort(length, kind="stable")[:MOST_CANDIDATES]]]
    ends = np.where((kind[ends[:, 0]] > kind[ends[:, 1]])[:, None], ends[:, ::-1], ends)
    return list(zip(*ends.T, kind[ends[:, 0]] == kind[ends[:, 1]], strict=True))


def _merges(patch: Patch, gone: int, kept: int, free: bool):
    """Yield the patch with two nodes merged: at the place of `kept`, and if that is free halfway and at `gone`."""
    both = (patch.triangles == gone).any(axis=1) & (patch.triangles == kept).any(axis=1)
    if not np.isin(np.unique(patch.label[both]), patch.label[~both]).all():
        return  # a label would vanish
    triangles = np.where(patch.triangles == gone, kept, patch.triangles)[~both]
    for part in (0.0, 0.5, 1.0) if free else (0.0,):
        points = patch.points.copy()
        points[kept] += part * (points[gone] - points[kept])
        yield patch.changed(points=points, triangles=triangles, label=patch.label[~both])


def _flips(patch: Patch, bounds: Bounds) -> list[Patch]:
    """The patches with one edge of a tangled face flipped."""
    edges = edges_of(patch)
    found = np.flatnonzero(_tangled(patch, bounds)[edges.faces].any(axis=1))
    quads, allowed = flipped_faces(patch, edges, found)
    result = []
    for edge, faces in zip(found[allowed][:MOST_CANDIDATES], quads[allowed], strict=False):
        triangles = patch.triangles.copy()
        triangles[edges.faces[edge]] = faces
        result.append(patch.changed(triangles=triangles))
    return result


def repair_cost(before: Patch, after: Patch, old: OldSurface, bounds: Bounds) -> tuple[float, bool, float]:
    """(tangled faces, is one very acute, change of volume in m3); infinite where it stands outside the old surface, or
    has one more face that nothing can mend.
    """
    if all_fixed(after).sum() > all_fixed(before).sum():
        return np.inf, True, np.inf
    if old.range_over_faces(after.points, after.triangles, after.size)[:, 1].max(initial=0.0) > OUTWARD_BY_OPERATIONS:
        return np.inf, True, np.inf
    origin = before.points[0]
    change = six_volumes(after.points, after.triangles, origin).sum()
    change -= six_volumes(before.points, before.triangles, origin).sum()
    count = float(_tangled(after, bounds).sum())
    acute = bool(smallest_angles(after.points, after.triangles).min() < ACUTE_DEG)
    return count, acute, abs(float(change))
