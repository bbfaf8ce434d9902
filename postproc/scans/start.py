"""Where a scan lies, from nothing: rough positions of a point cloud on a surface, whatever the scanner's axes are.

A worn sample is flat and wide: the plane that most points lie near gives its normal up to the sign. All angles about
it, both signs and shifts within the plane are tried on a few points, the best ones are moved closer, and those that end
at different places are returned, best first. Outliers and holes are trimmed: the nearer part of the points moves it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from bulkwear.postproc.mesh import SurfaceMesh, areas, unit_normals

SURFACE_POINTS = 8000  # that stand for the surface
PLANES = 600  # planes through three random points that are tried
PLANE_POINTS = 1500  # by which they are judged
TRIAL_POINTS = 200  # of the scan, by which positions are judged before they are moved
STEP_POINTS = 500  # of the scan, by which positions are moved
ANGLES = 36  # about the normal, 10 degrees apart
SHIFTS = 7  # along each axis of the plane
SHIFT = 0.075  # -, of the surface's extent, between two shifts: less than half a bump's spacing on small samples
MOVED = 60  # positions that are moved closer
FEWEST = 6  # points that a step takes, as many as it has unknowns
STEPS = 30  # of moving closer, at most
STILL = 0.05  # -, of the misfit: a smaller gain in five steps ends the moving
CLEAR = 0.02  # -, of the extent: how much a point that does not fit counts in judging a position
FAR = 0.1  # -, of the extent: points farther away are all alike, and quickly told
NEARER = 0.75  # -, of the points count: up to a quarter may be outliers
APART = np.radians(4.0)  # positions that differ by less and by less than SHIFT are one
REACH = 0.15  # -, of the extent: thickness of the slab about the plane whose points give the centre


def rough_positions(scan: np.ndarray, mesh: SurfaceMesh, seed: int = 0) -> list[RigidMotion]:
    """Return motions that may put the scan (k, 3) m on the surface, best first, all different.

    Raises ValueError for fewer than 100 points: they show no shape.
    """
    if len(scan) < 100:
        raise ValueError(f"found {len(scan)} scanned points, allowed are 100 or more")
    generator = np.random.default_rng(seed)
    points, normals = points_on(mesh, SURFACE_POINTS, generator)
    tree = cKDTree(points)
    extent = float(np.ptp(points, axis=0).max())
    trial, step = (scan[generator.permutation(len(scan))[:count]] for count in (TRIAL_POINTS, STEP_POINTS))
    starts = _starts(scan, points, extent, generator)
    far = FAR * extent
    turned = (starts[first : first + SHIFTS**2] for first in range(0, len(starts), SHIFTS**2))
    placed = (np.stack([start(trial) for start in alike]) for alike in turned)
    misfits = np.concatenate([_misfit(_nearest(tree, each, far)[0]) for each in placed])
    moved = [_closer(starts[place], step, tree, normals, far) for place in np.argsort(misfits)[:MOVED]]
    moved.sort(key=lambda each: each[0])
    different: list[tuple[float, RigidMotion]] = []
    for misfit, motion in moved:
        if all(_apart(motion, other, scan, extent) for _, other in different):
            different.append((misfit, motion))
    return [motion for _, motion in different]


def points_on(mesh: SurfaceMesh, count: int, generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return points (count, 3) m at random, evenly over a surface, and its normals (count, 3) there."""
    area = areas(mesh.points, mesh.triangles)
    face = generator.choice(len(area), count, p=area / area.sum())
    weight = generator.dirichlet((1.0, 1.0, 1.0), count)
    points = np.einsum("ij,ijk->ik", weight, mesh.points[mesh.triangles[face]])
    return points, unit_normals(mesh.points, mesh.triangles)[face]


def _plane_near_most(points: np.ndarray, generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Unit normal (3,) and place (3,) m of the plane with the least median distance of points (k, 3) m.

    P. J. Rousseeuw, J. Am. Stat. Assoc. 79 (1984) 871: half of the points may be anything.
    """
    some = points[generator.permutation(len(points))[:PLANE_POINTS]]
    corners = points[generator.integers(len(points), size=(PLANES, 3))]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    if not length.any():
        raise ValueError("found scanned points in one place or on one line, allowed are points of a surface")
    normal, corners = normal[length > 0.0] / length[length > 0.0, None], corners[length > 0.0]
    away = np.abs(some @ normal.T - (corners[:, 0] * normal).sum(axis=1))
    best = int(np.argmin(np.median(away, axis=0)))
    near = np.sort(np.argsort(away[:, best])[: len(some) // 2])
    middle = some[near].mean(axis=0)
    return np.linalg.svd(some[near] - middle, full_matrices=False)[2][2], middle


def _centred(points: np.ndarray, extent: float, generator: np.random.Generator) -> RigidMotion:
    """The motion that lays the points' plane in z = 0 and their middle on the origin."""
    normal, place = _plane_near_most(points, generator)
    level = Rotation.align_vectors([[0.0, 0.0, 1.0]], [normal])[0].as_matrix()
    flat = (points - place) @ level.T
    near = flat[np.abs(flat[:, 2]) < REACH * extent]
    low, high = np.quantile(near[:, :2], (0.05, 0.95), axis=0)
    middle = np.array([*(0.5 * (low + high)), 0.0])
    return RigidMotion(level, -level @ place - middle)


def _starts(scan: np.ndarray, points: np.ndarray, extent: float, generator: np.random.Generator) -> list[RigidMotion]:
    """All positions that are tried."""
    of_scan, of_surface = _centred(scan, extent, generator), _centred(points, extent, generator).inverse
    places = SHIFT * extent * (np.arange(SHIFTS) - SHIFTS // 2)
    starts = []
    for over in (np.eye(3), np.diag([1.0, -1.0, -1.0])):
        for angle in 2.0 * np.pi / ANGLES * np.arange(ANGLES):
            turned = Rotation.from_euler("z", angle).as_matrix() @ over
            rotation = of_surface.rotation @ turned @ of_scan.rotation
            centre = of_surface.rotation @ (turned @ of_scan.translation) + of_surface.translation
            for x in places:
                starts += [RigidMotion(rotation, centre + of_surface.rotation @ (x, y, 0.0)) for y in places]
    return starts


def _nearer(distance: np.ndarray) -> np.ndarray:
    """Mask (..., k) of the points that count."""
    return distance <= np.quantile(distance, NEARER, axis=-1, keepdims=True)


def _misfit(distance: np.ndarray) -> np.ndarray:
    """Root mean square (...,) m of the nearer part of distances (..., k) m."""
    return np.sqrt(np.mean(distance**2, axis=-1, where=_nearer(distance)))


def _nearest(tree: cKDTree, placed: np.ndarray, far: float) -> tuple[np.ndarray, np.ndarray]:
    """Distance (..., k) m of points (..., k, 3) m, at most `far` (m), and number (..., k) of the nearest point of the
    tree; 0 where all are far.
    """
    distance, nearest = tree.query(placed, distance_upper_bound=far)
    return np.minimum(distance, far), np.where(nearest < tree.n, nearest, 0)


def _closer(
    motion: RigidMotion, scan: np.ndarray, tree: cKDTree, normals: np.ndarray, far: float
) -> tuple[float, RigidMotion]:
    """Move a position closer, point to plane, by the nearer part of the points; return its misfit (m2) and it."""
    misfits = []
    for _ in range(STEPS):
        placed = motion(scan)
        distance, nearest = _nearest(tree, placed, far)
        misfits.append(_misfit(distance))
        if len(misfits) > 5 and misfits[-1] > (1.0 - STILL) * misfits[-6]:
            break
        used = _nearer(distance) & (distance < far)
        if used.sum() < FEWEST:
            break
        step = plane_step(placed[used], tree.data[nearest[used]], normals[nearest[used]], np.ones(used.sum()))
        motion = step.after(motion)
    return truncated_misfit(distance, CLEAR / FAR * far), motion


def truncated_misfit(distance: np.ndarray, clear: float) -> float:
    """Return the mean square (m2) of distances (k,) m that count as `clear` (m) at most.

    It tells a position one row of bumps beside the right one, where the median of the distances is as small.
    """
    return float(np.mean(np.minimum(np.abs(distance), clear) ** 2))


def plane_step(placed: np.ndarray, nearest: np.ndarray, normal: np.ndarray, weight: np.ndarray) -> RigidMotion:
    """Return the small motion that takes points (k, 3) m closest to the planes through `nearest` (k, 3) m.

    normal: (k, 3) of the planes; weight: (k,). What the planes do not fix stays as it is.
    Source: K.-L. Low, TR04-004, University of North Carolina (2004).
    """
    matrix, centre, length = plane_equations(placed, normal)
    root = np.sqrt(weight)
    away = ((nearest - placed) * normal).sum(axis=1)
    found = np.linalg.lstsq(matrix * root[:, None], away * root, rcond=1e-6)[0]
    return turned_about(found[:3] / length, centre, found[3:])


def plane_equations(placed: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Return how far along its normal each point goes per unknown, (k, 6): rotation times length, translation (m).

    Also the centre (3,) m of the rotation, and that length (m), which makes all unknowns lengths.
    """
    centre = placed.mean(axis=0)
    spoke = placed - centre
    length = float(np.sqrt(np.mean((spoke**2).sum(axis=1)))) or 1.0
    return np.concatenate([np.cross(spoke, normal) / length, normal], axis=1), centre, length


def _apart(first: RigidMotion, second: RigidMotion, scan: np.ndarray, extent: float) -> bool:
    between = second.inverse.after(first)
    middle = scan.mean(axis=0, keepdims=True)
    return between.angle > APART or float(np.linalg.norm(first(middle) - second(middle))) > SHIFT * extent


@dataclass(frozen=True, eq=False)
class RigidMotion:
    """A rotation (3, 3) and then a translation (3,) m: x becomes rotation x + translation."""

    rotation: np.ndarray
    translation: np.ndarray

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Return moved points (k, 3) m."""
        return points @ self.rotation.T + self.translation

    def after(self, first: RigidMotion) -> RigidMotion:
        """Return the motion that does `first` and then this one."""
        return RigidMotion(self.rotation @ first.rotation, self(first.translation[None])[0])

    @property
    def inverse(self) -> RigidMotion:
        """The motion back."""
        return RigidMotion(self.rotation.T, -self.rotation.T @ self.translation)

    @property
    def angle(self) -> float:
        """Angle of the rotation, rad."""
        return float(Rotation.from_matrix(self.rotation).magnitude())


IDENTITY = RigidMotion(np.eye(3), np.zeros(3))


def turned_about(vector: np.ndarray, centre: np.ndarray, translation: np.ndarray) -> RigidMotion:
    """Return the rotation by `vector` (3,) rad about a centre (3,) m, followed by a translation (3,) m."""
    rotation = Rotation.from_rotvec(vector).as_matrix()
    return RigidMotion(rotation, centre - rotation @ centre + translation)


def largest_distance(first: RigidMotion, second: RigidMotion, points: np.ndarray) -> float:
    """Return how far apart two motions put any of the points (k, 3) m, at most, m."""
    return float(np.linalg.norm(first(points) - second(points), axis=1).max())
