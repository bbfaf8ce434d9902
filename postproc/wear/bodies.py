"""A surface of several bodies: what one of them is alone, and all of them together again."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh


def body(mesh: SurfaceMesh, faces: np.ndarray) -> SurfaceMesh:
    """Return the surface of some faces (m,) bool with their own nodes, and the data of both, in the order of before."""
    nodes, inverse = np.unique(mesh.triangles[faces], return_inverse=True)
    return SurfaceMesh(
        mesh.points[nodes],
        inverse.reshape(-1, 3),
        {name: values[faces] for name, values in mesh.cell_data.items()},
        {name: values[nodes] for name, values in mesh.point_data.items()},
    )


def together(bodies: Sequence[SurfaceMesh]) -> SurfaceMesh:
    """Return bodies as one surface, faces and nodes in their order; data that some of them lack is 0 there."""
    first = np.cumsum([0, *(len(each.points) for each in bodies)])
    return SurfaceMesh(
        np.concatenate([each.points for each in bodies]),
        np.concatenate([each.triangles + start for each, start in zip(bodies, first, strict=False)]),
        _joined([each.cell_data for each in bodies], [len(each.triangles) for each in bodies]),
        _joined([each.point_data for each in bodies], [len(each.points) for each in bodies]),
    )


def _joined(fields: Sequence[dict[str, np.ndarray]], counts: Sequence[int]) -> dict[str, np.ndarray]:
    names = dict.fromkeys(name for data in fields for name in data)
    found = {name: next(data[name] for data in fields if name in data) for name in names}
    return {
        name: np.concatenate(
            [
                data.get(name, np.zeros((count, *like.shape[1:]), like.dtype))
                for data, count in zip(fields, counts, strict=True)
            ]
        )
        for name, like in found.items()
    }
