"""The circular wear tester: areas and volumes of closed forms, normals to the bed, the sample in its place."""

import math

import numpy as np
import pytest

from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.sample import sample_top
from bulkwear.meshes.tester import (
    annular_surface,
    consolidator,
    placed,
    sample_block,
    submerged_pose,
    trough,
    turn_angles,
)
from bulkwear.postproc.mesh import (
    SurfaceMesh,
    area_vectors,
    areas,
    boundary_edges,
    edge_lengths_per_triangle,
    enclosed_volume,
    nonmanifold_edges,
    smallest_angles,
    volume_above_plane,
)

INNER, OUTER, HEIGHT, ELEMENT = 0.29, 0.5, 0.2, 0.02  # m (Yan 2022, section 6.2.1; the height is not published)
SECTOR = math.radians(150.0)  # Yan 2022, section 6.3.1
PATTERN = ConvexPattern(8e-3, 2e-3, 6e-3, 20e-3, 20e-3)  # R9, rows 20 mm apart
SAMPLE, THICKNESS, SIZE = 0.1, 0.01, 4e-3  # m
ROUNDING = 1e-9
SMALLEST_ANGLE = 10.0  # degrees, what all samples promise


def joined(meshes):
    """Several surfaces as one; nodes at the same place are one node."""
    points = np.concatenate([mesh.points for mesh in meshes])
    starts = np.cumsum([0] + [len(mesh.points) for mesh in meshes[:-1]])
    triangles = np.concatenate([mesh.triangles + start for mesh, start in zip(meshes, starts, strict=True)])
    unique, inverse = np.unique(np.round(points, 12), axis=0, return_inverse=True)
    return SurfaceMesh(unique, inverse.reshape(-1)[triangles])


def polygon_area(angles):
    """Area (m2) of the ring between the polygons of nodes: trapezoids between two radii."""
    return 0.5 * np.sin(np.diff(angles)).sum() * (OUTER**2 - INNER**2)


@pytest.mark.parametrize("end", [2.0 * math.pi, SECTOR])
def test_areas_of_the_trough(end):
    """Floor: trapezoids of its chords, towards the ring's; walls: chords times height."""
    parts = trough(INNER, OUTER, HEIGHT, ELEMENT, end=end)
    angles = turn_angles(OUTER, ELEMENT, end=end)
    area = {name: areas(mesh.points, mesh.triangles).sum() for name, mesh in parts.items()}
    assert area["floor"] == pytest.approx(polygon_area(angles), rel=ROUNDING)
    chord = 2.0 * np.sin(0.5 * np.diff(angles)).sum()
    assert area["inner_wall"] == pytest.approx(INNER * chord * HEIGHT, rel=ROUNDING)
    assert area["outer_wall"] == pytest.approx(OUTER * chord * HEIGHT, rel=ROUNDING)
    finer = trough(INNER, OUTER, HEIGHT, ELEMENT / 4.0, end=end)["floor"]
    ring = 0.5 * end * (OUTER**2 - INNER**2)
    missing = [1.0 - areas(mesh.points, mesh.triangles).sum() / ring for mesh in (parts["floor"], finer)]
    assert missing[0] / missing[1] == pytest.approx(16.0, rel=0.05)  # second order in the chord


def test_the_trough_holds_its_bed():
    """With a lid it is closed and encloses ring times height; its normals point to the bed."""
    parts = trough(INNER, OUTER, HEIGHT, ELEMENT)
    angles = turn_angles(OUTER, ELEMENT)
    lid = annular_surface(INNER, OUTER, angles, np.full(len(angles), HEIGHT), ELEMENT)
    lid = SurfaceMesh(lid.points, lid.triangles[:, ::-1])
    closed = joined([*parts.values(), lid])
    assert len(boundary_edges(closed.triangles)) == 0
    assert len(nonmanifold_edges(closed.triangles)) == 0
    assert enclosed_volume(closed.points, closed.triangles) == pytest.approx(-polygon_area(angles) * HEIGHT, rel=1e-6)


def test_elements_of_the_trough():
    """No edge but diagonals longer than an element, no acute triangle, nothing of it wears."""
    for mesh in trough(INNER, OUTER, HEIGHT, ELEMENT, end=SECTOR).values():
        edges = np.sort(edge_lengths_per_triangle(mesh.points, mesh.triangles), axis=1)
        assert edges[:, 1].max() <= ELEMENT * (1.0 + ROUNDING)
        assert smallest_angles(mesh.points, mesh.triangles).min() > 25.0
        assert (mesh.cell_data["part"] == -1).all()


def test_consolidator():
    """In plan the ring's sector; falling evenly to its level, which it keeps; it faces the bed below."""
    start, ramp_end, end = 0.0, 0.3, 0.5
    mesh = consolidator(INNER, OUTER, 0.15, 0.05, start, ramp_end, end, ELEMENT)
    angles = np.concatenate(
        [turn_angles(OUTER, ELEMENT, start, ramp_end), turn_angles(OUTER, ELEMENT, ramp_end, end)[1:]]
    )
    down = area_vectors(mesh.points, mesh.triangles)[:, 2]
    assert down.max() < 0.0
    assert -down.sum() == pytest.approx(polygon_area(angles), rel=ROUNDING)
    angle, height = np.arctan2(mesh.points[:, 1], mesh.points[:, 0]), mesh.points[:, 2]
    assert height == pytest.approx(0.15 + 0.05 * np.maximum(ramp_end - angle, 0.0) / ramp_end)
    plan = polygon_area(angles[angles < ramp_end + ROUNDING])
    assert -volume_above_plane(mesh.points, mesh.triangles, 0.15) == pytest.approx(0.5 * 0.05 * plan, rel=1e-6)


def test_plain_block_is_a_box():
    mesh = sample_block(SAMPLE, SAMPLE, THICKNESS, SIZE, None)
    assert enclosed_volume(mesh.points, mesh.triangles) == pytest.approx(SAMPLE**2 * THICKNESS, rel=ROUNDING)
    part = mesh.cell_data["part"]
    whole = areas(mesh.points, mesh.triangles)
    assert whole[part == 0].sum() == pytest.approx(SAMPLE**2, rel=ROUNDING)
    assert whole[part == -1].sum() == pytest.approx(SAMPLE**2 + 4.0 * SAMPLE * THICKNESS, rel=ROUNDING)


def test_convex_block():
    """Closed, box plus bumps; bumps up to 2/3 pi a b h, as chords of the ellipsoid; the top is `sample_top`."""
    mesh, top = (
        sample_block(SAMPLE, SAMPLE, THICKNESS, SIZE, PATTERN),
        sample_top(SAMPLE, SAMPLE, SIZE, PATTERN),
    )
    assert len(boundary_edges(mesh.triangles)) == 0
    assert len(nonmanifold_edges(mesh.triangles)) == 0
    assert smallest_angles(mesh.points, mesh.triangles).min() > SMALLEST_ANGLE
    bumps = volume_above_plane(top.points, top.triangles)
    ellipsoids = 23 * 2.0 / 3.0 * math.pi * 8e-3 * 2e-3 * 6e-3
    assert 0.9 * ellipsoids < bumps < ellipsoids
    volume = enclosed_volume(mesh.points, mesh.triangles)
    assert volume == pytest.approx(SAMPLE**2 * THICKNESS + bumps, rel=ROUNDING)
    count = len(top.triangles)
    assert (mesh.triangles[:count] == top.triangles).all()
    assert (mesh.points[: len(top.points)] == top.points).all()
    assert (mesh.cell_data["row"][:count] == top.cell_data["row"]).all()
    assert (mesh.cell_data["part"][count:] == -1).all()


def test_a_coarse_holder_is_closed_too():
    """Fine top, coarse sides and bottom: closed, the box's volume and areas, a tenth of the holder's triangles."""
    fine, coarse = (sample_block(SAMPLE, SAMPLE, THICKNESS, SIZE, None, holder) for holder in (None, 2.5 * SIZE))
    assert len(boundary_edges(coarse.triangles)) == len(nonmanifold_edges(coarse.triangles)) == 0
    assert enclosed_volume(coarse.points, coarse.triangles) == pytest.approx(SAMPLE**2 * THICKNESS, rel=ROUNDING)
    part, whole = coarse.cell_data["part"], areas(coarse.points, coarse.triangles)
    assert whole[part == -1].sum() == pytest.approx(SAMPLE**2 + 4.0 * SAMPLE * THICKNESS, rel=ROUNDING)
    assert (part == -1).sum() < 0.3 * (fine.cell_data["part"] == -1).sum()
    assert smallest_angles(coarse.points, coarse.triangles).min() > SMALLEST_ANGLE


def test_the_sample_lies_at_its_depth_and_incline():
    """Its middle at the depth, its base inclined by 2 degrees, its trailing edge higher, square to the radius."""
    incline, depth, bed = math.radians(2.0), 0.09, 0.15
    top = sample_top(SAMPLE, SAMPLE, SIZE, None)
    for angle in (0.0, 1.0):
        mesh = placed(top, *submerged_pose(0.395, bed, depth, incline, angle))
        normal = area_vectors(mesh.points, mesh.triangles).sum(axis=0)
        normal /= np.linalg.norm(normal)
        assert math.acos(normal[2]) == pytest.approx(incline)
        middle = 0.5 * (mesh.points.min(axis=0) + mesh.points.max(axis=0))
        assert middle[2] == pytest.approx(bed - depth)
        flow = np.array([-math.sin(angle), math.cos(angle), 0.0])
        outwards = np.array([math.cos(angle), math.sin(angle), 0.0])
        assert normal @ flow == pytest.approx(-math.sin(incline))
        assert normal @ outwards == pytest.approx(0.0, abs=1e-12)
        centre = mesh.points @ outwards
        assert 0.5 * (centre.min() + centre.max()) == pytest.approx(0.395)
        front = mesh.points[top.points[:, 1] == -SAMPLE / 2, 2].mean()
        assert front == pytest.approx(bed - depth - 0.5 * SAMPLE * math.sin(incline))


def test_it_fits_between_the_walls():
    """The sample's corners keep to the bed between 0.29 and 0.5 m."""
    block = sample_block(SAMPLE, SAMPLE, THICKNESS, SIZE, None)
    mesh = placed(block, *submerged_pose(0.395, 0.15, 0.09, math.radians(2.0)))
    radius = np.linalg.norm(mesh.points[:, :2], axis=1)
    assert radius.min() > INNER and radius.max() < OUTER
    assert mesh.points[:, 2].min() > 0.0
    assert enclosed_volume(mesh.points, mesh.triangles) == pytest.approx(SAMPLE**2 * THICKNESS, rel=ROUNDING)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: trough(0.5, 0.29, HEIGHT, ELEMENT), "inner < outer"),
        (lambda: trough(INNER, OUTER, -1.0, ELEMENT), "height of the tester"),
        (lambda: trough(INNER, OUTER, HEIGHT, 0.0), "element_size of the tester"),
        (lambda: trough(INNER, OUTER, HEIGHT, ELEMENT, end=7.0), "start < end"),
        (lambda: turn_angles(OUTER, ELEMENT, -1.0, -2.0), "start < end"),
        (lambda: consolidator(INNER, OUTER, 0.1, 0.1, 0.0, 0.6, 0.5, ELEMENT), "ramp end"),
        (lambda: sample_block(SAMPLE, SAMPLE, 0.0, SIZE, None), "thickness"),
        (lambda: submerged_pose(0.395, 0.08, 0.09, 0.0), "depth of the sample"),
    ],
)
def test_what_cannot_be_is_refused(call, words):
    with pytest.raises(ValueError, match=words):
        call()
