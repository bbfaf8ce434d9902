"""Surfaces of simple bodies for tests of wear: sheets over a grid, boxes, thick cones, drums with lifters."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from bulkwear.postproc.mesh import SurfaceMesh


def sheet(u: np.ndarray, v: np.ndarray, place: Callable[[np.ndarray, np.ndarray], tuple]) -> SurfaceMesh:
    """Open sheet over the grid of parameters u and v; place(u, v) -> x, y, z in m. Normals along du x dv."""
    a, b = np.meshgrid(u, v, indexing="ij")
    points = np.stack(np.broadcast_arrays(*place(a, b)), axis=-1).reshape(-1, 3).astype(np.float64)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(len(u) - 1), np.arange(len(v) - 1), indexing="ij"))
    corner, across = i * len(v) + j, len(v)
    quads = np.stack([corner, corner + across, corner + across + 1, corner + 1], axis=1)
    odd = (i + j) % 2 == 1  # diagonals to and fro, so that no direction is favoured
    first = np.where(odd[:, None], quads[:, [0, 1, 3]], quads[:, [0, 1, 2]])
    second = np.where(odd[:, None], quads[:, [1, 2, 3]], quads[:, [0, 2, 3]])
    return SurfaceMesh(points, np.concatenate([first, second]))


def plate(length: float, width: float, cells: int) -> SurfaceMesh:
    """Flat plate (m) at z = 0, normals up."""
    return sheet(
        np.linspace(0.0, length, cells + 1), np.linspace(0.0, width, cells + 1), lambda x, y: (x, y, np.zeros_like(x))
    )


def worn_plate(depth: float) -> SurfaceMesh:
    """Return a plate of 20 by 10 mm in two triangles, 1 mm higher at its end, worn to a depth (m)."""
    points = 1e-3 * np.array([[0, 0, 0], [20, 0, 0], [20, 10, 1], [0, 10, 1]], dtype=float)
    nodes = {"removed_thickness_m": np.full(4, depth), "carried_volume_m3": np.zeros(4)}
    cells = {"part": np.zeros(2, dtype=int), "worn_volume_m3": np.full(2, 1e-12)}
    return SurfaceMesh(points, np.array([[0, 1, 2], [0, 2, 3]]), cells, nodes)


def welded(*meshes: SurfaceMesh, digits: int = 12, labels: bool = False) -> SurfaceMesh:
    """Several meshes as one with equal points shared; labels: each mesh is a part, 0, 1, ..."""
    points = np.concatenate([mesh.points for mesh in meshes])
    starts = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    triangles = np.concatenate([mesh.triangles + start for mesh, start in zip(meshes, starts, strict=False)])
    _, first, inverse = np.unique(np.round(points, digits) + 0.0, axis=0, return_index=True, return_inverse=True)
    part = np.repeat(np.arange(len(meshes)), [len(mesh.triangles) for mesh in meshes])
    return SurfaceMesh(points[first], inverse.ravel()[triangles], {"part": part} if labels else {})


def box(lengths: tuple[float, float, float], cells: int, inward: bool = False) -> SurfaceMesh:
    """Closed box (m) from the origin, normals out of it, or into it for a cavity."""
    size, faces = np.asarray(lengths), []
    ticks = [np.linspace(0.0, length, cells + 1) for length in size]
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for far in (False, True):
            level = size[axis] if far else 0.0

            def place(a, b, axis=axis, u=u, v=v, level=level):
                x = [None, None, None]
                x[axis], x[u], x[v] = np.full_like(a, level), a, b
                return x

            side = sheet(ticks[u], ticks[v], place)
            faces.append(side if far else flipped(side))
    closed = welded(*faces)
    return flipped(closed) if inward else closed


def flipped(mesh: SurfaceMesh) -> SurfaceMesh:
    """The mesh with all normals turned."""
    return SurfaceMesh(mesh.points, mesh.triangles[:, [0, 2, 1]], mesh.cell_data, mesh.point_data)


def shifted(mesh: SurfaceMesh, by: tuple[float, float, float]) -> SurfaceMesh:
    """The mesh moved by a vector (m)."""
    return SurfaceMesh(mesh.points + np.asarray(by), mesh.triangles, mesh.cell_data, mesh.point_data)


def moved_rigidly(mesh: SurfaceMesh, angles: tuple[float, float, float], by: tuple[float, float, float]) -> SurfaceMesh:
    """The mesh turned by three angles (rad) about x, y and z, then moved by a vector (m)."""
    points = Rotation.from_euler("xyz", angles).apply(mesh.points) + np.asarray(by)
    return SurfaceMesh(points, mesh.triangles, mesh.cell_data, mesh.point_data)


def cone(radius: float, height: float, slope: float, around: int, along: int, inward: bool) -> SurfaceMesh:
    """Frustum (m) about z, `radius` at z = 0, walls `slope` rad off the vertical, wider above; inward: to the axis."""
    angle = np.linspace(0.0, 2.0 * np.pi, around + 1)
    angle[-1] = 0.0
    mesh = sheet(
        angle,
        np.linspace(0.0, height, along + 1),
        lambda a, z: ((radius + z * np.tan(slope)) * np.cos(a), (radius + z * np.tan(slope)) * np.sin(a), z),
    )
    closed = welded(mesh)
    return flipped(closed) if inward else closed


def drum_with_lifters(
    radius: float, lifters: int, height: float, width: float, length: float, cells: int
) -> tuple[SurfaceMesh, np.ndarray]:
    """Inner surface of a drum (m) about y with bar lifters, normals to the axis, and the mask of the lifters' tops.

    The shell is a polygon of two chords between bars; height, width: of the bars, radially and round; `cells`: on each
    straight piece of the outline and along the drum.
    """
    corners, tops = [], []
    for number in range(lifters):
        turn = 2.0 * np.pi * number / lifters
        foot = np.sqrt(radius**2 - (0.5 * width) ** 2)
        profile = [
            (-0.5 * width, foot),
            (-0.5 * width, foot - height),
            (0.5 * width, foot - height),
            (0.5 * width, foot),
        ]
        half = turn + np.pi / lifters
        turned = [(x * np.cos(turn) + z * np.sin(turn), z * np.cos(turn) - x * np.sin(turn)) for x, z in profile]
        corners += [*turned, (radius * np.sin(half), radius * np.cos(half))]
        tops += [False, True, False, False, False]
    outline, top = [], []
    for (start, end), flag in zip(zip(corners, corners[1:] + corners[:1], strict=True), tops, strict=True):
        share = np.arange(cells)[:, None] / cells
        outline.append(np.array(start) + share * (np.array(end) - np.array(start)))
        top += [flag] * cells
    ring = np.concatenate([*outline, outline[0][:1]])
    y = np.linspace(0.0, length, cells + 1)
    number = np.arange(len(ring))
    mesh = sheet(number, y, lambda k, b: (ring[k.astype(int), 0], b, ring[k.astype(int), 1]))
    segment = np.repeat(np.arange(len(ring) - 1), cells)
    mask = np.array(top)[np.concatenate([segment, segment])]
    return flipped(welded(mesh)), mask
