"""Plane triangulation round prescribed nodes: a rectangle with holes, and a frame outside it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import ModuleType

import numpy as np

from bulkwear.meshes.gmsh_model import gmsh_model
from bulkwear.postproc.mesh import area_vectors

GROWTH = 0.3  # growth of an edge per distance from a hole
FRAME_EDGES = 2  # edges across the frame when it is wide: coarse, for nobody looks at its wear


@dataclass(frozen=True, eq=False)
class PlaneMesh:
    """Nodes (n, 2) m, the prescribed ones first, in order; triangles of base (m, 3) and frame (s, 3)."""

    points: np.ndarray
    base: np.ndarray
    frame: np.ndarray


def rectangle_rim(width: float, length: float, element_size: float) -> np.ndarray:
    """Nodes on a rectangle about the origin, anticlockwise from the corner at -x, -y, (r, 2); all in m."""
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (width / 2, length / 2)
    sides = []
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        count = max(1, math.ceil(np.abs(end - start).max() / element_size - 1e-9))  # 1e-9: rounding in the ratio
        sides.append(np.linspace(start, end, count, endpoint=False))
    return np.concatenate(sides)


def mesh_plane(
    rim: np.ndarray, holes: np.ndarray, element_size: float, frame_width: float, fine_frame: bool = False
) -> PlaneMesh:
    """Triangulate the rectangle within `rim` (r, 2) round `holes` (k, f, 2), and a frame of `frame_width`.

    The nodes begin with those of the rim, then those of the holes, bit for bit as given. Lengths in m;
    a `frame_width` of 0 means no frame. A fine frame has the elements of the rectangle, for one that will be curved.
    """
    frame_size = element_size if fine_frame else max(element_size, frame_width / FRAME_EDGES)
    prescribed = np.concatenate([rim, holes.reshape(-1, 2)])
    with gmsh_model() as gmsh:
        tags = [gmsh.model.geo.addPoint(x, y, 0.0, element_size) for x, y in prescribed.tolist()]
        loops = _polygons(gmsh, tags, [len(rim)] + [holes.shape[1]] * len(holes))
        surfaces = [gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(loop) for loop in loops])]
        if frame_width > 0:
            surfaces += _frame(gmsh, rim, tags, loops[0], frame_size, frame_width)
        gmsh.model.geo.synchronize()
        for line in (line for loop in loops for line in loop):
            gmsh.model.mesh.setTransfiniteCurve(line, 2)  # one edge: the prescribed nodes and no others
        gmsh.option.setNumber("Mesh.MeshSizeMax", frame_size)
        _grade(gmsh, surfaces[0], tags[len(rim) :], holes, element_size)
        gmsh.model.mesh.generate(2)
        node_tags, points, _ = gmsh.model.mesh.getNodes()
        first = np.concatenate([gmsh.model.mesh.getNodes(0, tag)[0] for tag in tags])
        cells = [gmsh.model.mesh.getElementsByType(2, surface)[1] for surface in surfaces]
    return _numbered(prescribed, first, node_tags, points.reshape(-1, 3)[:, :2], cells)


def _grade(gmsh: ModuleType, base: int, feet: list[int], holes: np.ndarray, element_size: float) -> None:
    """Let edges of the base grow from the spacing of the holes' nodes to the element size, at rate GROWTH."""
    if not feet:
        return
    spacing = min(element_size, float(np.linalg.norm(np.diff(holes[0], axis=0), axis=1).max()))
    field = gmsh.model.mesh.field
    distance, size, restricted = field.add("Distance"), field.add("Threshold"), field.add("Restrict")
    field.setNumbers(distance, "PointsList", feet)
    field.setNumber(size, "InField", distance)
    field.setNumber(size, "SizeMin", spacing)
    field.setNumber(size, "SizeMax", element_size)
    field.setNumber(size, "DistMin", spacing / 2)
    field.setNumber(size, "DistMax", spacing / 2 + (element_size - spacing) / GROWTH + 1e-9 * element_size)
    field.setNumber(restricted, "InField", size)
    field.setNumbers(restricted, "SurfacesList", [base])
    field.setAsBackgroundMesh(restricted)
    gmsh.model.mesh.setSizeFromBoundary(2, base, 0)  # else small feet would refine the whole base


def _polygons(gmsh: ModuleType, tags: list[int], counts: list[int]) -> list[list[int]]:
    """Closed polygons of straight lines through consecutive points, `counts` points each: their line tags."""
    loops, start = [], 0
    for count in counts:
        ring = tags[start : start + count]
        pairs = zip(ring, [*ring[1:], ring[0]], strict=True)
        loops.append([gmsh.model.geo.addLine(first, second) for first, second in pairs])
        start += count
    return loops


def _frame(
    gmsh: ModuleType,
    rim: np.ndarray,
    tags: list[int],
    rim_lines: list[int],
    outer_size: float,
    width: float,
) -> list[int]:
    """Four trapezoids round the rim that meet in the corners' diagonals: surface tags."""
    corner = np.flatnonzero((np.abs(rim) == rim.max(axis=0)).all(axis=1)).tolist()  # in the rim's order
    outside = rim[corner] + np.sign(rim[corner]) * width
    outer = [gmsh.model.geo.addPoint(x, y, 0.0, outer_size) for x, y in outside.tolist()]
    spokes = [gmsh.model.geo.addLine(tags[c], o) for c, o in zip(corner, outer, strict=True)]
    surfaces = []
    for side, after in enumerate((1, 2, 3, 0)):
        edge = gmsh.model.geo.addLine(outer[side], outer[after])
        end = corner[after] if after else len(rim)
        inner = [-line for line in reversed(rim_lines[corner[side] : end])]
        loop = gmsh.model.geo.addCurveLoop([spokes[side], edge, -spokes[after], *inner])
        surfaces.append(gmsh.model.geo.addPlaneSurface([loop]))
    return surfaces


def _numbered(
    prescribed: np.ndarray, first: np.ndarray, tags: np.ndarray, points: np.ndarray, cells: list[np.ndarray]
) -> PlaneMesh:
    """Renumber gmsh's nodes so that the prescribed ones come first, and turn every triangle up."""
    order = np.concatenate([first, np.setdiff1d(tags, first)])
    index = np.empty(int(tags.max()) + 1, dtype=np.int64)
    index[order] = np.arange(len(order))
    plane = np.empty((len(order), 2))
    plane[index[tags]] = points
    plane[: len(prescribed)] = prescribed
    surfaces = [_facing_up(plane, index[cell].reshape(-1, 3)) for cell in cells]
    return PlaneMesh(plane, surfaces[0], np.concatenate([np.empty((0, 3), dtype=np.int64), *surfaces[1:]]))


def _facing_up(plane: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The triangles, those that face down turned over."""
    down = area_vectors(np.column_stack([plane, np.zeros(len(plane))]), triangles)[:, 2] < 0
    return np.where(down[:, None], triangles[:, ::-1], triangles)
