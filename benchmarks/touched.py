"""How many triangles of a mesh a sphere touches at once, by geometry alone.

A triangle is touched if it comes closer to the centre than the radius, be it with an edge or a corner only. On a
surface that is convex and made of flat triangles a large sphere rests on corners, where six of them meet; on a flat
surface what it touches grows with its overlap only.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.spatial import cKDTree

HALVINGS = 26  # of the stretch in which a sphere meets the surface: 1.5e-8 of it
NEAREST = 40  # triangles about a contact that are looked at; six meet in a corner


def near_distances(centres: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return the distances of each centre, (n, 3) m, from the NEAREST triangles about it: (n, k) m, in no order.

    corners: (m, 3, 3) m, of triangles that are small beside a sphere that touches the surface: its nearest ones are
    then among those whose middles are nearest
    """
    near = cKDTree(corners.mean(axis=1)).query(centres, min(NEAREST, len(corners)))[1].reshape(len(centres), -1)
    return distances(centres[:, None], corners[near])


def distances(centres: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return the distance (m) of each centre, (..., 3) m, from its triangle, (..., 3, 3) m.

    To the plane where the foot of the perpendicular lies within the triangle, else to the nearest edge.
    """
    edges = np.roll(corners, -1, axis=-2) - corners
    normals = np.cross(edges[..., 0, :], edges[..., 1, :])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    away = centres[..., None, :] - corners  # from each corner
    height = np.abs((away[..., 0, :] * normals).sum(axis=-1))
    within = ((away * np.cross(normals[..., None, :], edges)).sum(axis=-1) >= 0.0).all(axis=-1)
    along = (away * edges).sum(axis=-1) / (edges**2).sum(axis=-1)
    beside = away - np.clip(along, 0.0, 1.0)[..., None] * edges
    return np.where(within, height, np.sqrt((beside**2).sum(axis=-1).min(axis=-1)))


def touched(
    start: np.ndarray, end: np.ndarray, radius: float, overlap: float, corners: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return for each sphere whether it meets the surface on its straight way, and how many triangles it then touches.

    start, end: (n, 3) m, places of the centre, the first clear of the surface; radius: m
    overlap: m, over which the sphere is pressed into the nearest triangle; corners: (m, 3, 3) m, of a convex surface,
    whose distance along the way therefore crosses radius less overlap once at most
    """
    depth = radius - overlap
    meets = near_distances(end, corners).min(axis=1) < depth
    start, end = start[meets], end[meets]
    low, high = np.zeros(len(start)), np.ones(len(start))
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        clear = near_distances(start + middle[:, None] * (end - start), corners).min(axis=1) > depth
        low, high = np.where(clear, middle, low), np.where(clear, high, middle)
    found = near_distances(start + low[:, None] * (end - start), corners)
    return meets, (found < radius).sum(axis=1)


def met_from_the_front(
    half_width: float, height: float, reach: float, radius: float, count: int, random: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Return start and end, (count, 3) m each, of spheres that a bump at the origin meets as it moves along y.

    Evenly spread over the width in which they can touch it and from the floor (z = 0) to the bump's `height` (m);
    half_width: m, of the bump; reach: m, its half length
    """
    place = np.column_stack(
        [
            random.uniform(-1.0, 1.0, count) * (half_width + radius),
            np.full(count, -(reach + 2.0 * radius)),
            radius + random.uniform(0.0, 1.0, count) * height,
        ]
    )
    return place, place * (1.0, 0.0, 1.0)


def met_from_above(
    half_width: float, height: float, reach: float, radius: float, count: int, random: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Return start and end of spheres that sink on to the bump, down to the floor; arguments as above."""
    across, along = (random.uniform(-1.0, 1.0, count) * (half + radius) for half in (half_width, reach))
    start = np.column_stack([across, along, np.full(count, height + 2.0 * radius)])
    return start, np.column_stack([across, along, np.full(count, radius)])


def mean_touched(
    way: Callable[..., tuple[np.ndarray, np.ndarray]],
    shape: tuple[float, float, float],
    radius: float,
    overlap: float,
    corners: np.ndarray,
    count: int,
    seed: int = 1,
) -> float:
    """Return how many triangles of a bump a sphere that meets it touches, mean of those of `count` random ones.

    way: of the spheres, one of the two above; shape: m, half width, height and half length of the bump
    """
    start, end = way(*shape, radius, count, np.random.default_rng(seed))
    found = touched(start, end, radius, overlap, corners)[1]
    return float(found.mean()) if len(found) else math.nan


def mean_touched_on_flat(radius: float, overlap: float, corners: np.ndarray, count: int, seed: int = 1) -> float:
    """Return the same of spheres that rest at random places in the middle of a flat surface at z = 0."""
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    across = np.random.default_rng(seed).uniform(0.25, 0.75, (count, 2))
    centres = np.column_stack([low[:2] + across * (high - low)[:2], np.full(count, radius - overlap)])
    return float((near_distances(centres, corners) < radius).sum(axis=1).mean())
