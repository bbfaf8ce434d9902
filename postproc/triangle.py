"""Compiled arithmetic of single faces, for loops over them.

Triples are tuples or arrays of three. Modules that call these keep compiled copies of them: numba compiles those anew
only where their own files change.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit


@njit(cache=True)
def cross(a, b):
    """Cross product of two triples."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(cache=True)
def dot(a, b):
    """Scalar product of two triples."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def between(points, start, end):
    """Vector (a triple, m) from one node to another."""
    return (
        points[end, 0] - points[start, 0],
        points[end, 1] - points[start, 1],
        points[end, 2] - points[start, 2],
    )


@njit(cache=True)
def between_places(start, end):
    """Vector (a triple, m) from one place to another."""
    return end[0] - start[0], end[1] - start[1], end[2] - start[2]


@njit(cache=True)
def area_vector(points, face):
    """Outward normal times area of a face (3,) of nodes, a triple in m2."""
    x, y, z = cross(between(points, face[0], face[1]), between(points, face[0], face[2]))
    return 0.5 * x, 0.5 * y, 0.5 * z


@njit(cache=True)
def smallest_angle(points, face) -> float:
    """Smallest interior angle of a face, degrees, as `postproc.mesh.smallest_angles`."""
    least = np.inf
    for k in range(3):
        forward = between(points, face[k], face[(k + 1) % 3])
        backward = between(points, face[k], face[(k + 2) % 3])
        normal = cross(forward, backward)
        least = min(least, math.atan2(math.sqrt(dot(normal, normal)), dot(forward, backward)) * (180.0 / math.pi))
    return least
