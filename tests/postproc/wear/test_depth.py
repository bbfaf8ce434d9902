"""Depth fields: removed thickness, height loss, ray depth."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate, sphere
from bulkwear.postproc.mesh import node_area_vectors
from bulkwear.postproc.wear import depth
from bulkwear.postproc.wear.depth import add_removed_thickness, height_loss, ray_depth

SEED = 20220317
ROUNDING = 1e-9  # relative: depths are differences of coordinates some 1e4 times larger
UP = np.array([0.0, 0.0, 1.0])


def graded_plate():
    """A plate whose cells grow a hundredfold along x, with a slope of 1/2 in y: points and triangles."""
    mesh = flat_plate(2.0, 2.0, 0.05)
    points = mesh.points.copy()
    points[:, 0] = 10.0 ** (1.0 + points[:, 0])
    points[:, 2] = 0.5 * points[:, 1]
    return points, mesh.triangles


def test_removed_thickness_sums_the_path():
    """Two steps add up, whatever their direction."""
    path = add_removed_thickness(np.array([1e-5, 0.0]), np.array([2e-5, 0.0]))
    assert path == pytest.approx([3e-5, 0.0], rel=ROUNDING)


def test_all_depths_agree_on_a_plate_worn_evenly():
    """A plate lowered by d has height loss d and ray depth d at every node, rim and corners included."""
    mesh, down = flat_plate(0.06, 0.04, 0.003), 2e-5
    points = mesh.points - down * UP
    outward = np.tile(UP, (len(points), 1))
    thickness = np.full(len(points), down)
    np.testing.assert_allclose(height_loss(points, mesh.points, mesh.triangles), down, rtol=ROUNDING)
    np.testing.assert_allclose(ray_depth(points, outward, thickness, mesh.points, mesh.triangles), down, rtol=ROUNDING)


def test_height_loss_on_a_slope_is_the_thickness_over_the_cosine():
    """On a plane inclined at angle a a thickness d costs the height d / cos a; the ray reads d."""
    points, triangles = graded_plate()
    normal = np.array([0.0, -0.5, 1.0]) / np.hypot(0.5, 1.0)
    inside = points[np.abs(points[:, 1]) < 0.9]
    worn = inside - 1e-3 * normal
    loss = height_loss(worn, points, triangles)
    np.testing.assert_allclose(loss, 1e-3 * np.hypot(0.5, 1.0), rtol=ROUNDING)
    ray = ray_depth(worn, np.tile(normal, (len(worn), 1)), np.full(len(worn), 1e-3), points, triangles)
    np.testing.assert_allclose(ray, 1e-3, rtol=ROUNDING)


def test_ray_depth_on_a_sphere_is_the_difference_of_radii():
    """A sphere shrunk by d has ray depth d, within the sag h^2 / (8 r) of its facets."""
    mesh, down = sphere(0.05, 4), 1e-3
    points = mesh.points * (1.0 - down / 0.05)
    outward = node_area_vectors(points, mesh.triangles)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    measured = ray_depth(points, outward, np.full(len(points), down), mesh.points, mesh.triangles)
    sag = 0.05 * (1.1 / 2**4) ** 2 / 8  # m, edge h = 1.1 r / 2^4
    np.testing.assert_allclose(measured, down, atol=sag)


def test_depths_do_not_need_the_pristine_triangulation():
    """Points between the nodes of the pristine surface (as after remeshing) are measured all the same."""
    mesh = flat_plate(0.06, 0.04, 0.003)
    random = np.random.default_rng(SEED)
    points = np.column_stack((random.uniform(-0.03, 0.03, 500), random.uniform(-0.02, 0.02, 500), np.full(500, -1e-4)))
    np.testing.assert_allclose(height_loss(points, mesh.points, mesh.triangles), 1e-4, rtol=ROUNDING)


def test_wear_deeper_than_many_edges_is_measured():
    """Height loss has no reach, ray depth that of the removed thickness: both see over many edges."""
    mesh = flat_plate(0.06, 0.04, 0.003)
    below = mesh.points - 0.5 * UP
    np.testing.assert_allclose(height_loss(below, mesh.points, mesh.triangles), 0.5, rtol=ROUNDING)
    ray = ray_depth(below, np.tile(UP, (len(below), 1)), np.full(len(below), 0.3), mesh.points, mesh.triangles)
    np.testing.assert_allclose(ray, 0.5, rtol=ROUNDING)


def test_search_agrees_with_trying_every_triangle():
    """The search in size classes finds what trying all triangles of a strongly graded mesh finds."""
    points, triangles = graded_plate()
    random = np.random.default_rng(SEED)
    inside = np.column_stack((10.0 ** random.uniform(0.1, 1.9, 60), random.uniform(-0.9, 0.9, 60)))
    origins = np.column_stack((inside, 0.5 * inside[:, 1] - random.uniform(0.0, 0.3, 60)))
    directions = UP + random.uniform(-0.5, 0.5, (60, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    pairs = np.repeat(np.arange(60), len(triangles))
    everything = depth._ray_triangle(origins[pairs], directions[pairs], points[np.tile(triangles, (60, 1))])
    nearest = everything.reshape(60, -1).min(axis=1)
    thickness = np.full(60, 0.2)
    expected = np.where(nearest <= depth.LARGEST_RAY_OVER_THICKNESS * thickness, nearest, np.nan)
    assert 0 < np.isnan(expected).sum() < 60
    np.testing.assert_allclose(ray_depth(origins, directions, thickness, points, triangles), expected, rtol=ROUNDING)


def test_blocks_do_not_show(monkeypatch):
    """Results do not depend on how many rays are handled at once."""
    points, triangles = graded_plate()
    below = points - 0.1 * UP
    whole = height_loss(below, points, triangles)
    monkeypatch.setattr(depth, "LARGEST_PAIR_BLOCK", 500)
    assert np.array_equal(height_loss(below, points, triangles), whole)


def test_blocks_bound_the_candidates_and_leave_no_ray_out():
    """Every ray is in exactly one block; a block holds at most its bound besides one ray's own candidates."""
    counts = np.random.default_rng(SEED).integers(0, 90_000, 200)
    blocks = depth._blocks(counts)
    assert np.array_equal(np.concatenate([np.arange(200)[block] for block in blocks]), np.arange(200))
    assert len(blocks) > 10
    assert all(counts[block][1:].sum() <= depth.LARGEST_PAIR_BLOCK for block in blocks)
    assert depth._blocks(counts[:0]) == []


def test_undefined_depths_are_nan():
    """NaN where there is no pristine surface above, or none within reach along the normal."""
    mesh = flat_plate(0.06, 0.04, 0.003)
    beside = np.array([[0.05, 0.0, -1e-4]])
    assert np.isnan(height_loss(beside, mesh.points, mesh.triangles)).all()
    inside = np.array([[0.0, 0.0, -1e-4]])
    oblique = np.array([[np.sin(1.2), 0.0, np.cos(1.2)]])  # 69 degrees off the pristine normal
    assert np.isnan(ray_depth(inside, oblique, np.array([1e-4]), mesh.points, mesh.triangles)).all()


@pytest.mark.parametrize(("height", "expected"), [(0.005, 0.0), (0.1, np.nan)])
def test_just_outside_is_depth_zero(height, expected):
    """Up to 1 % of an edge outside the pristine surface (remeshing) the depth is 0, farther out undefined."""
    mesh = flat_plate(6.0, 4.0, 1.0)
    outside = np.array([[0.3, 0.2, height]])
    assert height_loss(outside, mesh.points, mesh.triangles) == pytest.approx([expected], nan_ok=True)
