"""A piece of a worn surface round its bad faces, so that late attempts of remeshing do not handle the whole of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from bulkwear.postproc.mesh import SurfaceMesh, centroids
from bulkwear.postproc.wear.mesh_faults import TARGET_EDGE, Bounds, MeshFaults, mesh_faults
from bulkwear.postproc.wear.remesh_patch import border_nodes

REACH = 16.0  # -, over the largest target edge: rings that change, rings that share a volume, and room for cuts
LARGEST_PIECE = 0.5  # -, of the faces; more than that is not worth a piece
OLD_NODE = "node_of_whole"  # point data of a piece: its node in the whole mesh, valid on the border of the piece


@dataclass(frozen=True, eq=False)
class Piece:
    """Faces of a mesh by themselves.

    mesh : the piece; its border counts as a boundary, so nothing there moves
    faults : of the piece
    whole : the mesh it was cut from; inside (m,): its faces in the piece
    """

    mesh: SurfaceMesh
    faults: MeshFaults
    whole: SurfaceMesh
    inside: np.ndarray

    def put_back(self, mesh: SurfaceMesh) -> SurfaceMesh:
        """The whole with a changed piece (border as before) in its place: faces of the piece come last."""
        whole, outside = self.whole, ~self.inside
        kept = np.ones(len(whole.points), dtype=bool)
        kept[whole.triangles[self.inside]] = False
        kept[whole.triangles[outside]] = True
        border = border_nodes(mesh.triangles)
        place = mesh.point_data[OLD_NODE][border]
        shared = kept[place]
        number = np.cumsum(kept) - 1
        index = np.full(len(mesh.points), -1)
        index[border[shared]] = number[place[shared]]
        new = np.flatnonzero(index < 0)
        index[new] = np.count_nonzero(kept) + np.arange(len(new))
        cells = {k: np.concatenate([data[outside], mesh.cell_data[k]]) for k, data in whole.cell_data.items()}
        data = {}
        for name in (name for name in mesh.point_data if name != OLD_NODE):
            values = np.asarray(whole.point_data.get(name, np.zeros(len(kept))))
            data[name] = np.concatenate([values[kept], mesh.point_data[name][new]])
            data[name][index] = mesh.point_data[name]
        triangles = np.concatenate([number[whole.triangles[outside]], index[mesh.triangles]])
        return SurfaceMesh(np.concatenate([whole.points[kept], mesh.points[new]]), triangles, cells, data)


def piece_round(mesh: SurfaceMesh, faces: np.ndarray, bounds: Bounds) -> Piece | None:
    """The faces within `REACH` of the mask `faces` (m,), None where these are most of the mesh."""
    centre = centroids(mesh.points, mesh.triangles)
    reach = REACH * float(np.max(mesh.point_data[TARGET_EDGE]))
    distance = cKDTree(centre[faces]).query(centre, distance_upper_bound=reach)[0]
    inside = distance < reach
    if np.count_nonzero(inside) > LARGEST_PIECE * len(inside):
        return None
    nodes, local = np.unique(mesh.triangles[inside], return_inverse=True)
    data = {name: np.asarray(values)[nodes] for name, values in mesh.point_data.items()} | {OLD_NODE: nodes}
    cells = {name: np.asarray(values)[inside] for name, values in mesh.cell_data.items()}
    part = SurfaceMesh(mesh.points[nodes], local.reshape(-1, 3), cells, data)
    return Piece(part, mesh_faults(part, bounds), mesh, inside)
