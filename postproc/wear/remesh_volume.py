"""The volume that remeshing must not change: measured on the faces alone, restored by a shift along the normals."""

from __future__ import annotations

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, areas, node_area_vectors, worn_faces
from bulkwear.postproc.wear.fields import CARRIED_VOLUME
from bulkwear.postproc.wear.mesh_faults import TARGET_EDGE, node_normals
from bulkwear.postproc.wear.remesh_patch import border_nodes, rings, six_volumes
from bulkwear.postproc.wear.remesh_transfer import labels_at_nodes

MARGIN_RINGS = (1, 3, 8, 20, 60, 200)  # round what changed, tried one after the other
LARGEST_OUTWARD_SHIFT = 0.0015  # -, over the target edge
LARGEST_INWARD_SHIFT = 0.05  # -, over the target edge
MOST_STEPS = 30  # of Newton's method; a cubic as good as straight takes three


def volume_gained(before: SurfaceMesh, after: SurfaceMesh, left: np.ndarray, put: np.ndarray) -> float:
    """Volume (m3) that a body gained when the faces `left` (m,) gave way to the faces `put` of the new surface."""
    origin = before.points.mean(axis=0)
    new = six_volumes(after.points, after.triangles[put], origin).sum()
    return float((new - six_volumes(before.points, before.triangles[left], origin).sum()) / 6.0)


def restore_volume(mesh: SurfaceMesh, gained: float, changed: np.ndarray) -> SurfaceMesh | None:
    """Shift nodes along their normals until the body has lost the volume `gained` (m3) again.

    The nodes of the faces `changed` (m,) and of a margin round them move, each by the same part of its target edge;
    not the holder, the boundary, nor nodes between two labels. None when that part would be above its limit.
    """
    if gained == 0.0:
        return mesh
    worn, limit = worn_faces(mesh), LARGEST_INWARD_SHIFT if gained > 0.0 else LARGEST_OUTWARD_SHIFT
    movable = _movable(mesh, worn)
    normals = node_normals(mesh.points, mesh.triangles)
    for count in MARGIN_RINGS:
        region = rings(mesh.triangles, changed, count, worn, len(mesh.points))
        inner = np.zeros(len(mesh.points), dtype=bool)
        inner[mesh.triangles[region]] = True
        inner[mesh.triangles[~region]] = False
        weight = np.where(inner & movable, mesh.point_data[TARGET_EDGE], 0.0)
        area = np.einsum("ij,ij->i", node_area_vectors(mesh.points, mesh.triangles), normals) @ weight
        if area * limit > abs(gained):
            points = _shifted(mesh.points, mesh.triangles[region], weight[:, None] * normals, gained, area)
            return SurfaceMesh(points, mesh.triangles, mesh.cell_data, mesh.point_data)
        if region.all() or np.array_equal(region, worn):
            break
    return None


def lower(mesh: SurfaceMesh, faces: np.ndarray, depth: np.ndarray, changed: np.ndarray) -> SurfaceMesh:
    """The mesh with nodes of some faces (k,) moved inward by a depth (k,), over the target edge.

    Nodes that other faces than those `changed` (m,) touch stay, like those that `restore_volume` does not move.
    """
    part = np.zeros(len(mesh.points))
    np.maximum.at(part, mesh.triangles[faces], depth[:, None])
    part[~_movable(mesh, worn_faces(mesh))] = 0.0
    part[mesh.triangles[~changed]] = 0.0
    motion = (part * mesh.point_data[TARGET_EDGE])[:, None] * node_normals(mesh.points, mesh.triangles)
    return SurfaceMesh(mesh.points - motion, mesh.triangles, mesh.cell_data, mesh.point_data)


def charge(mesh: SurfaceMesh, gained: float, changed: np.ndarray) -> SurfaceMesh:
    """The mesh with the volume `gained` (m3) added to what the nodes of the faces `changed` carry, by their area.

    Gained volume is thus worn away later; lost volume (< 0) was worn ahead, and the next wear there pays for it.
    """
    faces = mesh.triangles[changed]
    share = np.bincount(faces.ravel(), np.repeat(areas(mesh.points, faces), 3), len(mesh.points))
    share[mesh.triangles[~changed]] = 0.0
    carried = np.asarray(mesh.point_data.get(CARRIED_VOLUME, np.zeros(len(mesh.points))))
    data = mesh.point_data | {CARRIED_VOLUME: carried + gained * share / share.sum()}
    return SurfaceMesh(mesh.points, mesh.triangles, mesh.cell_data, data)


def _shifted(points: np.ndarray, faces: np.ndarray, motion: np.ndarray, gained: float, area: float) -> np.ndarray:
    """Points + s * motion with s such that the volume over the faces falls by `gained`; `area` (m3): dV/ds."""
    origin = points[faces].mean(axis=(0, 1))
    wanted = six_volumes(points, faces, origin).sum() / 6.0 - gained
    best, smallest, part = points, abs(gained), -gained / area
    for _ in range(MOST_STEPS):
        tried = points + part * motion
        error = six_volumes(tried, faces, origin).sum() / 6.0 - wanted
        if abs(error) >= smallest:
            break
        best, smallest, part = tried, abs(error), part - error / area
    return best


def _movable(mesh: SurfaceMesh, worn: np.ndarray) -> np.ndarray:
    """Mask (n,) of nodes that only faces of one label touch and that lie on no boundary."""
    result = labels_at_nodes(mesh) >= 0
    result[border_nodes(mesh.triangles)] = False
    result[mesh.triangles[~worn]] = False
    return result
