"""The track of a pin on a disc: a flat ring, fine round the track, coarse elsewhere, and the stretches of it."""

from __future__ import annotations

import math
from types import ModuleType

import numpy as np

from bulkwear.meshes.gmsh_model import gmsh_model
from bulkwear.meshes.plate import base_labels
from bulkwear.postproc.mesh import SurfaceMesh

DELAUNAY = 5  # gmsh's number of the plane algorithm; the frontal one lays rows of coarse triangles along the track
GROWTH = 0.3  # growth of an edge per distance from the band
RIM_EDGES = 2  # edges between the track and a rim, at least: no element is longer than half that way
LEAST_RIM_EDGES = 12  # edges round a rim, at least, and a multiple of four: each quarter is one arc


def track_disc(
    track_radius: float, inner_radius: float, disc_radius: float, element_size: float, band_half_width: float
) -> SurfaceMesh:
    """A flat ring at z = 0 about the z axis, normals up, every triangle labelled base, its rims regular polygons.

    track_radius : m, of the pin's path, between inner_radius and disc_radius (m), the rims; of a disc, nothing inside
        inner_radius is ever touched
    element_size : m, target edge within band_half_width (m) of the track; from there edges grow at rate GROWTH

    The triangles are unstructured: no edge is placed on the track. Equal arguments give equal bits.
    Raises ValueError unless 0 < inner_radius < track_radius < disc_radius and the sizes are > 0.
    """
    sizes = map(float, (track_radius, inner_radius, disc_radius, element_size, band_half_width))
    track_radius, inner_radius, disc_radius, element_size, band_half_width = sizes  # as gmsh's expressions need them
    _check(track_radius, inner_radius, disc_radius, element_size, band_half_width)
    largest = max(element_size, min(track_radius - inner_radius, disc_radius - track_radius) / RIM_EDGES)
    with gmsh_model() as gmsh:
        gmsh.option.setNumber("Mesh.Algorithm", DELAUNAY)
        centre = gmsh.model.geo.addPoint(0.0, 0.0, 0.0)
        loops = []
        for radius in (disc_radius, inner_radius):
            beyond = max(abs(radius - track_radius) - band_half_width, 0.0)
            loops.append(_circle(gmsh, centre, radius, min(element_size + GROWTH * beyond, largest)))
        gmsh.model.geo.addPlaneSurface(loops)
        gmsh.model.geo.synchronize()
        _grade(gmsh, track_radius, element_size, band_half_width, largest)
        gmsh.model.mesh.generate(2)
        tags, points, _ = gmsh.model.mesh.getNodes()
        cells = gmsh.model.mesh.getElementsByType(2)[1]
    return _surface(tags, points.reshape(-1, 3), cells.reshape(-1, 3))


def track_stretch(
    mesh: SurfaceMesh, track_radius: float, start_angle: float, end_angle: float, reach: float
) -> np.ndarray:
    """Triangles (k,) that an arc of the track needs: all within `reach` of it, in their order in the mesh, int64.

    mesh : in the pose of `track_disc`, worn or not; distances are taken in plan view, about the z axis
    start_angle, end_angle : rad, anticlockwise from x, of the arc's ends; a full turn and more is the whole track
    reach : m; with the pin's radius nothing is left out that the pin can touch

    A triangle counts as far off as its middle less its circumscribed reach, so a few more than needed are among them.
    Raises ValueError unless end_angle >= start_angle and reach > 0.
    """
    if not (end_angle >= start_angle and reach > 0.0):
        raise ValueError(
            f"a stretch needs end_angle >= start_angle and reach > 0 m, found {start_angle}, {end_angle} and {reach}"
        )
    corners = mesh.points[mesh.triangles][:, :, :2]
    middle = corners.mean(axis=1)
    size = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    return np.flatnonzero(_distance_to_arc(middle, track_radius, start_angle, end_angle) <= reach + size)


def _distance_to_arc(places: np.ndarray, radius: float, start: float, end: float) -> np.ndarray:
    """Distance (m,) m of places (m, 2) m from an arc about the origin, anticlockwise from `start` to `end` rad."""
    beyond = np.mod(np.arctan2(places[:, 1], places[:, 0]) - start, 2.0 * math.pi)
    to_circle = np.abs(np.hypot(places[:, 0], places[:, 1]) - radius)
    ends = radius * np.array([(math.cos(angle), math.sin(angle)) for angle in (start, end)])
    to_ends = np.linalg.norm(places[:, None] - ends, axis=2).min(axis=1)
    return np.where(beyond <= end - start, to_circle, to_ends)


def _check(track_radius: float, inner: float, outer: float, element_size: float, band_half_width: float) -> None:
    if not 0.0 < inner < track_radius < outer:
        raise ValueError(
            f"a track needs 0 < inner_radius < track_radius < disc_radius, found {inner}, {track_radius} and {outer} m"
        )
    for name, value in (("element_size", element_size), ("band_half_width", band_half_width)):
        if not value > 0.0:
            raise ValueError(f"{name} of a disc must be greater than 0 m, found {value}")


def _circle(gmsh: ModuleType, centre: int, radius: float, edge: float) -> int:
    """Curve loop of four equally divided arcs, no edge longer than `edge` (m) by the arc."""
    quarter = max(math.ceil(0.5 * math.pi * radius / edge), LEAST_RIM_EDGES // 4)
    corners = [
        gmsh.model.geo.addPoint(radius * x, radius * y, 0.0)
        for x, y in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
    ]
    pairs = zip(corners, [*corners[1:], corners[0]], strict=True)
    arcs = [gmsh.model.geo.addCircleArc(first, centre, second) for first, second in pairs]
    for arc in arcs:
        gmsh.model.geo.mesh.setTransfiniteCurve(arc, quarter + 1)
    return gmsh.model.geo.addCurveLoop(arcs)


def _grade(gmsh: ModuleType, track_radius: float, element_size: float, band: float, largest: float) -> None:
    """Let the target edge be `element_size` in the band and grow from there, whatever the rims' edges are; in m."""
    distance = f"Fabs(Sqrt(x*x + y*y) - {track_radius!r}) - {band!r}"
    field = gmsh.model.mesh.field.add("MathEval")
    gmsh.model.mesh.field.setString(field, "F", f"Min({largest!r}, {element_size!r} + {GROWTH!r} * Max(0, {distance}))")
    gmsh.model.mesh.field.setAsBackgroundMesh(field)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)


def _surface(tags: np.ndarray, points: np.ndarray, cells: np.ndarray) -> SurfaceMesh:
    """Surface of gmsh's nodes that triangles use (the circles' centre is none), numbered in gmsh's order."""
    used = np.isin(tags, cells)
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags[used]] = np.arange(np.count_nonzero(used))
    return SurfaceMesh(points[used], number[cells], base_labels(len(cells)))
