"""The shell of a bump and its relaxation against the semi-ellipsoid."""

import math

import numpy as np
import pytest
from scipy.special import ellipe

from bulkwear.meshes.bump import bump_shell
from bulkwear.meshes.relax import flip_to_delaunay, relax
from bulkwear.meshes.shell import foot_nodes, shell_element_size
from bulkwear.postproc.mesh import (
    areas,
    boundary_edges,
    centroids,
    nonmanifold_edges,
    smallest_angles,
    unit_normals,
    volume_above_plane,
)

SHAPES = [
    (4e-3, 8e-3, 1.5e-3),
    (2e-3, 8e-3, 6e-3),
    (2e-3, 2e-3, 6e-3),
    (8e-3, 2e-3, 1.5e-3),
    (8e-3, 8e-3, 6e-3),
]
ON_SURFACE = 1e-12  # relative: the last step scales the points on to the ellipsoid
OVERHANG = -0.12  # normal z: over a chord of the foot's sharp tip the first ring may lean out by 7 degrees


@pytest.mark.parametrize("shape", SHAPES)
def test_shell_is_a_disc_on_the_ellipsoid(shape):
    """Nodes lie on the ellipsoid, the boundary is the given foot, the surface is one manifold disc."""
    points, triangles, feet = bump_shell(*shape, 0.5e-3)
    assert np.linalg.norm(points / shape, axis=1) == pytest.approx(1.0, rel=ON_SURFACE)
    assert (points[:feet, :2] == foot_nodes(shape[0], shape[1], 0.5e-3)).all()
    assert (points[:feet, 2] == 0).all()
    assert points[feet:, 2].min() > 0
    edges = boundary_edges(triangles)
    assert sorted(map(tuple, edges.tolist())) == sorted((k, (k + 1) % feet) for k in range(feet))
    assert nonmanifold_edges(triangles).size == 0
    assert len(points) - 3 * len(triangles) // 2 - len(edges) // 2 + len(triangles) == 1  # Euler: a disc


@pytest.mark.parametrize("shape", SHAPES)
def test_normals_point_outward(shape):
    """Triangles face the way the ellipsoid's gradient does, and up but for a slight overhang at the foot."""
    points, triangles, _ = bump_shell(*shape, 0.5e-3)
    normals, gradient = unit_normals(points, triangles), centroids(points, triangles) / np.square(shape)
    gradient /= np.linalg.norm(gradient, axis=1, keepdims=True)
    assert (normals * gradient).sum(axis=1).min() > 0.7  # 45 degrees at the sharpest tip, radius of a tenth of the edge
    assert normals[:, 2].min() > OVERHANG


@pytest.mark.parametrize("shape", [(4e-3, 4e-3, 3e-3), (8e-3, 4e-3, 1.5e-3)])
def test_volume_converges_with_the_square_of_the_edge(shape):
    """Inscribed: volume below 2/3 pi a b h, and half the edge makes about a quarter of the error."""
    exact = 2 / 3 * math.pi * math.prod(shape)
    errors = []
    for size in (1.2e-3, 0.6e-3, 0.3e-3):
        points, triangles, _ = bump_shell(*shape, size)
        errors.append(1 - volume_above_plane(points, triangles) / exact)
    assert errors[0] < 0.06  # measured below 0.045
    assert errors[-1] > 0
    assert all(3.2 < ratio < 4.8 for ratio in np.divide(errors[:-1], errors[1:]))  # 4 in the limit


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("element_size", [2e-3, 1e-3, pytest.param(0.5e-3, marks=pytest.mark.verify)])
def test_angles(shape, element_size):
    """Angles: none below 20 degrees, one in a hundred below 30."""
    size = shell_element_size(shape[0], shape[1], element_size)
    angles = smallest_angles(*bump_shell(*shape, size)[:2])
    assert angles.min() > 20
    assert np.percentile(angles, 1) > 30


def test_foot_nodes_are_even_on_the_ellipse():
    """Equal chords on a circle; on an ellipse they sum to the perimeter 4 a E(1 - b2/a2) from below."""
    circle = foot_nodes(2e-3, 2e-3, 0.5e-3)
    chords = np.linalg.norm(circle - np.roll(circle, 1, axis=0), axis=1)
    assert chords == pytest.approx(chords[0], rel=1e-6)  # arc length is summed over 20 000 chords
    ellipse = foot_nodes(2e-3, 8e-3, 0.05e-3)
    chords = np.linalg.norm(ellipse - np.roll(ellipse, 1, axis=0), axis=1)
    perimeter = 4 * 8e-3 * ellipe(1 - (2 / 8) ** 2)
    assert 0.999 * perimeter < chords.sum() < perimeter
    assert chords.max() <= 0.05e-3


@pytest.mark.parametrize(
    ("radius", "element_size", "expected"),
    [
        (8e-3, 1e-3, 1e-3),
        (2e-3, 1e-3, 0.5e-3),
        (2e-3, 0.4e-3, 0.4e-3),
        (2e-3, 1.5e-3, 0.75e-3),
        (2e-3, 4e-3, 1e-3),
    ],
)
def test_element_size_on_small_bumps(radius, element_size, expected):
    """Fine elements stay, middling ones are halved at most, coarse ones end at half the smaller radius."""
    assert shell_element_size(radius, 8e-3, element_size) == pytest.approx(expected)
    assert shell_element_size(8e-3, radius, element_size) == pytest.approx(expected)


def test_flip_takes_the_short_diagonal():
    """A kite split along its long diagonal is split along the short one; area and orientation stay."""
    points = np.array([[-2.0, 0, 0], [2, 0, 0], [0, 1, 0], [0, -1, 0]])
    flipped = flip_to_delaunay(points, np.array([[0, 1, 2], [1, 0, 3]]))
    assert smallest_angles(points, flipped).min() == pytest.approx(2 * math.degrees(math.atan(0.5)), abs=1e-9)
    assert areas(points, flipped).sum() == pytest.approx(4.0)
    assert (unit_normals(points, flipped)[:, 2] == 1).all()


def test_flip_makes_no_double_edge():
    """On a flat tetrahedron the other diagonal of each obtuse pair is an edge already: nothing may flip."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 1, 0], [0.5, 0.1, 0.01]])
    tetrahedron = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    assert (flip_to_delaunay(points, tetrahedron) == tetrahedron).all()


def test_relaxed_plane_keeps_area_and_gains_angles():
    """Random points in a square: relaxing keeps boundary and area, and raises the smallest angle."""
    from scipy.spatial import Delaunay

    random = np.random.default_rng(3)
    side = np.linspace(0, 1, 11)
    rim = np.unique(np.concatenate([[(s, 0), (s, 1), (0, s), (1, s)] for s in side]), axis=0)
    plane = np.concatenate([rim, random.uniform(0.05, 0.95, (80, 2))])
    points = np.column_stack([plane, np.zeros(len(plane))])
    triangles = Delaunay(plane).simplices.astype(np.int64)
    corners = points[triangles]
    down = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] < 0
    triangles[down] = triangles[down][:, ::-1]
    fixed = np.arange(len(points)) < len(rim)
    moved, better = relax(points, triangles, fixed, lambda at: at, sweeps=30)
    assert (moved[fixed] == points[fixed]).all()
    assert areas(moved, better).sum() == pytest.approx(1.0, rel=1e-12)
    assert nonmanifold_edges(better).size == 0
    assert smallest_angles(moved, better).min() > 20 > 10 > smallest_angles(points, triangles).min()
