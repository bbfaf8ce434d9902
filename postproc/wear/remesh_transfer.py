"""What a remeshed surface takes over from the old one: labels, fields on the nodes, and the carried volume."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.wear.fields import CARRIED_VOLUME
from bulkwear.postproc.wear.mesh_faults import TARGET_EDGE
from bulkwear.postproc.wear.old_surface import OldSurface
from bulkwear.postproc.wear.remesh_patch import Patch, barycentric, border_nodes

WIDEST = 4  # integers per face, between the lowest and the highest, for which no sorting is needed


def labels_of(mesh: SurfaceMesh) -> np.ndarray:
    """One number (m,) per combination of the integer data of a face (part, column, row)."""
    label = np.zeros(len(mesh.triangles), dtype=np.int64)
    for name in _label_names(mesh):
        values = _ranks(np.asarray(mesh.cell_data[name]).astype(np.int64))
        label = _ranks(label * (values.max(initial=0) + 1) + values)
    return label


def _ranks(values: np.ndarray) -> np.ndarray:
    """Rank (m,) of integers (m,) among those that there are: 0 for the lowest."""
    first = values.min(initial=0)
    if (span := values.max(initial=0) - first + 1) > WIDEST * len(values):
        return np.unique(values, return_inverse=True)[1]
    there = np.zeros(span, dtype=bool)
    there[values - first] = True
    return (np.cumsum(there) - 1)[values - first]


def _label_names(mesh: SurfaceMesh) -> list[str]:
    return [name for name, data in mesh.cell_data.items() if np.asarray(data).dtype.kind in "iub"]


def cut_out(mesh: SurfaceMesh, core: np.ndarray) -> Patch:
    """The faces `core` (m,) of a mesh as a patch; nodes shared with other faces or on a boundary are fixed.

    Faces come in the order of their nodes, so that the outcome does not depend on the order in the mesh.
    """
    faces = mesh.triangles[core]
    label = labels_of(mesh)[core]
    lowest = faces.argmin(axis=1)
    turned = faces[np.arange(len(faces))[:, None], (lowest[:, None] + np.arange(3)) % 3]
    order = np.lexsort(turned.T[::-1])
    nodes, local = np.unique(turned[order], return_inverse=True)
    fixed = np.zeros(len(mesh.points), dtype=bool)
    fixed[mesh.triangles[~core]] = True
    fixed[border_nodes(mesh.triangles)] = True
    size = np.asarray(mesh.point_data[TARGET_EDGE])[nodes]
    return Patch(mesh.points[nodes], local.reshape(-1, 3), label[order], size, fixed[nodes], nodes)


def transferred(mesh: SurfaceMesh, core: np.ndarray, patch: Patch, left: OldSurface) -> tuple[SurfaceMesh, np.ndarray]:
    """The mesh with a patch in place of its faces `core` (m,), and the mask of the patch's faces in it.

    Faces outside `core` keep their order and come first; nodes keep theirs, new ones come last, those that vanished
    are left out. Nodes in place keep their data bit for bit, others get them from the old surface, barycentric at the
    closest point (NaN corners do not count). The carried volume of a node that vanished goes to the nearest node with
    the same labels round it, so its sum over each of them stays. left: the faces `core`, which give way.
    """
    new = patch.origin < 0
    index = np.where(new, len(mesh.points) + np.cumsum(new) - 1, patch.origin)
    points = np.concatenate([mesh.points, patch.points[new]])
    points[index] = patch.points
    triangles = np.concatenate([mesh.triangles[~core], index[patch.triangles]])
    kept = np.ones(len(points), dtype=bool)
    kept[mesh.triangles[core]] = False
    kept[triangles] = True
    moved = np.ones(len(points), dtype=bool)
    moved[: len(mesh.points)] = (points[: len(mesh.points)] != mesh.points).any(axis=1)
    cells = _cell_data(mesh, core, patch, left)
    whole = SurfaceMesh(points, triangles, cells)
    data = _point_data(mesh, left, points, np.flatnonzero(moved & kept))
    if CARRIED_VOLUME in mesh.point_data:
        data[CARRIED_VOLUME] = _carried(mesh, whole, kept)
    number = np.cumsum(kept) - 1
    result = SurfaceMesh(points[kept], number[triangles], cells, {name: array[kept] for name, array in data.items()})
    return result, np.arange(len(triangles)) >= np.count_nonzero(~core)


def _cell_data(mesh: SurfaceMesh, core: np.ndarray, patch: Patch, left: OldSurface) -> dict[str, np.ndarray]:
    """Labels of the patch by their number, other data of its faces from the closest old face."""
    first = np.unique(labels_of(mesh), return_index=True)[1]
    by_label = first[patch.label]
    centres = patch.points[patch.triangles].mean(axis=1)
    names = _label_names(mesh)
    closest = by_label
    if len(names) < len(mesh.cell_data):
        closest = np.flatnonzero(core)[left.nearest(centres)[1]]
    return {
        name: np.concatenate([data[~core], data[by_label if name in names else closest]])
        for name, data in mesh.cell_data.items()
    }


def _point_data(mesh: SurfaceMesh, left: OldSurface, points: np.ndarray, moved: np.ndarray) -> dict[str, np.ndarray]:
    """Data of all points, interpolated at the nodes `moved`."""
    _, face, place = left.nearest(points[moved])
    corners = left.triangles[face]
    weight = barycentric(place, mesh.points[corners])
    result = {}
    for name, values in mesh.point_data.items():
        values = np.asarray(values)
        array = np.zeros((len(points), *values.shape[1:]), dtype=values.dtype)
        array[: len(values)] = values
        array[moved] = _interpolated(values[corners], weight)
        result[name] = array
    return result


def _interpolated(values: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Values (k,) or (k, 3) from those at the corners (k, 3, …); corners that are NaN have no weight."""
    if values.dtype.kind != "f":
        return values[np.arange(len(values)), weight.argmax(axis=1)]
    weight = weight.reshape(weight.shape + (1,) * (values.ndim - 2))
    known = np.where(np.isnan(values), 0.0, np.broadcast_to(weight, values.shape))
    total = known.sum(axis=1)
    summed = (known * np.nan_to_num(values)).sum(axis=1)
    return np.divide(summed, total, out=np.full_like(summed, np.nan), where=total > 0.0)


def _carried(mesh: SurfaceMesh, whole: SurfaceMesh, kept: np.ndarray) -> np.ndarray:
    """Carried volume (n,) m3 of all nodes: what vanished nodes had goes to the nearest with the same labels."""
    carried = np.zeros(len(whole.points))
    carried[: len(mesh.points)] = mesh.point_data[CARRIED_VOLUME]
    before, after = labels_at_nodes(mesh), labels_at_nodes(whole)
    for node_labels in np.unique(before[np.flatnonzero(~kept[: len(before)])]):
        gone = np.flatnonzero(~kept[: len(before)] & (before == node_labels))
        heirs = np.flatnonzero(kept & (after == node_labels))
        heirs = heirs if len(heirs) else np.flatnonzero(kept)
        nearest = heirs[cKDTree(whole.points[heirs]).query(mesh.points[gone])[1]]
        np.add.at(carried, nearest, carried[gone])
        carried[gone] = 0.0
    return carried


def labels_at_nodes(mesh: SurfaceMesh) -> np.ndarray:
    """Label (n,) of the faces round each node where they agree, -1 where they do not or there are none."""
    label = labels_of(mesh)
    lowest = np.full(len(mesh.points), np.iinfo(np.int64).max)
    highest = np.full(len(mesh.points), -1)
    np.minimum.at(lowest, mesh.triangles, label[:, None])
    np.maximum.at(highest, mesh.triangles, label[:, None])
    return np.where(lowest == highest, lowest, -1)
