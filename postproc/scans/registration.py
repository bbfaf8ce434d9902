"""Laying a scan on a surface by what did not wear: point to plane, robust, with an estimate of its error.

Points on the holder (label `part` -1), a margin away from what wears, decide; noise, outliers and holes are weighted
down (Tukey's biweight). How well those features hold the sample is computed, and a scan that they do not hold is
refused. Samples are symmetric: where the pristine surface looks the same in two positions, a point near the edge that
meets the bed first tells them apart.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, unit_normals, worn_faces
from bulkwear.postproc.scans.start import (
    IDENTITY,
    RigidMotion,
    largest_distance,
    plane_equations,
    plane_step,
    rough_positions,
    truncated_misfit,
    turned_about,
)
from bulkwear.postproc.wear.old_surface import OldSurface

HOLDER, EVERYTHING = "holder", "all"  # what may decide
RIM_MARGIN = 0.5e-3  # m, of the holder's surface beside what wears that does not count: there scans are round
FIRST_GATE, LEAST_GATE = 3e-3, 0.1e-3  # m, distance up to which points count, from rough to fine
GATE_SPREADS = 6.0  # -, spreads of the distances that the gate is wide
TUKEY = 4.685  # -, spreads from which on a point weighs nothing: 95 % efficient for normal noise
MEDIAN_TO_SPREAD = 1.4826  # -, of the median distance, for normal noise
LARGEST_STEPS = 60
STILL = 1e-7  # m, that a step moves the sample at most at the end
ROUGH_POINTS, ROUGH_STEPS, ROUGHLY_STILL = 2000, 20, 1e-6  # -, -, m
TRIED = 6  # rough positions that are looked at closely
CLEAR = 1e-3  # m, how much a point that does not fit counts in choosing between rough positions
WORST_SPREAD = 1.5e-3  # m, of the distances of all points, beyond which the scan is of something else
SYMMETRIC, MOST = 0.1e-3, 0.95  # m, distance from itself of that share of a surface after a symmetry: meshes differ
CELL = 5e-3  # m, within which a scanner's errors are taken as one error, so that more points do not help
FEWEST_POINTS = 200  # on the features that decide
LOOSEST = 0.5e-3  # m, error of the position beyond which a comparison says nothing
ZERO = 1e-12  # -, of the largest eigenvalue: what is less well held is not held


@dataclass(frozen=True)
class Registration:
    """A scan laid on a surface.

    motion: from the scan's own axes to the surface's; points: on the features that decided, weight above 0
    spread: m, of their distances, robust; uncertainty: m, of the worst place of what wears, one standard deviation
    deciding: what decided; symmetric: positions in which the surface looks the same, this one included
    """

    motion: RigidMotion
    points: int
    spread: float
    uncertainty: float
    deciding: str
    symmetric: int


def register(
    scan: np.ndarray,
    mesh: SurfaceMesh,
    accuracy: float,
    deciding: str = HOLDER,
    leading_edge: np.ndarray | None = None,
    tell: Callable[[str], None] = lambda text: None,
) -> Registration:
    """Lay a scan (k, 3) m, in any position, on a pristine surface whose bed arrives at its edge of least y.

    accuracy: of the scanner, m; deciding: "holder" (what did not wear) or "all" (everything, which takes even wear
    for a shift); leading_edge: (3,) m in the scan's axes, near the middle of the edge that meets the bed first
    Raises ValueError when there is no holder, nothing fits, symmetric positions are not told apart, or the position
    remains looser than `LOOSEST`.
    """
    surface = OldSurface(mesh.points, mesh.triangles)
    _deciding_faces(mesh, deciding)
    tell("looking for the sample in the scan")
    some = scan[:: max(len(scan) // ROUGH_POINTS, 1)]
    fits = [_rough_fit(some, surface, motion) for motion in rough_positions(scan, mesh)[:TRIED]]
    _, spread, motion = min(fits, key=lambda each: each[0])
    if spread > WORST_SPREAD:
        raise ValueError(
            f"the scan does not fit the surface: half of its points stay {1e3 * spread / MEDIAN_TO_SPREAD:.2g} mm or "
            f"more away, allowed are {1e3 * WORST_SPREAD / MEDIAN_TO_SPREAD:.2g}; check the unit, and crop what is "
            "not the sample"
        )
    motion, symmetric = _oriented(motion, mesh, surface, leading_edge)
    tell("laying it on what did not wear" if deciding == HOLDER else "laying it on all that is there")
    motion, placed, fitted = _fine_fit(scan, mesh, surface, deciding, motion)
    distance, normal = fitted[:, 0], fitted[:, 1:]
    spread = _spread(distance)
    error = position_error(placed, normal, accuracy, _box_corners(mesh))
    if error > LOOSEST:
        raise ValueError(
            f"what decides holds the sample to {1e3 * error:.2g} mm only, allowed are {1e3 * LOOSEST:.2g}: too few of "
            "its sides are scanned"
        )
    counted = int((_weights(distance, spread) > 0.0).sum())
    return Registration(motion, counted, spread, error, deciding, symmetric)


def _deciding_faces(mesh: SurfaceMesh, deciding: str) -> np.ndarray:
    """Mask (m,) of the faces whose points decide."""
    if deciding not in (HOLDER, EVERYTHING):
        raise ValueError(f"what decides is '{deciding}', allowed are {HOLDER} and {EVERYTHING}")
    if deciding == EVERYTHING:
        return np.ones(len(mesh.triangles), dtype=bool)
    if worn_faces(mesh).all():
        raise ValueError(
            f"the surface has no holder (label part -1) that did not wear, so only '{EVERYTHING}' can decide where the "
            "scan lies, which takes even wear for a shift"
        )
    return ~worn_faces(mesh)


def _spread(distance: np.ndarray) -> float:
    return float(MEDIAN_TO_SPREAD * np.median(np.abs(distance)))


def _weights(distance: np.ndarray, spread: float) -> np.ndarray:
    """Tukey's biweight (k,) of distances (k,) m."""
    share = np.clip(np.abs(distance) / (TUKEY * max(spread, STILL)), 0.0, 1.0)
    return (1.0 - share**2) ** 2


def _rough_fit(scan: np.ndarray, surface: OldSurface, motion: RigidMotion) -> tuple[float, float, RigidMotion]:
    """Move a position closer by all faces; return misfit (m2) and spread (m) of the distances of all points, and it."""
    normals = unit_normals(surface.points, surface.triangles)
    for _ in range(ROUGH_STEPS):
        placed = motion(scan)
        distance, face, nearest = surface.closest(placed)
        weight = _weights(distance, _spread(distance))
        step = plane_step(placed, nearest, normals[face], weight)
        motion = step.after(motion)
        if largest_distance(step, IDENTITY, placed[weight > 0.0]) < ROUGHLY_STILL:
            break
    return truncated_misfit(distance, CLEAR), _spread(distance), motion


def symmetries(mesh: SurfaceMesh, surface: OldSurface) -> list[RigidMotion]:
    """Return the quarter turns about the vertical through the middle of what wears that leave the surface as it is.

    The first is no turn. surface: the same mesh, to measure distances.
    """
    worn = mesh.points[np.unique(mesh.triangles[worn_faces(mesh)])]
    middle = np.array([*(0.5 * (worn.min(axis=0) + worn.max(axis=0)))[:2], 0.0])
    turns = [turned_about(np.array([0.0, 0.0, 0.5 * np.pi * k]), middle, np.zeros(3)) for k in range(4)]
    away = [np.abs(surface.closest(turn(mesh.points))[0]) for turn in turns]
    return [turn for turn, distance in zip(turns, away, strict=True) if np.quantile(distance, MOST) < SYMMETRIC]


def _oriented(
    motion: RigidMotion, mesh: SurfaceMesh, surface: OldSurface, leading_edge: np.ndarray | None
) -> tuple[RigidMotion, int]:
    """The position that is meant among those in which the surface looks the same, and how many these are."""
    alike = [turn.after(motion) for turn in symmetries(mesh, surface)]
    if leading_edge is not None:
        worn = mesh.points[np.unique(mesh.triangles[worn_faces(mesh)])]
        front = np.array([0.5 * (worn[:, 0].min() + worn[:, 0].max()), worn[:, 1].min()])
        alike.sort(key=lambda each: float(np.linalg.norm(each(leading_edge[None])[0, :2] - front)))
    elif len(alike) > 1:
        raise ValueError(
            f"the pristine surface looks the same in {len(alike)} positions, and the scan fits in all of them: give "
            "the leading edge, a scanned point near the middle of the edge that meets the bed first"
        )
    return alike[0], len(alike)


def _fine_fit(
    scan: np.ndarray, mesh: SurfaceMesh, surface: OldSurface, deciding: str, motion: RigidMotion
) -> tuple[RigidMotion, np.ndarray, np.ndarray]:
    """Move a position by what decides until it rests; return it, and distance (m) and normal of the points used."""
    normals = unit_normals(mesh.points, mesh.triangles)
    decides = _deciding_faces(mesh, deciding)
    worn = mesh.triangles[~decides]
    beside = OldSurface(mesh.points, worn) if len(worn) else None
    gate, corners = FIRST_GATE, _box_corners(mesh)
    distance, face, _ = surface.closest(motion(scan))
    scan = scan[decides[face] & (np.abs(distance) < 2.0 * gate)]
    for _ in range(LARGEST_STEPS):
        placed = motion(scan)
        distance, face, nearest = surface.closest(placed)
        used = decides[face] & (np.abs(distance) < gate)
        if beside is not None:
            used[used] = np.abs(beside.closest(placed[used])[0]) > RIM_MARGIN
        if used.sum() < FEWEST_POINTS:
            raise ValueError(
                f"{used.sum()} scanned points lie within {1e3 * gate:.2g} mm of what decides the position, "
                f"allowed are {FEWEST_POINTS} or more"
            )
        distance, spread = distance[used], _spread(distance[used])
        step = plane_step(placed[used], nearest[used], normals[face[used]], _weights(distance, spread))
        moved = largest_distance(step.after(motion), motion, motion.inverse(corners))
        motion, gate = step.after(motion), max(min(gate, GATE_SPREADS * spread), LEAST_GATE)
        if moved < STILL:
            break
    return motion, placed[used], np.column_stack([distance, normals[face[used]]])


def _box_corners(mesh: SurfaceMesh) -> np.ndarray:
    """Corners (8, 3) m of the box round what wears."""
    worn = mesh.points[np.unique(mesh.triangles[worn_faces(mesh)])]
    return np.stack(np.meshgrid(*np.stack([worn.min(axis=0), worn.max(axis=0)], axis=1)), axis=-1).reshape(-1, 3)


def position_error(placed: np.ndarray, normal: np.ndarray, accuracy: float, corners: np.ndarray) -> float:
    """Return how far the worst of the corners (c, 3) m may be off, one standard deviation, m.

    placed: (k, 3) m, points that decide, with the normals (k, 3) of the surface there; accuracy: m, of one error. All
    points of a cube of `CELL` share one error: a scanner's errors are not independent from point to point.
    """
    matrix, centre, length = plane_equations(placed, normal)
    cells = np.unique(np.floor(placed / CELL).astype(np.int64), axis=0)
    information = matrix.T @ matrix * (len(cells) / len(placed))
    values, vectors = np.linalg.eigh(information)
    if values[0] < ZERO * values[-1]:
        return float("inf")
    covariance = accuracy**2 * (vectors / values) @ vectors.T
    spoke = (corners - centre) / length
    errors = []
    for axis in np.eye(3):
        along = np.concatenate([np.cross(spoke, axis), np.broadcast_to(axis, spoke.shape)], axis=1)
        errors.append(np.einsum("ij,jk,ik->i", along, covariance, along))
    return float(np.sqrt(np.sum(errors, axis=0).max()))
