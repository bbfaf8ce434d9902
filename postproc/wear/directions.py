"""Which way nodes go: into the body, by the faces that wear at each node, so that wear leaves the faces it fell on.

On a smooth surface all faces at a node agree. At the foot of a bump or a sharp edge they do not: the mean
normal there would take wear of the bump out of the base. Each node goes along the normals of its faces weighted
with the volume each of them loses. Where two labels meet at an angle, the direction is the one that takes from
either label exactly its own volume (for labels of one face each this is face offsetting, X. Jiao, J. Comput.
Phys. 220 (2007) 612). No node leaves the body through any of its faces, loaded or not: a surface that grows
launches particles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from bulkwear.postproc.mesh import area_vectors, boundary_nodes, sum_over_nodes

LEAST_LABEL_ANGLE_SINE = 0.34  # -, 20 degrees: flatter, two labels cannot be told apart by a motion
OUTWARD_TOLERANCE = 1e-9  # -, cosine: rounding of normals stays far below
MOST_REPAIRS = 60  # -, rounds in which directions that would lead out of a face are turned in
ON_END = 1e-7  # m, from the end of a slice: drawings of four digits behind a millimetre
OVERCORRECTION = 1.01  # -, of the part that leads out: ends after a few rounds instead of creeping up to zero


@dataclass(frozen=True)
class SliceEnds:
    """The ends of a periodic slice: planes at low and high (m) along an axis (0, 1, 2)."""

    axis: int
    low: float
    high: float


def inward_directions(
    points: np.ndarray,
    triangles: np.ndarray,
    worn: np.ndarray | None = None,
    directions: np.ndarray | None = None,
) -> np.ndarray:
    """Unit directions (n, 3) into the body: minus the area-weighted normal of the worn faces at each node.

    Parameters
    ----------
    points : (n, 3) m
    triangles : (m, 3)
    worn : (m,) bool, faces that wear; None: all
    directions : (n, 3), replaces the direction where a row is finite (any length); None: nowhere

    Returns zero rows for nodes of no worn face and where the normals cancel.
    """
    faces = triangles if worn is None else triangles[np.asarray(worn, dtype=bool)]
    vectors = -sum_over_nodes(faces, area_vectors(points, faces), len(points))
    return _unit(_replaced(vectors, faces, directions))


def rim_directions(
    points: np.ndarray,
    triangles: np.ndarray,
    worn: np.ndarray | None = None,
    wall: tuple[float, float, float] = (0.0, 0.0, -1.0),
) -> np.ndarray:
    """Directions (n, 3) for `displace`: `wall` at rim nodes of the worn faces, NaN elsewhere.

    A rim node is shared with a face that does not wear (the holder) or lies on an open boundary. It slides
    along the holder's wall; faces of the holder follow because the node is shared, so no slit opens.
    """
    worn = np.ones(len(triangles), dtype=bool) if worn is None else np.asarray(worn, dtype=bool)
    in_holder = np.zeros(len(points), dtype=bool)
    in_holder[triangles[~worn]] = True
    rim = np.union1d(boundary_nodes(triangles[worn]), triangles[worn][in_holder[triangles[worn]]])
    result = np.full((len(points), 3), np.nan)
    result[rim] = wall
    return result


def slice_directions(
    points: np.ndarray, triangles: np.ndarray, ends: SliceEnds, worn: np.ndarray | None = None
) -> np.ndarray:
    """Directions (n, 3) for `displace`: within its end's plane at rim nodes on the ends of a periodic slice, else NaN.

    Such a node goes on in its image at the other end. Along the normal of a rough face it would leave the slice, where
    the solver has no room, or open a gap in which nothing holds particles. It goes along what of the mean inward normal
    of the worn faces lies in the plane, out of no face; zero, where it stays, if there is no such way.
    """
    faces = triangles if worn is None else triangles[np.asarray(worn, dtype=bool)]
    rim = np.zeros(len(points), dtype=bool)
    rim[boundary_nodes(faces)] = True
    rim &= (np.abs(points[:, [ends.axis]] - [ends.low, ends.high]) < ON_END).any(axis=1)
    vectors = np.where(rim[:, None], inward_directions(points, faces), 0.0)
    vectors[:, ends.axis] = 0.0
    result = np.full((len(points), 3), np.nan)
    result[rim] = _turned_in(_unit(vectors), faces, _unit(area_vectors(points, faces)), ends.axis)[rim]
    return result


def loaded_directions(
    points: np.ndarray,
    faces: np.ndarray,
    corner_volume: np.ndarray,
    carried_volume: np.ndarray | None = None,
    directions: np.ndarray | None = None,
) -> np.ndarray:
    """Unit directions (n, 3) into the body, by the volume that each face is to lose at each of its corners.

    Parameters
    ----------
    points : (n, 3) m
    faces : (m, 3), the triangles that wear
    corner_volume : (m, 3) m3, >= 0
    carried_volume : (n,) m3, of no face in particular: it goes along the mean normal; None: none
    directions : (n, 3), replaces the direction where a row is finite (any length); None: nowhere

    Returns
    -------
    (n, 3). Never outward of any of the faces at the node; zero where nothing is to be removed, at nodes of no face
    and where no direction leads into all faces.
    """
    area = area_vectors(points, faces)
    normal = _unit(area)
    vectors = -_corner_sum(faces, corner_volume, normal, len(points))
    if carried_volume is not None:
        mean = _unit(sum_over_nodes(faces, area, len(points)))
        vectors -= np.maximum(carried_volume, 0.0)[:, None] * mean
    vectors = _turned_in(_unit(vectors), faces, normal)
    return _unit(_replaced(vectors, faces, directions))


class LabelParting:
    """Directions of the nodes where two labels meet at an angle: each label loses its own volume.

    points (n, 3) m, faces (m, 3), corner_volume (m, 3) m3, carried_volume (n,) m3, directions (n, 3): as in
        `loaded_directions`; nodes with a given direction are left alone
    label : (m,) int, e.g. base and bumps

    near : (k,) faces at those nodes. Never outward of a face, which goes before the parting: it costs some 0.1 %
    where only the flat side of a foot wears.
    """

    def __init__(self, points, faces, corner_volume, label, carried_volume=None, directions=None):
        free = np.ones(len(points), dtype=bool)
        if directions is not None:
            free = ~np.isfinite(directions).all(axis=1)
        lowest, highest, two = _label_range(faces, label, len(points))
        loaded = np.bincount(faces.ravel(), corner_volume.ravel(), len(points)) > 0.0
        two &= free & loaded
        self.near = np.flatnonzero(two[faces].any(axis=1))
        self._nodes, local = np.unique(faces[self.near], return_inverse=True)
        self._faces = local.reshape(-1, 3)
        self._parted = two[self._nodes]
        self._normal = _unit(area_vectors(points, faces[self.near]))
        self._sides = []
        for side in (lowest, highest):
            mine = np.repeat(label[self.near], 3) == side[faces[self.near].ravel()]
            self._sides.append((mine / 3.0, self._summed(corner_volume[self.near].ravel() * mine)))
        self._carried = np.zeros(len(self._nodes))
        if carried_volume is not None:
            self._carried = np.maximum(carried_volume[self._nodes], 0.0)

    def __call__(self, area: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Nodes (p,) and their unit directions (p, 3), for the area vectors (k, 3) m2 of the faces `near`.

        With the present ones the parting is exact to first order, with the time mean over the motion exactly. The
        motion is the least w with -w . N_L = V_L for both labels, N_L a third of their area vectors.
        """
        (first, first_volume), (second, second_volume) = (
            (np.stack([self._summed(np.repeat(area[:, axis], 3) * share) for axis in range(3)], axis=1), volume)
            for share, volume in self._sides
        )
        squares = (first**2).sum(axis=1), (second**2).sum(axis=1)
        product = (first * second).sum(axis=1)
        determinant = squares[0] * squares[1] - product**2
        clear = self._parted & (determinant > LEAST_LABEL_ANGLE_SINE**2 * squares[0] * squares[1])
        scale = np.divide(1.0, determinant, out=np.zeros_like(determinant), where=clear)
        along_first = (squares[1] * first_volume - product * second_volume) * scale
        along_second = (squares[0] * second_volume - product * first_volume) * scale
        vectors = -_unit(along_first[:, None] * first + along_second[:, None] * second)
        vectors *= (first_volume + second_volume)[:, None]
        vectors -= np.where(clear, self._carried, 0.0)[:, None] * _unit(first + second)
        return self._nodes[clear], _turned_in(_unit(vectors), self._faces, self._normal)[clear]

    def _summed(self, per_corner: np.ndarray) -> np.ndarray:
        return np.bincount(self._faces.ravel(), per_corner, len(self._nodes))


def between_labels(faces: np.ndarray, label: np.ndarray, n_points: int) -> np.ndarray:
    """Mask (n,) of the nodes at which faces (m, 3) of different labels (m,) meet."""
    mask, of_face = np.zeros(n_points, dtype=bool), np.zeros(n_points, dtype=np.int64)
    of_face[faces] = label[:, None]  # one of its faces: another one differs where labels meet
    mask[faces[of_face[faces] != label[:, None]]] = True
    return mask


def _label_range(faces, label, n_points) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lowest and highest label (n,) of the faces at each node, and where it has these two and no third one (n,)."""
    lowest, highest = np.full(n_points, np.iinfo(np.int64).max), np.full(n_points, np.iinfo(np.int64).min)
    np.minimum.at(lowest, faces, label[:, None])
    np.maximum.at(highest, faces, label[:, None])
    two = lowest < highest
    third = (label[:, None] != lowest[faces]) & (label[:, None] != highest[faces])
    two[faces[third]] = False
    return lowest, highest, two


def _corner_sum(faces, corner_values, face_vectors, n_points) -> np.ndarray:
    """Sum (n, 3) at each node of the face vectors (m, 3) times the value (m, 3) of that corner."""
    column = np.repeat(np.arange(len(faces)), 3)
    shape = (n_points, len(faces))
    return sparse.csr_array((corner_values.ravel(), (faces.ravel(), column)), shape=shape) @ face_vectors


def _turned_in(vectors, faces, normal, flat: int | None = None) -> np.ndarray:
    """Directions (n, 3) turned until none leads out of a face at its node; zero where that cannot be.

    flat: axis along which the directions are 0 and stay so; None: none
    """
    face, corner = np.nonzero(vectors.any(axis=1)[faces])
    node, out = faces[face, corner], normal[face]
    for _ in range(MOST_REPAIRS):
        outward = np.einsum("ij,ij->i", vectors[node], out)
        leaving = node[outward > OUTWARD_TOLERANCE]
        if not leaving.size:
            return vectors
        concerned = np.zeros(len(vectors), dtype=bool)
        concerned[leaving] = True
        keep = concerned[node]  # in the next round only corners of these nodes are looked at
        node, out, outward = node[keep], out[keep], outward[keep]
        largest = np.zeros(len(vectors))
        np.maximum.at(largest, node, outward)
        worst = outward == largest[node]
        np.subtract.at(vectors, node[worst], OVERCORRECTION * outward[worst, None] * out[worst])
        if flat is not None:
            vectors[node, flat] = 0.0
        vectors[node] = _unit(vectors[node])
    outward = np.einsum("ij,ij->i", vectors[node], out)
    vectors[node[outward > OUTWARD_TOLERANCE]] = 0.0
    return vectors


def _replaced(vectors, faces, directions) -> np.ndarray:
    """The vectors (n, 3), replaced at nodes of the faces where a row of `directions` is finite."""
    if directions is None:
        return vectors
    touched = np.zeros(len(vectors), dtype=bool)
    touched[faces] = True
    return np.where((touched & np.isfinite(directions).all(axis=1))[:, None], directions, vectors)


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) at unit length, zero where they are zero."""
    length = np.sqrt((vectors**2).sum(axis=1))[:, None]
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0.0)
