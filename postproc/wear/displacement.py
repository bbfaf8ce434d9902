"""Conserving displacement: worn volume per triangle becomes a shift of the nodes that removes exactly it.

Nodes move along straight lines, w_n = d_n u_n, with u_n the inward direction (unit, into the body), d_n >= 0.
While its corners move linearly, the area vector of a triangle is quadratic in time, so the volume it sweeps
is exactly -(mean of the three w) . Abar, with Simpson's rule Abar = (A(0) + 4 A(1/2) + A(1)) / 6, exact for
cubics. Node n therefore removes

    S_n(d) = -d_n u_n . sum_{i at n} Abar_i(d) / 3 ,      sum_n S_n = swept volume, exactly,

and the steps follow from S_n(d) = T_n, T_n = sum of the volumes at the corners of the faces there (V_i / 3 each
without a contact patch, less what hollows hand over to their walls, see `postproc.wear.hollows`) + carried_n, by a
fixed point. Its first pass is the first-order volume gradient
d_n = T_n / |sum A_i / 3|. Balancing node by node keeps wear where it
fell: a global factor would move it from one label to another.

A node whose step would exceed its limit stops there and carries T_n - S_n into the next cycle. Nothing is
lost: the shares are taken from the rounded coordinates, so rounding is carried too (|carried| of an uncapped
node is a few units in the last place of its coordinates times its area, of either sign).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from bulkwear.postproc.mesh import edge_lengths_per_triangle, shortest_edge_at_nodes
from bulkwear.postproc.wear.directions import LabelParting, between_labels, loaded_directions
from bulkwear.postproc.wear.hollows import handed_over

CONVERGENCE = 1e-12  # -, summed volume errors of all nodes over the total volume; rounding is near 1e-15
MOST_TURNS = 60  # -, passes after which the directions between labels stay: in corners two of them may take turns
MOST_ITERATIONS = 200  # -, a step of a tenth of an edge needs about ten
LEAST_DIRECTION_COSINE = 0.05  # -, below it a node would have to travel 20 times the thickness it removes
LARGEST_STEP_OVER_ALTITUDE = 0.5  # -, without limits: two corners closing in on one another meet at one half
MOST_FOLD_GUARDS = 12  # -, rounds in which the limits at faces about to turn over are lowered
FOLD_FACTOR = 0.25  # -, by which they are lowered; in the last rounds such nodes stay where they are


class StepTooLargeError(ValueError):
    """The wear of one update is too large for the mesh: shorten the cycle or cap the steps."""


@dataclass(frozen=True, eq=False)
class Displacement:
    """Outcome of one update.

    points : (n, 3) m, displaced; bit-identical where nothing was to be removed
    step : (n,) m, >= 0, distance each node went along its inward direction
    applied_volume : (n,) m3, removed by each node; the sum is the volume swept by the worn faces
    carried_volume : (n,) m3, left for the next update; applied + carried = target
    """

    points: np.ndarray
    step: np.ndarray
    applied_volume: np.ndarray
    carried_volume: np.ndarray


def mean_area_vectors(points: np.ndarray, motion: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Time mean (m, 3) in m2 of the area vectors while each node moves straight by its `motion`.

    Parameters: points (n, 3) m, motion (n, 3) m, triangles (m, 3).
    Equals Simpson's (A(0) + 4 A(1/2) + A(1)) / 6.
    """
    first, second = _edges(points.T, triangles)
    return _mean_area(first, second, *_edges(motion.T, triangles)).T


def swept_volume(points: np.ndarray, motion: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Volume (m,) in m3 that each face sweeps against its normal (removal > 0), exact for straight motion.

    Parameters: points (n, 3) m, motion (n, 3) m (the whole shift of each node), triangles (m, 3).
    """
    mean_motion = motion[triangles].mean(axis=1)
    return -np.einsum("ij,ij->i", mean_motion, mean_area_vectors(points, motion, triangles))


def displace(
    points: np.ndarray,
    triangles: np.ndarray,
    worn_volume: np.ndarray,
    carried_volume: np.ndarray | None = None,
    step_limit: np.ndarray | None = None,
    directions: np.ndarray | None = None,
    worn: np.ndarray | None = None,
    label: np.ndarray | None = None,
    pristine_rise: np.ndarray | None = None,
) -> Displacement:
    """Move nodes inward so that the worn faces sweep exactly the worn volume; what limits forbid is carried.

    Parameters
    ----------
    points : (n, 3) m
    triangles : (m, 3), normals out of the body
    worn_volume : (m,) m3, >= 0, a third at each corner, or (m, 3) m3 per corner, see `postproc.wear.patch`;
        entries of faces that do not wear are ignored
    carried_volume : (n,) m3, from the update before; None: none
    step_limit : (n,) m, >= 0, largest step of each node; None: no caps, but too large a step is refused
    directions : (n, 3), inward directions that replace the normals where finite, see `rim_directions`
    worn : (m,) bool, faces that wear; None: all
    label : (m,) int; where two labels meet, each loses its own volume, see `LabelParting`; None: one label
    pristine_rise : (n,) -, of hollows that are none of wear, see `postproc.wear.hollows`; None: 0

    Returns
    -------
    Displacement. Nodes of no worn face and nodes with nothing to remove keep their coordinates bit for bit. A
    node whose direction is nearly tangential to its faces, or whose faces fold, stays and carries everything.

    Raises
    ------
    ValueError : wrong shapes, negative or non-finite volumes.
    StepTooLargeError : without limits, a step above half the shortest altitude at its node or a face that
        would turn over; with or without, no convergence.
    """
    worn = np.ones(len(triangles), dtype=bool) if worn is None else np.asarray(worn, dtype=bool)
    carried = np.zeros(len(points)) if carried_volume is None else np.asarray(carried_volume, np.float64)
    _check(points, triangles, worn_volume, carried, step_limit, worn, label)
    faces = triangles[worn]
    at_nodes = incidence(faces, len(points))
    kept = _keep_their_wear(faces, len(points), directions, None if label is None else np.asarray(label)[worn])
    corner_volume = handed_over(points, faces, volume_at_corners(worn_volume)[worn], at_nodes, kept, pristine_rise)
    target = np.bincount(faces.ravel(), corner_volume.ravel(), len(points)) + carried
    inward = loaded_directions(points, faces, corner_volume, carried, directions)
    parting = None
    if label is not None:
        parting = LabelParting(points, faces, corner_volume, np.asarray(label)[worn], carried, directions)
    resistance = _Resistance(points, faces, at_nodes, inward, parting)
    if step_limit is None:
        _refuse_large_step(points, faces, resistance, target)
    step, moved = _move(points, triangles, faces, resistance, target, step_limit)
    applied = _shares(points, moved - points, faces, at_nodes)
    return Displacement(moved, step, applied, target - applied)


def _keep_their_wear(faces, n_points, directions, label) -> np.ndarray:
    """Mask (n,) of nodes on given directions or between labels, which hand over no wear (see `handed_over`)."""
    mask = np.zeros(n_points, dtype=bool)
    if directions is not None:
        mask |= np.isfinite(directions).all(axis=1)
    if label is not None:
        mask |= between_labels(faces, label, n_points)
    return mask


def volume_at_corners(worn_volume: np.ndarray) -> np.ndarray:
    """Volume (m, 3) in m3 at the corners: a third each of (m,), or (m, 3) as it is."""
    volume = np.asarray(worn_volume, dtype=np.float64)
    return np.tile(volume[:, None] / 3.0, 3) if volume.ndim == 1 else volume


def _move(points, triangles, faces, resistance, target, step_limit) -> tuple[np.ndarray, np.ndarray]:
    """Steps (n,) and new points (n, 3) in m; limits are lowered where a face would turn over."""
    limit = np.full(len(points), np.inf) if step_limit is None else np.array(step_limit, dtype=np.float64)
    for guard in range(MOST_FOLD_GUARDS):
        step = _solve(points, faces, resistance, target, limit)
        moved = np.where((step > 0.0)[:, None], points + step[:, None] * resistance.inward.T, points)
        turning = turning_nodes(points, moved, triangles, step)
        if not turning.any():
            return step, moved
        if step_limit is None:
            break
        limit[turning] = FOLD_FACTOR * step[turning] if 2 * guard < MOST_FOLD_GUARDS else 0.0
    raise StepTooLargeError(
        f"faces would turn over at {np.count_nonzero(turning)} nodes, first at node {np.argmax(turning)}: "
        "the wear of this update is too large for the mesh (shorten the cycle or cap the steps)"
    )


def _solve(points, faces, resistance, target, limit) -> np.ndarray:
    """Steps (n,) m with S_n = T_n, or at their limit with S_n < T_n, or 0 where the node cannot move."""
    wanted = np.maximum(target, 0.0)
    total = wanted.sum()
    step = np.zeros(len(points))
    mobile = wanted > 0.0
    relaxation, last_error = 1.0, np.inf
    for number in range(MOST_ITERATIONS):
        if number == MOST_TURNS and resistance.turns:
            relaxation, last_error = 1.0, np.inf
        area = resistance(step, turn=number < MOST_TURNS)
        mobile &= area > LEAST_DIRECTION_COSINE * resistance.gross
        goal = np.minimum(np.divide(wanted, area, out=np.zeros_like(area), where=mobile), limit)
        error = np.abs(goal - step)[mobile] @ area[mobile]
        step = np.where(mobile, step + relaxation * (goal - step), 0.0)
        if error <= CONVERGENCE * total:
            return np.where(mobile, goal, 0.0)
        relaxation = 0.5 * relaxation if error > last_error else relaxation
        last_error = error
    step_over_edge = np.max(step / shortest_edge_at_nodes(points, faces))
    raise StepTooLargeError(
        f"the wear of this update is too large for the mesh: no balance after {MOST_ITERATIONS} passes, "
        f"the largest step is {step_over_edge:.3g} of the shortest edge at its node"
    )


class _Resistance:
    """Area -u_n . sum Abar_i(d) / 3 in m2 that each node sweeps per step, as a function of all steps.

    Where labels meet, a call turns `inward` (3, n), unless told not to, so that with those steps they part exactly.
    """

    def __init__(self, points, faces, at_nodes, inward, parting=None):
        self.faces, self.at_nodes, self.parting = faces, at_nodes, parting
        self.turns = parting is not None and parting.near.size > 0
        self.inward = np.ascontiguousarray(inward.T)
        self.first, self.second = _edges(np.ascontiguousarray(points.T), faces)
        self.gross = at_nodes @ np.sqrt((_cross(self.first, self.second) ** 2).sum(axis=0)) / 6.0

    def __call__(self, step: np.ndarray, turn: bool = True) -> np.ndarray:
        motion = _edges(step * self.inward, self.faces)
        area = _mean_area(self.first, self.second, *motion)
        if turn and self.turns:
            nodes, directions = self.parting(area[:, self.parting.near].T)
            self.inward[:, nodes] = directions.T
        gathered = self.at_nodes @ np.ascontiguousarray(area.T)
        return -np.einsum("ij,ji->j", self.inward, gathered) / 3.0


def _edges(transposed: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two edges (3, m) from the first corner of each face; `transposed` is (3, n)."""
    origin = np.take(transposed, faces[:, 0], axis=1)
    first, second = (np.take(transposed, faces[:, corner], axis=1) - origin for corner in (1, 2))
    return first, second


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Cross product of (3, m) arrays (np.cross is several times slower)."""
    return np.stack((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


def _mean_area(first, second, first_motion, second_motion) -> np.ndarray:
    """Mean over t in 0..1 of (e + t f) x (e' + t f') / 2 = e x (e' + f'/2) / 2 + f x (e'/2 + f'/3) / 2."""
    return 0.5 * (
        _cross(first, second + 0.5 * second_motion) + _cross(first_motion, 0.5 * second + second_motion / 3.0)
    )


def incidence(faces: np.ndarray, n_points: int) -> sparse.csr_array:
    """Matrix (n, m) of ones where a node is a corner of a face: sums face values at the nodes."""
    column = np.repeat(np.arange(len(faces)), 3)
    return sparse.csr_array((np.ones(3 * len(faces)), (faces.ravel(), column)), shape=(n_points, len(faces)))


def _shares(points, motion, faces, at_nodes) -> np.ndarray:
    """Volume (n,) m3 that each node removes by that motion; the sum is the swept volume of the faces."""
    gathered = at_nodes @ mean_area_vectors(points, motion, faces)
    return -np.einsum("ij,ij->i", motion, gathered) / 3.0


def turning_nodes(points, moved, triangles, step) -> np.ndarray:
    """Mask (n,) of moving nodes at faces whose normal turns by 90 degrees or more."""
    before, after = _cross(*_edges(points.T, triangles)), _cross(*_edges(moved.T, triangles))
    turned = ((before * after).sum(axis=0) <= 0.0) & (before != 0.0).any(axis=0)
    result = np.zeros(len(points), dtype=bool)
    result[triangles[turned]] = True
    return result & (step > 0.0)


def _refuse_large_step(points, faces, resistance, target) -> None:
    """Without limits: raise if a first-order step exceeds half the shortest altitude at its node."""
    area = resistance(np.zeros(len(points)))
    mobile = (target > 0.0) & (area > LEAST_DIRECTION_COSINE * resistance.gross)
    step = np.divide(target, area, out=np.zeros_like(area), where=mobile)
    double_area = np.sqrt((_cross(resistance.first, resistance.second) ** 2).sum(axis=0))
    shortest = np.full(len(points), np.inf)
    altitude = double_area / edge_lengths_per_triangle(points, faces).max(axis=1)
    np.minimum.at(shortest, faces, altitude[:, None])
    ratio = step / shortest
    worst = int(np.argmax(ratio))
    if ratio[worst] > LARGEST_STEP_OVER_ALTITUDE:
        raise StepTooLargeError(
            f"node {worst} would step {step[worst]:.3g} m, {ratio[worst]:.3g} of the shortest altitude of "
            f"its triangles; allowed is {LARGEST_STEP_OVER_ALTITUDE} (shorten the cycle or cap the steps)"
        )


def _check(points, triangles, worn_volume, carried, step_limit, worn, label) -> None:
    """Shapes and signs; one sentence each."""
    if np.shape(worn_volume) not in ((len(triangles),), (len(triangles), 3)):
        raise ValueError(
            f"worn_volume has shape {np.shape(worn_volume)}, allowed is ({len(triangles)},) or ({len(triangles)}, 3)"
        )
    for name, array, length in (
        ("worn", worn, len(triangles)),
        ("label", label, len(triangles)),
        ("carried_volume", carried, len(points)),
        ("step_limit", step_limit, len(points)),
    ):
        if array is not None and np.shape(array) != (length,):
            raise ValueError(f"{name} has shape {np.shape(array)}, allowed is ({length},)")
    if not (np.isfinite(worn_volume).all() and np.min(worn_volume, initial=0.0) >= 0.0):
        raise ValueError(f"worn_volume holds {np.min(worn_volume)}, allowed are finite volumes >= 0 m3")
    if not np.isfinite(carried).all():
        raise ValueError("carried_volume holds a value that is not finite")
    if step_limit is not None and not np.min(step_limit, initial=0.0) >= 0.0:
        raise ValueError(f"step_limit holds {np.min(step_limit)}, allowed are lengths >= 0 m")
