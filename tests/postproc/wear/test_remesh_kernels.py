"""Compiled loops of remeshing give, bit for bit, what plain numpy gives: a surface must not depend on which is used.

But for angles: numpy's inverse functions on processors with wide vector units rounds the last bit another way.
"""

import numpy as np
import pytest

from bulkwear.postproc.mesh import (
    area_vectors,
    areas,
    boundary_nodes,
    directed_edges,
    edge_lengths_per_triangle,
    smallest_angles,
    sum_over_nodes,
    unit_normals,
)
from bulkwear.postproc.wear.edge_kernels import common_neighbours, edge_table, on_border, sorted_edges
from bulkwear.postproc.wear.face_kernels import any_corner, corner_words, face_measures, folds, rows_among
from bulkwear.postproc.wear.remesh_kernels import (
    centroid_probes,
    edge_normals,
    heights,
    node_normals_by_angle,
    operations_of,
    opposite_areas,
    probes,
    ranges,
    relative_lengths,
    sound,
    star_sums,
)
from tests.postproc.wear.test_remesh import random_sheet

LAST_BITS = 2e-15  # -, nine of the last bit: an angle off by one of them, and sums of six faces
SEED = 20220317
GOOD_ANGLE, LEAST_COSINE, SLACK = 25.0, 0.5, 0.05


@pytest.fixture(scope="module")
def sheet():
    """A rough sheet of 288 triangles, m, without some of its faces: it has holes and corners."""
    mesh = random_sheet(SEED, 0.25, 0.4, 1.2, 0.3)
    kept = np.random.default_rng(SEED).random(len(mesh.triangles)) > 0.05
    return mesh.points, mesh.triangles[kept]


@pytest.fixture(scope="module")
def size(sheet):
    """Target edges, m, of the nodes."""
    return np.random.default_rng(SEED).uniform(0.5e-3, 2e-3, len(sheet[0]))


@pytest.fixture(scope="module")
def stars(sheet):
    """Nodes no two of which share a face, and the place of its one among them for each face, -1 without."""
    points, triangles = sheet
    of_face, nodes = np.full(len(triangles), -1), []
    for node in np.random.default_rng(SEED).permutation(len(points)):
        rows = (triangles == node).any(axis=1)
        if rows.any() and (of_face[rows] < 0).all():
            of_face[rows] = len(nodes)
            nodes.append(node)
    return np.array(nodes), of_face


def test_edges_come_in_the_order_of_their_nodes(sheet):
    """The same table as by sorting all directed edges."""
    points, triangles = sheet
    directed = directed_edges(triangles)
    low, high = directed.min(axis=1), directed.max(axis=1)
    found = {}
    for edge in np.lexsort((directed[:, 0], high, low)):
        found.setdefault((low[edge], high[edge]), []).append(edge)
    ends, faces, opposite = edge_table(triangles, *sorted_edges(triangles, len(points), True))
    assert np.array_equal(ends, [directed[edges[0]] for edges in found.values()])
    padded = np.array([(*edges, -1)[:2] for edges in found.values()])
    assert np.array_equal(faces, np.where(padded < 0, -1, padded // 3))
    assert np.array_equal(opposite, np.where(padded < 0, -1, triangles[padded // 3, (padded % 3 + 2) % 3]))
    beside = {node: set(directed[(directed == node).any(axis=1)].ravel()) - {node} for node in range(len(points))}
    expected = [len(beside[a] & beside[b]) for a, b in ends[::3]]
    assert common_neighbours(ends, np.arange(len(ends))[::3], len(points)).tolist() == expected
    assert np.array_equal(
        np.flatnonzero(on_border(triangles, *sorted_edges(triangles, len(points), False), len(points))),
        boundary_nodes(triangles),
    )


def test_measures_of_faces(sheet, size):
    """Angles, edges and areas as those of the library; folds by the normals of faces at an edge."""
    points, triangles = sheet
    lengths = edge_lengths_per_triangle(points, triangles)
    expected = smallest_angles(points, triangles), lengths, lengths.max(axis=1), areas(points, triangles)
    (angles, *others), (expected_angles, *expected_others) = face_measures(points, triangles), expected
    np.testing.assert_allclose(angles, expected_angles, rtol=LAST_BITS, atol=0.0)
    for ours, theirs in zip(others, expected_others, strict=True):
        assert np.array_equal(ours, theirs)
    ends, faces, _ = edge_table(triangles, *sorted_edges(triangles, len(points), True))
    normals = area_vectors(points, triangles) / areas(points, triangles)[:, None]
    cosine = (normals[faces[:, 0]] * normals[faces[:, 1]]).sum(axis=1)
    folded = np.unique(faces[(faces[:, 1] >= 0) & (cosine < LEAST_COSINE)])
    assert 0 < len(folded) < len(triangles)
    held = sorted_edges(triangles, len(points), False)
    assert np.flatnonzero(folds(points, triangles, *held, LEAST_COSINE)).tolist() == folded.tolist()
    length = np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1) / size[ends].mean(axis=1)
    assert np.array_equal(relative_lengths(points, ends, size), length)


def test_faces_are_compared_bit_for_bit(sheet):
    """A face is known by all nine coordinates of its corners in their order, and by their last bit."""
    points, triangles = sheet
    words, others = corner_words(points, triangles), corner_words(points, triangles[::2])
    assert np.array_equal(rows_among(words, others), np.arange(len(triangles)) % 2 == 0)
    moved = points.copy()
    moved[triangles[4, 2], 1] = np.nextafter(moved[triangles[4, 2], 1], 1.0)
    same = ~(triangles == triangles[4, 2]).any(axis=1)
    assert np.array_equal(rows_among(corner_words(moved, triangles), words), same)
    assert not rows_among(corner_words(points, np.roll(triangles, 1, axis=1)), words).any()
    assert not rows_among(words, words[:0]).any()


def test_probes_are_corners_middles_and_centroids(sheet, size):
    """Seven places of each face, common ones asked for once, and their range over the mean target edge."""
    points, triangles = sheet
    place, at = probes(points, triangles)
    corners = points[triangles]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    expected = np.concatenate([corners, middles, corners.mean(axis=1, keepdims=True)], axis=1)
    assert np.array_equal(place[at], expected)
    assert len(np.unique(place, axis=0)) == len(place)
    assert np.array_equal(centroid_probes(points, triangles)[0], corners.mean(axis=1))
    distance = place @ np.array([0.3, -0.5, 0.8])
    over = distance[at] / size[triangles].mean(axis=1, keepdims=True)
    assert np.array_equal(ranges(distance, at, triangles, size), np.stack([over.min(axis=1), over.max(axis=1)], axis=1))


def test_sums_round_nodes(sheet, size, stars):
    """The sums over all faces at a node, in the order in which `sum_over_nodes` adds them."""
    points, triangles = sheet
    nodes, of_face = stars
    vectors = area_vectors(points, triangles)
    density = np.linalg.norm(vectors, axis=1) / size[triangles].mean(axis=1) ** 2
    fields = density, density[:, None] * points[triangles].mean(axis=1), vectors
    for ours, field in zip(star_sums(points, triangles, size, of_face, nodes), fields, strict=True):
        assert np.array_equal(ours, sum_over_nodes(triangles, field, len(points))[nodes])
    operation = np.full(len(points), -1)
    operation[nodes] = np.arange(len(nodes))
    found, taking_part = operations_of(triangles, operation)
    assert np.array_equal(found, of_face)
    assert np.array_equal(taking_part, (operation[triangles] >= 0).sum(axis=1))
    assert np.array_equal(any_corner(operation >= 0, triangles), of_face >= 0)
    places, first = points[triangles].mean(axis=1), triangles[:, 1]
    theirs = np.cross(points[triangles[:, 2]] - places, points[triangles[:, 0]] - places)
    assert np.array_equal(opposite_areas(points, triangles, first, places), theirs)


def test_the_side_of_a_place_is_told_by_the_normal_there(sheet):
    """Closest to a face its own normal tells, to an edge the sum of its faces', to a corner that of all by angle."""
    points, triangles = sheet
    normals = unit_normals(points, triangles)
    _, faces, opposite = edge_table(triangles, *sorted_edges(triangles, len(points), True))
    of_edge = edge_normals(normals, *sorted_edges(triangles, len(points), False))
    both = np.where(faces[:, 1:] >= 0, normals[faces[:, 0]] + normals[faces[:, 1]], normals[faces[:, 0]])
    at = (triangles[faces[:, 0]] == opposite[:, :1]).argmax(axis=1)
    assert np.array_equal(of_edge[faces[:, 0], at], both)
    corners = points[triangles]
    spokes = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    angle = np.arctan2(np.linalg.norm(np.cross(*spokes), axis=2), (spokes[0] * spokes[1]).sum(axis=2))
    of_node = np.zeros_like(points)
    np.add.at(of_node, triangles, angle[:, :, None] * normals[:, None])
    ours = node_normals_by_angle(points, triangles, normals)
    np.testing.assert_allclose(ours, of_node, rtol=LAST_BITS, atol=LAST_BITS * np.abs(of_node).max())
    offset = np.array([1e-4, -2e-4, 3e-4])
    rows = np.arange(len(triangles))
    for nearest, normal in (
        (corners.mean(axis=1), normals),
        (0.5 * (corners[:, 1] + corners[:, 2]), of_edge[:, 0]),
        (corners[:, 1], of_node[triangles[:, 1]]),
    ):
        told = heights(nearest + offset, nearest, rows, points, triangles, normals, of_edge, of_node, 1e-6)
        np.testing.assert_allclose(told, normal @ offset, rtol=0.0, atol=1e-15)


def cosines(vectors, others):
    """Cosine between rows, -1 where one of them is zero."""
    length = np.linalg.norm(vectors, axis=1) * np.linalg.norm(others, axis=1)
    return np.divide((vectors * others).sum(axis=1), length, out=np.full(len(length), -1.0), where=length > 0.0)


def soundly(points, triangles, new_points, new_triangles, of_face, alive, fixed, count):
    """What `sound` says, one operation after the other."""
    good = np.zeros(count, dtype=bool)
    for operation in np.unique(of_face[of_face >= 0]):
        rows, left = of_face == operation, (of_face == operation) & alive
        vectors, new_vectors = area_vectors(points, triangles[rows]), area_vectors(new_points, new_triangles[left])
        mean = np.zeros(3)
        for vector in vectors:
            mean += vector
        angle = min(smallest_angles(points, triangles[rows]).min(), GOOD_ANGLE)
        least = min(cosines(vectors, np.tile(mean, (len(vectors), 1))).min(), LEAST_COSINE) - SLACK
        new_cosines = cosines(new_vectors, np.tile(mean, (len(new_vectors), 1)))
        held = fixed[triangles[rows]].all(axis=1).sum(), fixed[new_triangles[left]].all(axis=1).sum()
        acute = smallest_angles(new_points, new_triangles[left]) < angle
        good[operation] = held[1] <= held[0] and not acute.any() and (new_cosines >= least).all()
    return good


@pytest.mark.parametrize("step", [0.0, 1e-5, 1e-4, 5e-4])
def test_operations_are_judged_by_angles_normals_and_what_is_held(sheet, stars, step):
    """Nodes moved a little or a lot; no motion at all passes, a large one turns faces."""
    points, triangles = sheet
    nodes, of_face = stars
    random = np.random.default_rng(SEED)
    moved = points.copy()
    moved[nodes] += step * random.normal(size=(len(nodes), 3))
    alive, fixed = random.random(len(triangles)) > 0.2, random.random(len(points)) > 0.3
    turned = triangles.copy()
    turned[random.random(len(triangles)) > 0.98] = triangles[0]  # other faces after it
    for after in (triangles, turned):
        given = points, triangles, moved, after, of_face, alive, fixed, len(nodes)
        expected = soundly(*given)
        assert np.array_equal(sound(*given, GOOD_ANGLE, LEAST_COSINE, SLACK), expected)
    assert (step > 0.0) or soundly(points, triangles, moved, triangles, of_face, alive, fixed, len(nodes)).all()
