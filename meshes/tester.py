"""The circular wear tester (Yan 2022, Fig 6.2 and 6.6): trough of an annular bed, submerged sample, consolidator.

The bed turns anticlockwise about the z axis, seen from above, on a floor at z = 0. The sample's own frame is that of
all samples: its top at z = 0, the bed moving to +y, so that +x points outwards where it stands in the trough. Walls and
consolidator have the label `part` -1: they do not wear.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from bulkwear.meshes.lattice import Pattern
from bulkwear.meshes.plane import mesh_plane
from bulkwear.meshes.sample import check_depth, sample_top
from bulkwear.postproc.mesh import HOLDER_PART, SurfaceMesh, boundary_edges

WHOLE_TURN = 2.0 * math.pi
NO_HOLES = np.empty((0, 1, 2))
ROUNDING = 1e-9  # relative, of a length over the element size and of a whole turn


def _steps(length: float, element_size: float) -> int:
    """Number of equal pieces of a length, none longer than the element size."""
    return max(1, math.ceil(length / element_size - ROUNDING))


def _checked(**lengths: float) -> None:
    for name, value in lengths.items():
        if not (math.isfinite(value) and value > 0.0):
            raise ValueError(f"{name} of the tester must be greater than 0 m, found {value}")


def _check_ring(inner_radius: float, outer_radius: float) -> None:
    if not 0.0 < inner_radius < outer_radius:
        raise ValueError(f"radii of the tester must be 0 < inner < outer, found {inner_radius} m and {outer_radius} m")


def turn_angles(radius: float, element_size: float, start: float = 0.0, end: float = WHOLE_TURN) -> np.ndarray:
    """Return angles (k,) rad of nodes from start to end, whose chords at `radius` (m) are no longer than an element.

    A whole turn has its first angle again as the last one. The chords lie up to element_size^2 / 8 radius inside their
    circle. Raises ValueError unless start < end <= start + 2 pi.
    """
    if not 0.0 < end - start <= (1.0 + ROUNDING) * WHOLE_TURN:
        raise ValueError(f"angles of the tester must be start < end <= start + 2 pi, found {start} and {end} rad")
    return np.linspace(start, end, _steps(radius * (end - start), element_size) + 1)


def _grid(x: np.ndarray, y: np.ndarray, z: np.ndarray, closed: bool) -> tuple[np.ndarray, np.ndarray]:
    """Points and triangles of a grid (a, b) of nodes, a closed one with its last row of nodes being its first.

    Normals point to the side from which the first index runs anticlockwise round a centre on the side of b = 0.
    """
    if closed:
        x, y, z = x[:-1], y[:-1], z[:-1]
    rows, columns = x.shape
    node = np.arange(rows * columns).reshape(rows, columns)
    after = np.roll(node, -1, axis=0)
    if not closed:
        node, after = node[:-1], after[:-1]
    quads = np.stack([node[:, :-1], node[:, 1:], after[:, 1:], after[:, :-1]], axis=-1)
    odd = np.add.outer(np.arange(quads.shape[0]), np.arange(quads.shape[1])) % 2 == 1
    quads = np.where(odd[:, :, None], np.roll(quads, -1, axis=2), quads)  # diagonals alternate like a chessboard
    return np.column_stack([x.ravel(), y.ravel(), z.ravel()]), quads[:, :, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def _unworn(points: np.ndarray, triangles: np.ndarray) -> SurfaceMesh:
    count = len(triangles)
    labels = {"part": np.full(count, HOLDER_PART), "column": np.zeros(count, int), "row": np.zeros(count, int)}
    return SurfaceMesh(points, triangles, {name: label.astype(np.int64) for name, label in labels.items()})


def annular_surface(
    inner_radius: float, outer_radius: float, angles: np.ndarray, heights: np.ndarray, element_size: float
) -> SurfaceMesh:
    """A surface right across the trough whose height depends on the angle alone, normals up; all in m and rad.

    angles, heights: (k,) of its radial lines of nodes. Where the first and the last angle are a whole turn apart the
    surface is closed round.
    """
    _checked(element_size=element_size)
    _check_ring(inner_radius, outer_radius)
    radius = np.linspace(inner_radius, outer_radius, _steps(outer_radius - inner_radius, element_size) + 1)
    x, y = np.cos(angles)[:, None] * radius, np.sin(angles)[:, None] * radius
    closed = math.isclose(angles[-1] - angles[0], WHOLE_TURN, rel_tol=ROUNDING)
    return _unworn(*_grid(x, y, np.broadcast_to(np.asarray(heights, float)[:, None], x.shape), closed))


def annular_wall(radius: float, height: float, angles: np.ndarray, element_size: float, inwards: bool) -> SurfaceMesh:
    """A wall of the trough from z = 0 to a height, normals to the axis (outer wall) or from it; all in m and rad."""
    _checked(radius=radius, height=height, element_size=element_size)
    z = np.linspace(0.0, height, _steps(height, element_size) + 1)
    x, y = (np.broadcast_to((radius * of(angles))[:, None], (len(angles), len(z))) for of in (np.cos, np.sin))
    closed = math.isclose(angles[-1] - angles[0], WHOLE_TURN, rel_tol=ROUNDING)
    points, triangles = _grid(x, y, np.broadcast_to(z, x.shape), closed)
    return _unworn(points, triangles if inwards else triangles[:, ::-1])


def trough(
    inner_radius: float,
    outer_radius: float,
    height: float,
    element_size: float,
    start: float = 0.0,
    end: float = WHOLE_TURN,
) -> dict[str, SurfaceMesh]:
    """Floor, inner and outer wall of the trough, normals to the bed, with the same nodes where they meet.

    All in m; start, end: rad, of a sector (150 degrees in Yan 2022). Edges are no longer than the element size, at the
    outer wall about as long. Raises ValueError as the parts.
    """
    _check_ring(inner_radius, outer_radius)
    _checked(height=height, element_size=element_size)
    angles = turn_angles(outer_radius, element_size, start, end)
    return {
        "floor": annular_surface(inner_radius, outer_radius, angles, np.zeros(len(angles)), element_size),
        "inner_wall": annular_wall(inner_radius, height, angles, element_size, inwards=False),
        "outer_wall": annular_wall(outer_radius, height, angles, element_size, inwards=True),
    }


def consolidator(
    inner_radius: float,
    outer_radius: float,
    level: float,
    rise: float,
    start: float,
    ramp_end: float,
    end: float,
    element_size: float,
) -> SurfaceMesh:
    """A plate across the trough that levels the bed: it falls by `rise` from start to ramp_end, then lies at `level`.

    Heights of the bed's side in m, angles in rad in the sense of the bed, start < ramp_end < end; normals down. Give
    radii that leave a gap to the walls. The source shows its consolidator without dimensions: all are the caller's.
    Raises ValueError for what cannot be.
    """
    _checked(level=level, rise=rise)
    if not start < ramp_end < end:
        raise ValueError(
            f"angles of a consolidator must be start < ramp end < end, found {start}, {ramp_end}, {end} rad"
        )
    ramp = turn_angles(outer_radius, element_size, start, ramp_end)
    flat = turn_angles(outer_radius, element_size, ramp_end, end)[1:]
    heights = np.concatenate([level + rise * (ramp_end - ramp) / (ramp_end - start), np.full(len(flat), level)])
    up = annular_surface(inner_radius, outer_radius, np.concatenate([ramp, flat]), heights, element_size)
    return SurfaceMesh(up.points, up.triangles[:, ::-1], up.cell_data)


def straight_consolidator(
    half_width: float, level: float, rise: float, start: float, ramp_end: float, end: float
) -> SurfaceMesh:
    """The consolidator of a straight channel along y: as `consolidator`, with places along the travel (m) for angles.

    Raises ValueError for what cannot be.
    """
    _checked(half_width=half_width, rise=rise)
    if not start < ramp_end < end:
        raise ValueError(f"places of a consolidator must be start < ramp end < end, found {start}, {ramp_end}, {end} m")
    y, z = np.array([start, ramp_end, end]), np.array([level + rise, level, level])
    x = np.array([half_width, -half_width])
    points, triangles = _grid(*np.broadcast_arrays(x, y[:, None], z[:, None]), closed=False)
    return _unworn(points, triangles)


def sample_block(
    width: float,
    length: float,
    thickness: float,
    element_size: float,
    pattern: Pattern | None,
    holder_size: float | None = None,
) -> SurfaceMesh:
    """A whole submerged sample: `sample_top` with upright sides and a bottom `thickness` below it, one closed surface.

    All in m. Sides and bottom are the holder's (`part` -1); they come after the top's triangles, whose order and labels
    are those of `sample_top`. holder_size: of elements of sides and bottom; those of the top without.
    Raises ValueError as that.
    """
    _checked(thickness=thickness)
    check_depth(pattern, thickness, "sample's thickness")
    holder_size = holder_size or element_size
    top = sample_top(width, length, element_size, pattern)
    rim = np.sort(boundary_edges(top.triangles)[:, 0])  # the first nodes, anticlockwise: see `meshes.plane`
    coarse = _thinned(top.points[rim, :2], holder_size)
    levels = np.linspace(0.0, -thickness, _steps(thickness, holder_size) + 1)[1:]
    below = top.points[rim[coarse], :2]
    sides = np.concatenate([np.column_stack([below, np.full(len(coarse), level)]) for level in levels])
    first = len(top.points)
    rings = first + np.arange(len(sides)).reshape(len(levels), len(coarse))
    points, triangles = _bottom(below, -thickness, holder_size, rings[-1], first + len(sides))
    count = [_down_to(rim, rings[0], coarse), _between(rings), triangles]
    mesh = np.concatenate([top.triangles, *count])
    holder = len(mesh) - len(top.triangles)
    labels = {
        name: np.concatenate([label, np.full(holder, HOLDER_PART if name == "part" else 0)])
        for name, label in top.cell_data.items()
    }
    return SurfaceMesh(np.concatenate([top.points, sides, points]), mesh, labels)


def _thinned(rim: np.ndarray, size: float) -> np.ndarray:
    """Numbers (k,) of nodes of a rectangle's rim (r, 2), anticlockwise from a corner: its corners, and between them so
    many that none are much farther apart than `size` (m), evenly.
    """
    corners = np.flatnonzero((np.abs(rim) >= np.abs(rim).max(axis=0) * (1.0 - ROUNDING)).all(axis=1))
    ends = np.append(corners, len(rim))
    kept = []
    for start, end in pairwise(ends):
        length = np.linalg.norm(rim[end % len(rim)] - rim[start])
        pieces = min(_steps(length, size), end - start)
        kept.append(start + np.round(np.linspace(0, end - start, pieces, endpoint=False)).astype(np.int64))
    return np.concatenate(kept)


def _down_to(rim: np.ndarray, below: np.ndarray, coarse: np.ndarray) -> np.ndarray:
    """Triangles from a rim's nodes (r,) down to a ring (k,) below some of them, which are `coarse` (k,) in the rim.

    Each edge of the rim has the nearer end of the ring's edge below it, each edge of the ring the node over its middle.
    """
    ends = np.append(coarse, len(rim))
    middle = (ends[:-1] + ends[1:]) // 2
    edge = np.arange(len(rim))
    piece = np.searchsorted(coarse, edge, side="right") - 1
    apex = below[(piece + (edge >= middle[piece])) % len(below)]
    upper = np.column_stack([rim, apex, np.roll(rim, -1)])
    lower = np.column_stack([rim[middle], below, np.roll(below, -1)])
    return np.concatenate([upper, lower])


def _between(rings: np.ndarray) -> np.ndarray:
    """Triangles between rings (k, r) of nodes, one below the other, outwards of nodes that run anticlockwise."""
    above, below = rings[:-1], rings[1:]
    quads = np.stack([above, below, np.roll(below, -1, axis=1), np.roll(above, -1, axis=1)], axis=-1)
    return quads[:, :, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def _bottom(
    rim: np.ndarray, z: float, element_size: float, ring: np.ndarray, first: int
) -> tuple[np.ndarray, np.ndarray]:
    """Points (p, 3) within a rim (r, 2) at height z, and triangles that face down; `ring`: the rim's own nodes."""
    size = max(element_size, float(np.linalg.norm(np.diff(rim, axis=0), axis=1).max()))
    plane = mesh_plane(rim, NO_HOLES, size, 0.0)
    inner = plane.points[len(rim) :]
    node = np.concatenate([ring, first + np.arange(len(inner))])
    return np.column_stack([inner, np.full(len(inner), z)]), node[plane.base][:, ::-1]


def submerged_pose(
    radius: float, bed_height: float, depth: float, incline: float, angle: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Rotation (3, 3) and translation (3,) m that put a sample from its own frame into the trough.

    radius: m, of the sample's middle; bed_height: m, of the bed's surface; depth: m, of the sample's middle below it
    (85 mm in the laboratory, 90 in the model of Yan 2022); incline: rad, positive where the edge that the bed leaves at
    is higher, so that the surface faces the flow (the source does not tell which); angle: rad, of the place in the
    trough. Raises ValueError when the sample would be above the bed or under the floor.
    """
    if not 0.0 < depth < bed_height:
        raise ValueError(
            f"depth of the sample must be above 0 and below the bed's height {bed_height} m, found {depth}"
        )
    cosine, sine = math.cos(incline), math.sin(incline)
    tilt = np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return turn @ tilt, turn @ np.array([radius, 0.0, bed_height - depth])


def placed(mesh: SurfaceMesh, rotation: np.ndarray, translation: np.ndarray) -> SurfaceMesh:
    """Return a surface turned by a rotation (3, 3) and then shifted (3,) m, its data unchanged."""
    return SurfaceMesh(mesh.points @ rotation.T + translation, mesh.triangles, mesh.cell_data, mesh.point_data)
