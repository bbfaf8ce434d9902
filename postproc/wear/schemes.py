"""Displacement schemes: how worn volumes move the nodes. One function and one line in `SCHEMES` each.

A scheme takes the arguments of `postproc.wear.displacement.displace` and returns a `Displacement`. Only
`conserving` removes the worn volume; `per_triangle` is the rule of Yan 2022, for comparison.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bulkwear.postproc.mesh import area_vectors, sum_over_nodes
from bulkwear.postproc.wear.displacement import (
    Displacement,
    StepTooLargeError,
    displace,
    swept_volume,
    turning_nodes,
    volume_at_corners,
)

Scheme = Callable[..., Displacement]


def per_triangle(
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
    """Every triangle moves its three nodes by its own depth V_i / A_i against its own normal.

    Parameters as in `displace`; `label` and `pristine_rise` are not looked at. What a step limit forbids is carried by
    the node, as a volume of the wear law; nodes with a given direction move along it only.

    Returns
    -------
    Displacement. `applied_volume` is what each node really removed: some six times the wear law where six
    triangles meet at a node, since each of them moves it. applied + carried differs from the target.

    Raises
    ------
    ValueError : a triangle without area is worn.
    StepTooLargeError : a face turns over.

    Source: Y. Yan, TU Delft 2022, Eq 5.4-5.7.
    """
    worn = np.ones(len(triangles), dtype=bool) if worn is None else np.asarray(worn, dtype=bool)
    faces = triangles[worn]
    area = area_vectors(points, faces)
    size = np.sqrt((area**2).sum(axis=1))
    volume = volume_at_corners(worn_volume)[worn].sum(axis=1)
    if (volume[size == 0.0] > 0.0).any():
        raise ValueError("a triangle without area is worn, its depth is undefined; allowed are triangles with area")
    depth = np.divide(volume, size, out=np.zeros_like(volume), where=size > 0.0)
    unit = np.divide(area, size[:, None], out=np.zeros_like(area), where=size[:, None] > 0.0)
    motion = -sum_over_nodes(faces, depth[:, None] * unit, len(points))
    target = sum_over_nodes(faces, volume / 3.0, len(points))
    if carried_volume is not None:
        motion, target = motion + _carried_motion(faces, size, unit, carried_volume), target + carried_volume
    if directions is not None:
        length = np.linalg.norm(directions, axis=1, keepdims=True)
        along = np.maximum((motion * directions).sum(axis=1, keepdims=True), 0.0) * directions / length**2
        motion = np.where(np.isfinite(along), along, motion)
    step = np.sqrt((motion**2).sum(axis=1))
    share = np.ones(len(points)) if step_limit is None else _share(step, step_limit)
    motion = share[:, None] * motion
    moved = np.where((motion != 0.0).any(axis=1)[:, None], points + motion, points)
    if (turning := turning_nodes(points, moved, triangles, share * step)).any():
        raise StepTooLargeError(
            f"faces turn over at {np.count_nonzero(turning)} nodes, first at node {np.argmax(turning)}: scheme "
            "'per_triangle' has no guard against it (shorten the cycle, cap the steps or take 'conserving')"
        )
    applied = sum_over_nodes(faces, swept_volume(points, moved - points, faces) / 3.0, len(points))
    return Displacement(moved, share * step, applied, (1.0 - share) * target)


SCHEMES: dict[str, Scheme] = {"conserving": displace, "per_triangle": per_triangle}


def scheme_of(name: str) -> Scheme:
    """The scheme of that name. Raises ValueError that names the allowed ones."""
    if name not in SCHEMES:
        raise ValueError(f"scheme '{name}' is unknown, allowed are: {', '.join(sorted(SCHEMES))}")
    return SCHEMES[name]


def centroid_path_volume(
    points: np.ndarray, moved: np.ndarray, triangles: np.ndarray, counted: np.ndarray | None = None
) -> float:
    """Volume (m3) as Yan 2022 (Eq 5.8-5.10) counts it: area times path of the centroid, summed over triangles.

    Parameters: points (n, 3) m before and moved (n, 3) m after one update, triangles (m, 3); counted (m,) bool: the
    triangles to sum over, all by default. Sum it over the updates.

    Over all triangles it is the volume removed, where every centroid moves along its normal: Eq 5.10 taken at its word.
    Over those alone that were in contact during the update, which is as far as "the ith element" of Eq 5.3 goes, it
    leaves out what their neighbours lost when nodes in common were moved. That sum grows with the length of an update,
    in which more triangles are touched; the source updates in every time step.
    """
    chosen = triangles if counted is None else triangles[counted]
    path = np.linalg.norm((moved - points)[chosen].mean(axis=1), axis=1)
    return float(path @ np.linalg.norm(area_vectors(points, chosen), axis=1))


def _carried_motion(faces, size, unit, carried_volume) -> np.ndarray:
    """Motion (n, 3) m of volumes carried at nodes, shared among the triangles there by area: 3 V / A each."""
    around = sum_over_nodes(faces, size, len(carried_volume))
    normals = sum_over_nodes(faces, unit, len(carried_volume))
    factor = np.divide(-3.0 * carried_volume, around, out=np.zeros_like(around), where=around > 0.0)
    return factor[:, None] * normals


def _share(step: np.ndarray, step_limit: np.ndarray) -> np.ndarray:
    """Part (n,) of each step that its limit allows."""
    return np.divide(step_limit, step, out=np.ones_like(step), where=step > step_limit)
