"""Wear at the bottom of hollows: handed to the walls, so that pits widen and fill up instead of running away.

Every wall of a hollow recedes along its own normal. Carried to the bottom node, that would drive it down by
thickness / cosine of the slope: the steeper the walls, the faster the pit deepens, until the mesh is full of pits.
The front that recedes from all places at once (Huygens; the entropy condition of S. Osher and J. A. Sethian, J. Comput.
Phys. 79 (1988) 12) goes down by the thickness alone and rounds the bottom. So a node in a hollow hands a part of the
wear at its corners to the other corners of the same faces: each face, hence each label, keeps its volume. The part is
`STRENGTH` times the sine of the rise: above 1 - cosine, which stops the run-away, it closes the lead of a pit after
about one edge of wear. In a smooth groove it is of the order of edge / radius, and neighbours exchange nearly equal
parts: what comes of it is a shift of some wear by one edge, where the curvature changes.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from bulkwear.postproc.mesh import area_vectors

STRENGTH = 1.5  # -, part handed over by the sine of the rise: any above 1 keeps hollows from running away


def handed_over(
    points: np.ndarray,
    faces: np.ndarray,
    corner_volume: np.ndarray,
    incidence: sparse.csr_array,
    keeps_all: np.ndarray | None = None,
    pristine_rise: np.ndarray | None = None,
) -> np.ndarray:
    """Volumes (m, 3) m3 at the corners after nodes in hollows have handed over; sums per face stay.

    Parameters
    ----------
    points : (n, 3) m
    faces : (m, 3), the triangles that wear
    corner_volume : (m, 3) m3, >= 0
    incidence : (n, m) ones where a node is a corner of a face
    keeps_all : (n,) bool, nodes that hand nothing over, e.g. the rim, which slides along its wall; None: none
    pristine_rise : (n,) -, `steepest_rise` of the pristine surface: a wall that was built hollow, as a hopper's, is no
        pit of wear; None: 0
    """
    part = handed_part(points, faces, incidence, pristine_rise)
    if keeps_all is not None:
        part = np.where(keeps_all, 0.0, part)
    handed = part[faces] * corner_volume
    return corner_volume - handed + 0.5 * (np.roll(handed, 1, axis=1) + np.roll(handed, 2, axis=1))


def handed_part(
    points: np.ndarray, faces: np.ndarray, incidence: sparse.csr_array, pristine_rise: np.ndarray | None = None
) -> np.ndarray:
    """Part (n,) of its wear that each node hands over, -: `STRENGTH` * the sine of its steepest rise, at most 1.

    Arguments as in `handed_over`. 0 on planes and where all edges fall.
    """
    sine = steepest_rise(points, faces, incidence)
    if pristine_rise is not None:
        sine = np.maximum(sine - pristine_rise, 0.0)
    return np.minimum(STRENGTH * sine, 1.0)


def steepest_rise(points: np.ndarray, faces: np.ndarray, incidence: sparse.csr_array) -> np.ndarray:
    """Sine (n,) of the steepest rise at each node, -, 0 to 1.

    The rise is that of the edges at the node above the plane square to its normal, in the principal direction in
    which they rise most (tensor of G. Taubin, ICCV 1995, 902, of slopes instead of curvatures): a dip in a ridge is a
    hollow too.
    """
    normal = incidence @ area_vectors(points, faces)
    length = np.sqrt((normal**2).sum(axis=1, keepdims=True))
    normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
    first, second = _tangents(normal)
    tensor = np.zeros((4, len(points)))
    for k in range(3):
        node, other = faces[:, k], faces[:, (k + 1) % 3]
        spoke = points[other] - points[node]
        long = np.sqrt((spoke**2).sum(axis=1))
        for at, sign in ((node, 1.0), (other, -1.0)):
            rise, x, y = (sign * (spoke * axis[at]).sum(axis=1) for axis in (normal, first, second))
            slope = np.divide(rise, long, out=np.zeros_like(rise), where=long > 0.0)
            square = x * x + y * y
            scaled = np.divide(slope, square, out=np.zeros_like(rise), where=square > 0.0)
            for row, value in enumerate((scaled * x * x, scaled * x * y, scaled * y * y, np.ones_like(rise))):
                tensor[row] += np.bincount(at, value, len(points))
    xx, xy, yy = tensor[:3] / np.maximum(tensor[3], 1.0)
    mean, radius = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    return np.clip(2.0 * mean + 4.0 * radius, 0.0, 1.0)  # 3 larger - smaller eigenvalue


def _tangents(normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors (n, 3) square to each unit normal (n, 3) and to one another."""
    axis = np.zeros_like(normal)
    axis[np.arange(len(normal)), np.abs(normal).argmin(axis=1)] = 1.0
    first = np.cross(normal, axis)
    length = np.sqrt((first**2).sum(axis=1, keepdims=True))
    first = np.divide(first, length, out=first, where=length > 0.0)
    return first, np.cross(normal, first)
