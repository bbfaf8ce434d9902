"""The shell of one shape of a pattern: a height over its foot, with nodes evenly spaced along the foot's outline.

A shape is meshed in the plane, unrolled along its profile so that walls get as many elements as their slope is long,
then lifted and relaxed. Where its slope jumps (its creases) it is meshed piece by piece, so that nodes lie there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from bulkwear.meshes.plane import mesh_plane
from bulkwear.meshes.relax import relax
from bulkwear.postproc.mesh import areas

Shell = tuple[np.ndarray, np.ndarray, int]  # points (p, 3) m, triangles (t, 3), number of nodes on the foot: the first
Height = Callable[[np.ndarray, np.ndarray], np.ndarray]  # of places x, y (m): m over the plane

FINE_EDGES = 4  # edges along the smaller radius of the foot that are fine enough: 26 or more round the foot
COARSE_EDGES = 2  # fewest edges along the smaller radius of the foot: 12 or more round the foot
SWEEPS = 60  # of relaxation; angles stop improving after about 40
ARC_SAMPLES = 20_001  # points on the foot from which arc length is summed; its error is below 1e-8
PROFILE_SAMPLES, DIRECTIONS = 1001, 64  # points of a profile from the centre to the foot, and profiles
NEAR = 1e-4  # of the foot's radius: how far apart heights are compared for a slope


def shell_element_size(half_width: float, half_length: float, element_size: float) -> float:
    """Edge length on a shape (m): the element size, halved on small ones.

    With r the foot's smaller radius: elements up to r/4 are used as they are; longer ones are shortened to
    r/4, but to no less than half the element size; on no account are they longer than r/2.
    """
    radius = min(half_width, half_length)
    return min(element_size, max(element_size / 2, radius / FINE_EDGES), radius / COARSE_EDGES)


def foot_nodes(half_width: float, half_length: float, element_size: float) -> np.ndarray:
    """Nodes on the foot ellipse, evenly spaced in arc length, anticlockwise from +x, (f, 2) m; f is even."""
    angle = np.linspace(0.0, 2 * math.pi, ARC_SAMPLES)
    steps = np.hypot(half_width * np.diff(np.cos(angle)), half_length * np.diff(np.sin(angle)))
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    count = 2 * math.ceil(arc[-1] / element_size / 2)
    at = np.interp(np.arange(count) * arc[-1] / count, arc, angle)
    return np.column_stack([half_width * np.cos(at), half_length * np.sin(at)])


def height_area(half_width: float, half_length: float, height: Height) -> float:
    """Area (m2) of a height over an ellipse with these radii (m)."""
    profiles = _profiles(half_width, half_length, height)
    inner, outer = profiles[:-1], profiles[1:]
    first = np.stack([inner, outer, np.roll(outer, -1, axis=1)], axis=2)
    second = np.stack([inner, np.roll(outer, -1, axis=1), np.roll(inner, -1, axis=1)], axis=2)
    corners = np.concatenate([first, second]).reshape(-1, 3)
    return float(areas(corners, np.arange(len(corners)).reshape(-1, 3)).sum())


def height_shell(
    half_width: float, half_length: float, height: Height, creases: Sequence[float], element_size: float
) -> Shell:
    """Mesh a height over the ellipse with these radii; lengths in m.

    creases: sizes of its outline over the ellipse itself (-), above 0 and below 1, along which the slope jumps.
    Points lie on the surface, triangles have normals up, the first nodes are `foot_nodes` at z = 0.
    """
    radii = np.array([half_width, half_length])
    unrolled = _unrolled(half_width, half_length, height)
    sizes = [1.0, *sorted(creases, reverse=True)]
    edges = [min(element_size, size * radii.min() / COARSE_EDGES) for size in sizes]
    rings = [foot_nodes(*(size * radii), edge) for size, edge in zip(sizes, edges, strict=True)]
    points, triangles, outer = _lifted(rings[0], height), np.empty((0, 3), dtype=np.int64), np.arange(len(rings[0]))
    points[:, 2] = 0.0
    for ring, hole in zip(rings, [*rings[1:], None], strict=True):
        holes = np.empty((0, 1, 2)) if hole is None else _scaled(hole, radii, *unrolled)[None]
        flat = mesh_plane(_scaled(ring, radii, *unrolled), holes, element_size, 0.0)
        free = _scaled(flat.points[len(ring) + holes.shape[0] * holes.shape[1] :], radii, *unrolled[::-1])
        inner = np.empty((0, 2)) if hole is None else hole
        piece = np.concatenate([points[outer], _lifted(np.concatenate([inner, free]), height)])
        fixed = np.arange(len(piece)) < len(ring) + len(inner)
        piece, faces = relax(piece, flat.base, fixed, lambda at: _on_surface(at, height, NEAR * radii.min()), SWEEPS)
        number = np.concatenate([outer, len(points) + np.arange(len(piece) - len(outer))])
        points = np.concatenate([points, piece[len(outer) :]])
        triangles = np.concatenate([triangles, number[faces]])
        outer = number[len(ring) : len(ring) + len(inner)]
    return points, triangles, len(rings[0])


def _profiles(half_width: float, half_length: float, height: Height) -> np.ndarray:
    """Points of the surface (PROFILE_SAMPLES, DIRECTIONS, 3) m from the centre out to the foot."""
    out = np.linspace(0.0, 1.0, PROFILE_SAMPLES)[:, None]
    angle = 2.0 * math.pi * np.arange(DIRECTIONS) / DIRECTIONS
    x, y = half_width * out * np.cos(angle), half_length * out * np.sin(angle)
    return np.stack([x, y, height(x, y)], axis=-1)


def _unrolled(half_width: float, half_length: float, height: Height) -> tuple[np.ndarray, np.ndarray]:
    """Sizes of outlines over the foot's (-), and what they become when profiles are unrolled, their mean."""
    steps = np.diff(_profiles(half_width, half_length, height), axis=0)
    along, flat = np.linalg.norm(steps, axis=-1), np.linalg.norm(steps[..., :2], axis=-1)
    out = np.linspace(0.0, 1.0, PROFILE_SAMPLES)
    return out, np.concatenate([[0.0], np.cumsum((along / flat).mean(axis=1))]) / (PROFILE_SAMPLES - 1)


def _scaled(places: np.ndarray, radii: np.ndarray, old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Places (k, 2) m moved along the ray from the centre, from outlines of old sizes (-) on to those of new ones."""
    size = np.linalg.norm(places / radii, axis=1, keepdims=True)
    return places * np.divide(np.interp(size, old, new), size, out=np.ones_like(size), where=size > 0.0)


def _lifted(places: np.ndarray, height: Height) -> np.ndarray:
    return np.column_stack([places, height(*places.T)])


def _on_surface(points: np.ndarray, height: Height, near: float) -> np.ndarray:
    """Points near the surface moved on to it: two Newton steps along its normal, the rest upright."""
    x, y, z = points.T
    for _ in range(2):
        slope_x = (height(x + near, y) - height(x - near, y)) / (2.0 * near)
        slope_y = (height(x, y + near) - height(x, y - near)) / (2.0 * near)
        away = (z - height(x, y)) / (1.0 + slope_x**2 + slope_y**2)
        x, y, z = x + away * slope_x, y + away * slope_y, z - away
    return np.column_stack([x, y, height(x, y)])
