"""Plain bodies: a flat plate for pins and plain samples; sphere and box, closed surfaces of known volume."""

from __future__ import annotations

import math

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh


def base_labels(count: int) -> dict[str, np.ndarray]:
    """Labels of `count` triangles that all belong to the base: `part`, `column` and `row` 0, int64."""
    return {name: np.zeros(count, dtype=np.int64) for name in ("part", "column", "row")}


def _cells(length: float, element_size: float) -> int:
    """Number of equal cells in `length`, none longer than `element_size`; 1e-9 forgives rounding."""
    return max(1, math.ceil(length / element_size - 1e-9))


def flat_plate(width: float, length: float, element_size: float) -> SurfaceMesh:
    """A rectangle at z = 0, centred at the origin, normals up, every triangle labelled base.

    width: m, along x; length: m, along y; element_size: m, longest leg of the right-angled triangles.
    The diagonals alternate like a chessboard, so that no direction is preferred. Raises ValueError unless all
    arguments are > 0.
    """
    for name, value in (("width", width), ("length", length), ("element_size", element_size)):
        if not value > 0:
            raise ValueError(f"{name} of a plate must be greater than 0 m, found {value}")
    columns, rows = _cells(width, element_size), _cells(length, element_size)
    x, y = np.meshgrid(np.linspace(-width / 2, width / 2, columns + 1), np.linspace(-length / 2, length / 2, rows + 1))
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    quads = np.column_stack([corner, corner + 1, corner + columns + 2, corner + columns + 1])
    odd = (np.add.outer(np.arange(rows), np.arange(columns)) % 2).ravel()
    quads = np.where(odd[:, None] == 1, np.roll(quads, -1, axis=1), quads)
    triangles = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    return SurfaceMesh(points, triangles, base_labels(len(triangles)))


def _unit_icosahedron() -> tuple[np.ndarray, np.ndarray]:
    """Corners on the unit sphere (12, 3) and faces (20, 3), normals outward."""
    golden = (1 + math.sqrt(5)) / 2
    flat = [(-1, golden), (1, golden), (-1, -golden), (1, -golden)]
    corners = [np.roll((u, v, 0), shift) for shift in (0, 1, 2) for u, v in flat]
    faces = "0 11 5 0 5 1 0 1 7 0 7 10 0 10 11 1 5 9 5 11 4 11 10 2 10 7 6 7 1 8 "
    faces += "3 9 4 3 4 2 3 2 6 3 6 8 3 8 9 4 9 5 2 4 11 6 2 10 8 6 7 9 8 1"
    order = np.array([0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11])
    return np.array(corners) / math.hypot(1, golden), order[np.array(faces.split(), dtype=np.int64).reshape(-1, 3)]


def sphere(radius: float, subdivisions: int) -> SurfaceMesh:
    """A closed sphere about the origin: an icosahedron whose faces are quartered `subdivisions` times.

    radius: m; the nodes lie on the sphere, so the enclosed volume approaches 4/3 pi r^3 from below.
    """
    if not radius > 0:
        raise ValueError(f"radius of a sphere must be greater than 0 m, found {radius}")
    points, triangles = _unit_icosahedron()
    for _ in range(subdivisions):
        points, triangles = _quartered(points, triangles)
        points = points / np.linalg.norm(points, axis=1, keepdims=True)
    return SurfaceMesh(radius * points, triangles, base_labels(len(triangles)))


def _quartered(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split every triangle into four at the middles of its edges."""
    pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
    edges, inverse = np.unique(pairs, axis=0, return_inverse=True)
    middle = len(points) + inverse.reshape(-1, 3)
    first, second, third = triangles.T
    a, b, c = middle.T
    children = np.stack([first, a, c, a, second, b, c, b, third, a, b, c], axis=1).reshape(-1, 3)
    return np.concatenate([points, points[edges].mean(axis=1)]), children


def closed_box(width: float, length: float, height: float, element_size: float) -> SurfaceMesh:
    """A closed box standing on z = 0, centred at x = y = 0, normals outward. All arguments in m.

    Its volume is width x length x height exactly, its nodes on the edges are shared.
    """
    sides = []
    for first, second, third in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        size = (width, length, height)
        plate = flat_plate(size[first], size[second], element_size)
        for sign in (-1, 1):
            points = np.empty_like(plate.points)
            points[:, first], points[:, second] = plate.points[:, 0], plate.points[:, 1]
            points[:, third] = sign * size[third] / 2
            sides.append((points, plate.triangles if sign > 0 else plate.triangles[:, ::-1]))
    starts = np.cumsum([0] + [len(points) for points, _ in sides[:-1]])
    points = np.concatenate([points for points, _ in sides])
    triangles = np.concatenate([tri + start for (_, tri), start in zip(sides, starts, strict=True)])
    points, inverse = np.unique(points, axis=0, return_inverse=True)  # the same linspace on both sides: bit-equal
    points[:, 2] += height / 2
    return SurfaceMesh(points, inverse.reshape(-1)[triangles], base_labels(len(triangles)))
