"""The patterned sample: plane, bumps or dimples, and ramped skirt as one conforming surface.

All shapes of a pattern are alike: one shell is meshed and copied. The plane is meshed round the feet, whose
nodes are prescribed (`meshes.plane`), and the parts share nodes by index. Nothing is matched by distance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bulkwear.meshes.lattice import Pattern, millimetres, pattern_centres, pattern_faults, pattern_rows
from bulkwear.meshes.plane import PlaneMesh, mesh_plane, rectangle_rim
from bulkwear.postproc.mesh import HOLDER_PART, SurfaceMesh, nonmanifold_edges, smallest_angles, worn_faces

SKIRT_DEPTH = 0.2  # of the height above the floor: how far the skirt reaches below the floor, so that no slit opens
LARGEST_SKIRT_SLOPE = math.pi / 4  # a steeper ramp is a wall and would plough the bed
SMALLEST_ANGLE = 10.0  # degrees, promised for every triangle


@dataclass(frozen=True, eq=False)
class _Shapes:
    """Shell (p, 3) m, first `feet` nodes on the foot; triangles (t, 3); centres (k, 2) m; column, row."""

    shell: np.ndarray
    triangles: np.ndarray
    feet: int
    centres: np.ndarray
    column: np.ndarray
    row: np.ndarray


def skirt_width(height_above_floor: float, skirt_slope: float, skirt_radius: float = 0.0) -> float:
    """Width (m) of the ramp round a sample `height_above_floor` (m) high; arguments as in `sliding_sample`."""
    drop, steepest = (1 + SKIRT_DEPTH) * height_above_floor, math.tan(skirt_slope)
    if skirt_radius * steepest**2 >= drop:
        return 2.0 * math.sqrt(drop * skirt_radius)
    return drop / steepest + skirt_radius * steepest


def skirt_fall(
    beyond_rim: np.ndarray, height_above_floor: float, skirt_slope: float, skirt_radius: float
) -> np.ndarray:
    """How far (m) below the sample's top the ramp is at distances (m) beyond the rim; arguments as in `sliding_sample`.

    Parabolas of curvature 1 / radius at top and foot, tangential to both planes, and the slope between them where
    they do not meet before. Without a radius the slope alone.
    """
    steepest = math.tan(skirt_slope)
    if skirt_radius == 0.0:
        return steepest * beyond_rim
    drop, width = (1 + SKIRT_DEPTH) * height_above_floor, skirt_width(height_above_floor, skirt_slope, skirt_radius)
    curved = min(skirt_radius * steepest, 0.5 * width)  # width of each of the two curves
    top = np.minimum(beyond_rim, curved) ** 2 / (2.0 * skirt_radius)
    between = curved / skirt_radius * (np.clip(beyond_rim, curved, width - curved) - curved)
    foot = (curved**2 - np.clip(width - beyond_rim, 0.0, curved) ** 2) / (2.0 * skirt_radius)
    return np.minimum(top + between + foot, drop)


def floor_fault(mesh: SurfaceMesh, floor_z: float = 0.0, clearance: float = 0.0) -> str | None:
    """Phrase if a node of the worn faces came down to the floor (z <= floor_z + clearance, m), else None."""
    nodes = np.unique(mesh.triangles[worn_faces(mesh)])
    lowest = nodes[np.argmin(mesh.points[nodes, 2])] if len(nodes) else None
    if lowest is None or mesh.points[lowest, 2] > floor_z + clearance:
        return None
    return (
        f"the sample is worn down to the floor: node {lowest} is at z = {mesh.points[lowest, 2]:.4g} m, "
        f"allowed is above {floor_z + clearance:.4g} m"
    )


def sample_top(width: float, length: float, element_size: float, pattern: Pattern | None) -> SurfaceMesh:
    """The top of a sample, plane at z = 0 with its pattern, without a skirt.

    width (x), length (y), element_size: m; pattern None gives a plain sample. Cell data: `part`, `column` and
    `row`. Raises ValueError for a pattern that does not fit, or when a triangle would be too acute.
    """
    return _checked(_flat_sample(width, length, element_size, pattern, frame_width=0.0), element_size)


def sliding_sample(
    width: float,
    length: float,
    element_size: float,
    pattern: Pattern | None,
    height_above_floor: float,
    skirt_slope: float,
    skirt_radius: float = 0.0,
) -> SurfaceMesh:
    """A sample with its top at z = `height_above_floor` (m) above the floor z = 0, and a ramp down all round.

    The skirt falls at `skirt_slope` (rad) from the rim to 0.2 heights below the floor; its `part` is -1. With a
    `skirt_radius` (m) it begins and ends level, curved by that radius, and is nowhere steeper than the slope.
    Other arguments, data and errors as in `sample_top`; the height must be > 0, the slope in (0, pi/4], the radius
    not below 0. A pattern ends above the floor.
    """
    if not height_above_floor > 0:
        raise ValueError(f"height_above_floor must be greater than 0 m, found {height_above_floor}")
    check_depth(pattern, height_above_floor, "sample's height above the floor")
    if not 0 < skirt_slope <= LARGEST_SKIRT_SLOPE:
        raise ValueError(f"skirt_slope must be in (0, {LARGEST_SKIRT_SLOPE:.4f}] rad, found {skirt_slope}")
    if not skirt_radius >= 0:
        raise ValueError(f"skirt_radius must not be below 0 m, found {skirt_radius}")
    ramp = (height_above_floor, skirt_slope, skirt_radius)
    flat = _flat_sample(width, length, element_size, pattern, skirt_width(*ramp), fine_frame=skirt_radius > 0.0)
    beyond_rim = np.max(np.abs(flat.points[:, :2]) - (width / 2, length / 2), axis=1)
    points = flat.points.copy()
    points[:, 2] += height_above_floor - skirt_fall(np.maximum(beyond_rim, 0.0), *ramp)
    return _checked(SurfaceMesh(points, flat.triangles, flat.cell_data), element_size)


def _flat_sample(
    width: float,
    length: float,
    element_size: float,
    pattern: Pattern | None,
    frame_width: float,
    fine_frame: bool = False,
) -> SurfaceMesh:
    """Plane at z = 0 and pattern, with a frame of `frame_width` (m, 0 for none), coarse or fine, in that plane."""
    for name, value in (("width", width), ("length", length), ("element_size", element_size)):
        if not (math.isfinite(value) and value > 0):
            raise ValueError(f"{name} of a sample must be greater than 0 m, found {value}")
    shapes = _place_shapes(pattern, width, length, element_size)
    holes = shapes.centres[:, None] + shapes.shell[None, : shapes.feet, :2]
    rim = rectangle_rim(width, length, _rim_element_size(width, length, element_size, holes))
    return _join(mesh_plane(rim, holes, element_size, frame_width, fine_frame), len(rim), shapes)


def check_depth(pattern: Pattern | None, room: float, name: str) -> None:
    """Raise ValueError for a pattern at least as deep as `room` (m), which is the sample's `name`."""
    if pattern is not None and pattern.deepest_point >= room:
        raise ValueError(
            f"a {pattern.noun} is {millimetres(pattern.deepest_point)} deep, allowed is less than the {name}, "
            f"{millimetres(room)}"
        )


def _rim_element_size(width: float, length: float, element_size: float, holes: np.ndarray) -> float:
    """Edge length along the rim (m): the element size, or less where `holes` (k, f, 2) lie close to it."""
    if not len(holes):
        return element_size
    gap = (np.array([width, length]) / 2 - np.abs(holes).max(axis=(0, 1))).min()
    spacing = np.linalg.norm(holes[0, 1] - holes[0, 0])
    return min(element_size, max(gap, spacing))


def _checked(mesh: SurfaceMesh, element_size: float) -> SurfaceMesh:
    """The mesh, if it is conforming and no triangle is more acute than promised; ValueError otherwise."""
    if len(broken := nonmanifold_edges(mesh.triangles)):
        raise ValueError(f"the surface has {len(broken)} edges of more than two triangles, allowed is none")
    angle = smallest_angles(mesh.points, mesh.triangles).min()
    if angle >= SMALLEST_ANGLE:
        return mesh
    raise ValueError(
        f"a gap between pattern, rim and skirt is too narrow for elements of {1e3 * element_size:.4g} mm: "
        f"smallest angle {angle:.3g} degrees, allowed are {SMALLEST_ANGLE:g} or more"
    )


def _place_shapes(pattern: Pattern | None, width: float, length: float, element_size: float) -> _Shapes:
    """Shell and places of the shapes, none for a plain sample. Raises ValueError when they do not fit."""
    none = np.empty(0, dtype=np.int64)
    if pattern is None:
        return _Shapes(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64), 0, np.empty((0, 2)), none, none)
    fault = pattern_faults(pattern, width, length)
    if fault:
        raise ValueError(f"the pattern does not fit the sample: {fault}")
    shell, triangles, feet = pattern.shell(element_size)
    centres, column = pattern_centres(pattern, width, length)
    return _Shapes(shell, triangles, feet, centres, column, pattern_rows(pattern, width, length))


def _join(plane: PlaneMesh, n_rim: int, shapes: _Shapes) -> SurfaceMesh:
    """Plane and copies of the shell, joined by node index; triangles in the order base, shapes, frame."""
    count, n_plane = len(shapes.centres), len(plane.points)
    inner = shapes.shell[shapes.feet :]
    copies = np.tile(inner, (count, 1))
    copies[:, :2] += np.repeat(shapes.centres, len(inner), axis=0)
    points = np.concatenate([np.column_stack([plane.points, np.zeros(n_plane)]), copies])
    foot_nodes = n_rim + np.arange(count * shapes.feet).reshape(count, shapes.feet)
    inner_nodes = n_plane + np.arange(len(copies)).reshape(count, len(inner))
    nodes = np.concatenate([foot_nodes, inner_nodes], axis=1)
    triangles = np.concatenate([plane.base, nodes[:, shapes.triangles].reshape(-1, 3), plane.frame])
    return SurfaceMesh(points, triangles, _labels(plane, shapes))


def _labels(plane: PlaneMesh, shapes: _Shapes) -> dict[str, np.ndarray]:
    """`part`, `column` and `row` of every triangle, int64: base, then shape by shape, then frame."""

    def label(per_shape: np.ndarray, frame: int) -> np.ndarray:
        on_shapes = np.repeat(per_shape, len(shapes.triangles))
        return np.concatenate([np.zeros(len(plane.base)), on_shapes, np.full(len(plane.frame), frame)]).astype(np.int64)

    part = label(np.arange(1, len(shapes.centres) + 1), HOLDER_PART)
    return {"part": part, "column": label(shapes.column, 0), "row": label(shapes.row, 0)}
