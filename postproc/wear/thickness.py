"""How thick a part is under its surface, how much of it is left, and where it is worn through.

The local thickness is given, as that of a liner, or measured on the pristine surface along the inward normal to the
back of the same part. It stays with the nodes; a place is worn through when the thickness removed there reaches it.
"""

from __future__ import annotations

from collections.abc import Mapping

import igl
import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, shortest_edge_at_nodes, unit_normals, worn_faces

LOCAL_THICKNESS = "local_thickness_m"  # point data of the pristine surface, NaN where it is not known
REMAINING_THICKNESS = "remaining_thickness_m"
REMOVED_THICKNESS = "removed_thickness_m"
OFF_CORNER = 1e-3  # -, of the way to the centroid: a ray from a corner must not run within a neighbouring face
OFF_FACE = 1e-6  # -, of the shortest edge, inward: a ray must not hit the face it starts from
LEAST_FACING_COSINE = 0.25  # -, of the face behind with the ray: a side that a ray grazes at a sharp edge is no back
THROUGH = 1e-9  # -, of the local thickness: rounding of sums of steps
METRES_TO_MM = 1e3


def with_thickness(mesh: SurfaceMesh, given: Mapping[int, float] | float | None = None) -> SurfaceMesh:
    """The pristine surface with its local thickness (n,) m as point data `local_thickness_m`.

    given : m, of all parts, or by their labels; parts that are not named, and all for None, are measured: nodes then
        get the smallest distance to the back along the inward normals of their worn faces, NaN where a face has no back

    Where parts meet, a node has the smallest thickness. Raises ValueError for a thickness that is not above 0 and for a
    label that no face has.
    """
    part = np.asarray(mesh.cell_data.get("part", np.zeros(len(mesh.triangles), dtype=np.int64)))
    labels = np.unique(part[worn_faces(mesh)])
    by_part = dict.fromkeys(labels.tolist(), given) if not isinstance(given, Mapping) else dict(given)
    if unknown := sorted(set(by_part) - set(labels.tolist())):
        allowed = ", ".join(map(str, labels))
        raise ValueError(f"thickness is given for part {unknown[0]}, allowed are the parts that wear: {allowed}")
    thickness = np.full(len(mesh.points), np.inf)
    for label in labels:
        faces, value = part == label, by_part.get(int(label))
        if value is None:
            of_corner = thickness_to_back(mesh.points, mesh.triangles[faces])
            np.fmin.at(thickness, mesh.triangles[faces], of_corner)
        elif not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"thickness of part {label} is {value} m, allowed is a finite length above 0 m")
        else:
            nodes = np.unique(mesh.triangles[faces])
            thickness[nodes] = np.fmin(thickness[nodes], value)
    thickness[np.isinf(thickness)] = np.nan
    return SurfaceMesh(mesh.points, mesh.triangles, mesh.cell_data, mesh.point_data | {LOCAL_THICKNESS: thickness})


def thickness_to_back(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Distance (m, 3) m from each corner of each face along the face's inward normal to the next face of the part.

    points (n, 3) m; triangles (m, 3) of one part, normals out of the body. NaN where nothing lies behind.
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
    faces_away = np.einsum("ij,ij->i", rays, normal[np.maximum(face, 0)]) > LEAST_FACING_COSINE
    return np.where((face >= 0) & faces_away, distance, np.nan).reshape(-1, 3) + nudge[:, None]


def remaining_thickness(mesh: SurfaceMesh) -> np.ndarray:
    """Thickness (n,) m left at each node, at least 0; NaN where the local thickness is not known."""
    local = np.asarray(mesh.point_data.get(LOCAL_THICKNESS, np.full(len(mesh.points), np.nan)))
    left = local - np.asarray(mesh.point_data.get(REMOVED_THICKNESS, np.zeros(len(mesh.points))))
    return np.where(left <= THROUGH * local, 0.0, left)


def worn_through(mesh: SurfaceMesh) -> np.ndarray:
    """Mask (n,) of the nodes at which the removed thickness has reached the local thickness of the part."""
    return remaining_thickness(mesh) == 0.0


def through_phrase(mesh: SurfaceMesh) -> str | None:
    """Phrase on where a surface is worn through, the place of the most removed one first; None where it is not."""
    nodes = np.flatnonzero(worn_through(mesh))
    if not nodes.size:
        return None
    at = nodes[np.argmax((mesh.point_data[REMOVED_THICKNESS] / mesh.point_data[LOCAL_THICKNESS])[nodes])]
    x, y, z = METRES_TO_MM * mesh.points[at]
    return (
        f"worn through at {nodes.size} nodes, first at ({x:.4g}, {y:.4g}, {z:.4g}) mm, where the part was "
        f"{METRES_TO_MM * mesh.point_data[LOCAL_THICKNESS][at]:.4g} mm thick"
    )
