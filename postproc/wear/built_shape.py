"""What of a surface's shape was built so and is none of wear: sharp edges between panels, and hollow walls.

A node in a hollow hands a part of its wear to its neighbours, so that pits do not run away (`postproc.wear.hollows`).
The corner between floor and wall of a box is no pit: each panel loses its own volume, and the edge between them stays
an edge (`postproc.wear.directions`). Nor is the inside of a drum or a hopper one: only what rises more steeply than it
did on the pristine surface hands over. Remeshing keeps panels as it keeps parts, and with them the edges.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from bulkwear.postproc.mesh import SurfaceMesh, unit_normals, worn_faces
from bulkwear.postproc.wear.displacement import incidence
from bulkwear.postproc.wear.hollows import steepest_rise
from bulkwear.postproc.wear.remesh_patch import neighbours

PANEL = "panel"  # cell data: number of the panel
PRISTINE_RISE = "pristine_rise"  # point data, -
SHARP_EDGE_DEG = 30.0  # degrees, between the normals of two faces: flatter, they are one panel


def with_built_shape(mesh: SurfaceMesh, sharp_edge_deg: float = SHARP_EDGE_DEG) -> SurfaceMesh:
    """The pristine mesh with cell data `panel` and point data `pristine_rise`, which updates and remeshing hand on.

    sharp_edge_deg: degrees; faces whose normals differ by less at their edge are of one panel.
    """
    pairs, _ = neighbours(mesh.triangles)
    normals = unit_normals(mesh.points, mesh.triangles)
    smooth = np.einsum("ij,ij->i", normals[pairs[:, 0]], normals[pairs[:, 1]]) > np.cos(np.radians(sharp_edge_deg))
    first, second = pairs[smooth].T
    count = len(mesh.triangles)
    graph = sparse.coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    panel = csgraph.connected_components(graph, directed=False)[1].astype(np.int64)
    cells, fields = mesh.cell_data | {PANEL: panel}, mesh.point_data | {PRISTINE_RISE: _rise(mesh)}
    return SurfaceMesh(mesh.points, mesh.triangles, cells, fields)


def with_turned_shape(mesh: SurfaceMesh, turned: np.ndarray) -> SurfaceMesh:
    """The mesh after some of its faces, pristine so far, were turned (m,) bool: their hollows are others."""
    if PRISTINE_RISE not in mesh.point_data or not turned.any():
        return mesh
    nodes = np.unique(mesh.triangles[turned])
    rise = np.array(mesh.point_data[PRISTINE_RISE])
    rise[nodes] = _rise(mesh)[nodes]
    return SurfaceMesh(mesh.points, mesh.triangles, mesh.cell_data, mesh.point_data | {PRISTINE_RISE: rise})


def _rise(mesh: SurfaceMesh) -> np.ndarray:
    """Sine (n,) of the steepest rise of the worn faces at each node."""
    faces = mesh.triangles[worn_faces(mesh)]
    return steepest_rise(mesh.points, faces, incidence(faces, len(mesh.points)))


def face_labels(mesh: SurfaceMesh) -> np.ndarray | None:
    """Label (m,) of each face by part and panel, which lose their own volumes; None where the mesh has neither."""
    columns = [mesh.cell_data[name] for name in ("part", PANEL) if name in mesh.cell_data]
    if len(columns) < 2:
        return columns[0] if columns else None
    return np.unique(np.column_stack(columns), axis=0, return_inverse=True)[1].ravel()
