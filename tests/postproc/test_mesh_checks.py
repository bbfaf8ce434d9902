"""Faces that cut one another, faces that cover one another, boxes that overlap."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate, sphere
from bulkwear.postproc import mesh_checks
from bulkwear.postproc.mesh_checks import intersecting_faces, overlapping_boxes, overlapping_faces

SEED = 20220317
CLEARANCE = 1e-3  # of the unit in which the sheets here are given


def crossing_sheets():
    """Two triangles that share no node; an edge of the second passes through the first at its centroid."""
    points = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0], [1, 1, -1], [1, 1, 2], [5, 5, 2.0]])
    return points, np.array([[0, 1, 2], [3, 4, 5]])


def test_cutting_faces_are_found_in_any_order():
    """An edge through a face is found whichever face comes first; shifted away it is not."""
    points, triangles = crossing_sheets()
    for order in ([0, 1], [1, 0]):
        assert intersecting_faces(points, triangles[order]).tolist() == [[0, 1]]
    points[3:] += (3.0, 3.0, 0.0)
    assert len(intersecting_faces(points, triangles)) == 0


def test_faces_of_unlike_size_cut():
    """A face a hundred times smaller that pierces a large one is found: size classes hide nothing."""
    points, triangles = crossing_sheets()
    points[3:] = np.array([1.0, 1.0, 0.0]) + 0.01 * (points[3:] - points[3])
    points[3:, 2] -= 0.005
    assert intersecting_faces(points, triangles).tolist() == [[0, 1]]


def test_faces_with_a_common_node():
    """Of faces that share one node the opposite edges are tested: piercing is found, mere touching at it is none."""
    points = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 1], [1, 1, -1], [-1, -1, 1], [-2, -1, 1.0]])
    assert intersecting_faces(points, np.array([[0, 1, 2], [0, 3, 4]])).tolist() == [[0, 1]]
    assert len(intersecting_faces(points, np.array([[0, 1, 2], [0, 5, 6]]))) == 0


def test_search_among_some_faces():
    """Only pairs with one of the named faces are looked for, and all of those are found."""
    random = np.random.default_rng(SEED)
    corners = random.random((60, 3, 3))
    points, triangles = corners.reshape(-1, 3), np.arange(180).reshape(-1, 3)
    pairs = intersecting_faces(points, triangles)
    among = np.arange(60) < 10
    expected = pairs[among[pairs].any(axis=1)]
    assert len(pairs) > len(expected) > 0
    assert np.array_equal(intersecting_faces(points, triangles, among), expected)


def passes_through(edge, face):
    """Whether a segment (2, 3) passes through a triangle (3, 3), by solving for where it meets its plane."""
    sides = np.column_stack([face[1] - face[0], face[2] - face[0], edge[0] - edge[1]])
    first, second, along = np.linalg.solve(sides, edge[0] - face[0])
    return min(first, second, 1.0 - first - second, along, 1.0 - along) > 0.0


def test_all_cuts_of_random_faces_are_found():
    """The same pairs as by asking of every two faces whether an edge of one passes through the other."""
    corners = np.random.default_rng(SEED).random((40, 3, 3))
    expected = []
    for i, j in zip(*np.triu_indices(40, 1), strict=True):
        ways = ((corners[a][[k, (k + 1) % 3]], corners[b]) for a, b in ((i, j), (j, i)) for k in range(3))
        if any(passes_through(*way) for way in ways):
            expected.append([i, j])
    assert len(expected) > 50
    assert intersecting_faces(corners.reshape(-1, 3), np.arange(120).reshape(-1, 3)).tolist() == expected


def test_sound_surfaces_neither_cut_nor_cover_themselves():
    """Plate and sphere: no pair, although neighbours touch everywhere."""
    for mesh in (flat_plate(0.06, 0.039, 0.003), sphere(0.01, 3)):
        assert len(intersecting_faces(mesh.points, mesh.triangles)) == 0
        assert len(overlapping_faces(mesh.points, mesh.triangles, 1e-9)) == 0


@pytest.mark.parametrize(("depth", "count"), [(0.5 * CLEARANCE, 0), (2.0 * CLEARANCE, 1)])
def test_clearance_forgives_what_hardly_passes_through(depth, count):
    """A face whose corner comes through another one by less than the clearance touches it; by more it cuts it."""
    points, triangles = crossing_sheets()
    points[3:, 2] += 1.0 - depth
    assert len(intersecting_faces(points, triangles, clearance_m=CLEARANCE)) == count


@pytest.mark.parametrize(
    ("shift", "count"),
    [((0.5, 0.5, 0.0), 1), ((0.5, 0.5, 0.5 * CLEARANCE), 1), ((0.5, 0.5, 2.0 * CLEARANCE), 0), ((3.0, 0.0, 0.0), 0)],
)
def test_faces_in_one_plane_that_cover_one_another(shift, count):
    """A copy shifted within the plane covers; off the plane by more than the clearance, or beside it, it does not."""
    sheet = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0.0]])
    points = np.concatenate([sheet, sheet + shift])
    assert len(overlapping_faces(points, np.arange(6).reshape(2, 3), CLEARANCE)) == count


def test_a_face_folded_back_on_its_neighbour_covers_it():
    """Two faces at an edge, both on the same side of it, cover one another; on two sides they do not."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.9, 0], [0.5, -1, 0.0]])
    assert overlapping_faces(points, np.array([[0, 1, 2], [1, 0, 3]]), CLEARANCE).tolist() == [[0, 1]]
    assert len(overlapping_faces(points, np.array([[0, 1, 2], [1, 0, 4]]), CLEARANCE)) == 0


@pytest.mark.parametrize("block", [7, 100_000])
def test_all_pairs_of_boxes_are_found(monkeypatch, block):
    """The tree finds the pairs that comparing all with all finds, once each, however small the blocks are."""
    monkeypatch.setattr(mesh_checks, "LARGEST_PAIR_BLOCK", block)
    random = np.random.default_rng(SEED)
    low = random.random((300, 3))
    high = low + random.random((300, 3)) ** 8  # few large ones among small ones
    overlap = ((low[:, None] <= high) & (low <= high[:, None])).all(axis=2)
    expected = np.argwhere(np.triu(overlap, 1))
    found = np.concatenate(list(overlapping_boxes(low, high)))
    assert len(found) == len(expected) > 100
    assert np.array_equal(np.unique(np.sort(found, axis=1), axis=0), expected)
