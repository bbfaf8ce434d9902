"""How much of a sample's pattern is left."""

from __future__ import annotations

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, area_vectors


def pattern_volume(mesh: SurfaceMesh) -> float:
    """Return the volume (m3) of a pattern's shapes, each above the mean height of its own foot; 0 without any.

    That of hollows is negative. A shape is the faces of one `part` above 0; its foot is the nodes that they share with
    faces of another part.
    """
    part = mesh.cell_data["part"]
    patterned = part > 0
    if not patterned.any():
        return 0.0
    faces, label = mesh.triangles[patterned], part[patterned]
    on_foot = np.isin(faces, mesh.triangles[~patterned])
    foot = np.unique(np.column_stack([np.repeat(label, 3)[on_foot.ravel()], faces[on_foot]]), axis=0)
    height, count = (np.bincount(foot[:, 0], weights) for weights in (mesh.points[foot[:, 1], 2], np.ones(len(foot))))
    above = mesh.points[faces, 2].mean(axis=1) - (height / np.maximum(count, 1.0))[label]
    return float(above @ area_vectors(mesh.points, faces)[:, 2])
