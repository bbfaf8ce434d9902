"""How thick a part is under its surface, how much of it is left, and where it is worn through.

The local thickness is given, as that of a liner, or measured on the pristine surface along the inward normal to the
back of the same part. It stays with the nodes, and with them what is lost of it: in front, square to their faces, and
where it was measured also at the back, which may wear too. A place is worn through when nothing is left between. A
sharp edge has no thickness as drawn: it goes no further than it is, and is not called worn through.
"""

from __future__ import annotations

from collections.abc import Mapping

import igl
import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, shortest_edge_at_nodes, unit_normals, worn_faces

LOCAL_THICKNESS = "local_thickness_m"  # point data of the pristine surface, NaN where it is not known
LOST_THICKNESS = "lost_thickness_m"  # in front; point data: square to the face that lost most; cell data: of each face
BACK_LOST_THICKNESS = "back_lost_thickness_m"  # point data: at the back; there where thickness is measured, else NaN
REMAINING_THICKNESS = "remaining_thickness_m"
OFF_CORNER = 1e-3  # -, of the way to the centroid: a ray from a corner must not run within a neighbouring face
OFF_FACE = 1e-6  # -, of the shortest edge, inward: a ray must not hit the face it starts from
LEAST_FACING_COSINE = 0.25  # -, of the face behind with the ray: a side that a ray grazes at a sharp edge is no back
THROUGH = 1e-3  # -, of the local thickness: what capped steps of two sides that wear towards one another leave of it
METRES_TO_MM = 1e3


def with_thickness(mesh: SurfaceMesh, given: Mapping[int, float] | float | None = None) -> SurfaceMesh:
    """The pristine surface with its local thickness (n,) m as point data, which updates and remeshing hand on.

    given : m, of all parts, or by their labels; parts that are not named, and all for None, are measured: nodes then
        get the smallest distance to the back along the inward normals of their worn faces, NaN where a face has no back

    Where parts meet, a node has the smallest thickness. Raises ValueError for a thickness that is not above 0 and for a
    label that no face has.
    """
    part = _parts(mesh)
    labels = np.unique(part[worn_faces(mesh)])
    by_part = dict.fromkeys(labels.tolist(), given) if not isinstance(given, Mapping) else dict(given)
    if unknown := sorted(set(by_part) - set(labels.tolist())):
        allowed = ", ".join(map(str, labels))
        raise ValueError(f"thickness is given for part {unknown[0]}, allowed are the parts that wear: {allowed}")
    thickness, back = np.full(len(mesh.points), np.inf), np.full(len(mesh.points), np.nan)
    for label in labels:
        faces, value = mesh.triangles[part == label], by_part.get(int(label))
        if value is None:
            np.fmin.at(thickness, faces, thickness_to_back(mesh.points, faces)[0])
            back[faces] = 0.0
        elif not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"thickness of part {label} is {value} m, allowed is a finite length above 0 m")
        else:
            nodes = np.unique(faces)
            thickness[nodes] = np.fmin(thickness[nodes], value)
    thickness[np.isinf(thickness)] = np.nan
    fields = {LOCAL_THICKNESS: thickness, LOST_THICKNESS: np.zeros(len(thickness)), BACK_LOST_THICKNESS: back}
    return SurfaceMesh(mesh.points, mesh.triangles, mesh.cell_data, mesh.point_data | fields)


def with_turned_thickness(mesh: SurfaceMesh, turned: np.ndarray) -> SurfaceMesh:
    """The mesh after some of its faces, pristine so far, were turned (m,) bool: measured from the other side."""
    if LOCAL_THICKNESS not in mesh.point_data or not turned.any():
        return mesh
    nodes = np.zeros(len(mesh.points), dtype=bool)
    nodes[mesh.triangles[turned]] = True
    nodes &= ~np.isnan(mesh.point_data[BACK_LOST_THICKNESS])
    thickness = np.where(nodes, with_thickness(mesh).point_data[LOCAL_THICKNESS], mesh.point_data[LOCAL_THICKNESS])
    fields = mesh.point_data | {LOCAL_THICKNESS: thickness}
    return SurfaceMesh(mesh.points, mesh.triangles, mesh.cell_data, fields)


def thickness_to_back(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance (m, 3) m from each corner of each face along the face's inward normal to the next face, and that face.

    points (n, 3) m; triangles (m, 3) of one part, normals out of the body. NaN and -1 where no back lies behind, 0 at
    the corners of a sharp edge, where the back meets the face.
    """
    normal = unit_normals(points, triangles)
    corners = points[triangles]
    nudge = OFF_FACE * shortest_edge_at_nodes(points, triangles)[triangles].min(axis=1)
    start = corners + OFF_CORNER * (corners.mean(axis=1, keepdims=True) - corners) - (nudge[:, None] * normal)[:, None]
    rays = np.ascontiguousarray(np.repeat(-normal, 3, axis=0))
    tree = igl.AABB()
    points, faces = np.ascontiguousarray(points), np.ascontiguousarray(triangles)
    tree.init(points, faces)
    face, distance, _ = tree.intersect_ray_first(points, faces, np.ascontiguousarray(start.reshape(-1, 3)), rays)
    is_back = (face >= 0) & (np.einsum("ij,ij->i", rays, normal[np.maximum(face, 0)]) > LEAST_FACING_COSINE)
    distance = np.where(is_back, distance, np.nan).reshape(-1, 3) + nudge[:, None]
    face = np.where(is_back, face, -1).reshape(-1, 3)
    meets = (face >= 0) & (triangles[face] == triangles[:, :, None]).any(axis=2)
    return np.where(meets, 0.0, distance), face


def with_lost_thickness(before: SurfaceMesh, after: SurfaceMesh) -> SurfaceMesh:
    """The mesh `after` one update with what it took of the local thickness added, where that is known.

    A node loses as much as its motion goes square into one of its faces: at an edge less than the length of its path.
    """
    if LOCAL_THICKNESS not in before.point_data:
        return after
    faces, motion = before.triangles[worn_faces(before)], after.points - before.points
    inward = -np.einsum("fcj,fj->fc", motion[faces], unit_normals(before.points, faces))
    step = np.zeros(len(motion))
    np.maximum.at(step, faces, inward)
    of_face = np.array(before.cell_data.get(LOST_THICKNESS, np.zeros(len(before.triangles))))
    of_face[worn_faces(before)] += inward.mean(axis=1)
    back = np.array(before.point_data[BACK_LOST_THICKNESS])
    for numbers, behind in _backs(after):
        found = np.where(behind < 0, 0.0, of_face[np.maximum(behind, 0)])
        np.maximum.at(back, after.triangles[numbers], found)
    lost = np.asarray(before.point_data[LOST_THICKNESS]) + step
    fields = after.point_data | {LOST_THICKNESS: lost, BACK_LOST_THICKNESS: back}
    return SurfaceMesh(after.points, after.triangles, after.cell_data | {LOST_THICKNESS: of_face}, fields)


def room_to_back(mesh: SurfaceMesh, touched: np.ndarray) -> np.ndarray:
    """How far (n,) m each node may go before it meets its back, infinite where that is not known.

    touched: (m,) bool, faces that wear in this update; half of what remains where the back is one of them
    """
    room = np.nan_to_num(remaining_thickness(mesh), nan=np.inf)
    moving, shared = np.zeros((2, len(mesh.points)), dtype=bool)
    moving[mesh.triangles[touched]] = True
    for numbers, behind in _backs(mesh):
        moves = (behind >= 0) & moving[mesh.triangles[np.maximum(behind, 0)]].any(axis=2)
        shared[mesh.triangles[numbers][moves]] = True
    return np.where(shared, 0.5 * room, room)


def remaining_thickness(mesh: SurfaceMesh) -> np.ndarray:
    """Thickness (n,) m left at each node, at least 0; NaN where the local thickness is not known."""
    if LOCAL_THICKNESS not in mesh.point_data:
        return np.full(len(mesh.points), np.nan)
    local, lost, back = (mesh.point_data[name] for name in (LOCAL_THICKNESS, LOST_THICKNESS, BACK_LOST_THICKNESS))
    left = local - lost - np.nan_to_num(back)
    return np.where(left <= THROUGH * local, 0.0, left)


def worn_through(mesh: SurfaceMesh) -> np.ndarray:
    """Mask (n,) of the nodes at which the lost thickness has reached the local thickness of the part, if it had any."""
    return (remaining_thickness(mesh) == 0.0) & (np.asarray(mesh.point_data.get(LOCAL_THICKNESS, 0.0)) > 0.0)


def through_phrase(mesh: SurfaceMesh) -> str | None:
    """Phrase on where a surface is worn through, the place of the largest loss first; None where it is not."""
    nodes = np.flatnonzero(worn_through(mesh))
    if not nodes.size:
        return None
    at = nodes[np.argmax((mesh.point_data[LOST_THICKNESS] / mesh.point_data[LOCAL_THICKNESS])[nodes])]
    x, y, z = METRES_TO_MM * mesh.points[at]
    return (
        f"worn through at {nodes.size} nodes, first at ({x:.4g}, {y:.4g}, {z:.4g}) mm, where the part was "
        f"{METRES_TO_MM * mesh.point_data[LOCAL_THICKNESS][at]:.4g} mm thick"
    )


def _backs(mesh: SurfaceMesh):
    """Yield, of each part whose thickness is measured, the numbers (k,) of its faces, and of the faces (k, 3) that lie
    behind their corners, -1 where there is none.
    """
    part, back = _parts(mesh), np.asarray(mesh.point_data[BACK_LOST_THICKNESS])
    for label in np.unique(part[worn_faces(mesh)]):
        numbers = np.flatnonzero(part == label)
        if not np.isnan(back[mesh.triangles[numbers]]).any():
            behind = thickness_to_back(mesh.points, mesh.triangles[numbers])[1]
            yield numbers, np.where(behind < 0, -1, numbers[np.maximum(behind, 0)])


def _parts(mesh: SurfaceMesh) -> np.ndarray:
    """Label (m,) of the part of each face; 0 where the mesh has no parts."""
    return np.asarray(mesh.cell_data.get("part", np.zeros(len(mesh.triangles), dtype=np.int64)))
