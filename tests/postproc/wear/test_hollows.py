"""What nodes in hollows hand over to the walls: nothing on planes and domes, all in pits, little where it is smooth."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate, sphere
from bulkwear.postproc.wear.displacement import displace
from bulkwear.postproc.wear.hollows import STRENGTH, handed_over, handed_part

SEED = 20220317
ROUNDING = 1e-12  # relative: sums of three numbers
FLAT = 1e-15  # -, the part handed over on a plane: cosines differ from 1 by rounding only
FIRST_ORDER = 1.8  # -, halving the edge must divide a first-order part by this (2 in the limit)
HEALED = 0.85  # -, of a pit of 0.4 mm after 0.2 mm of wear; by mean normals it grows instead
STRAIGHT_RIDGE = 0.15  # -, handed over along a straight ridge: spokes of a triangulation tell directions roughly


def incidence(triangles, count):
    """Dense (n, m) matrix of ones where a node is a corner of a face."""
    matrix = np.zeros((count, len(triangles)))
    matrix[triangles.ravel(), np.repeat(np.arange(len(triangles)), 3)] = 1.0
    return matrix


def part_of(points, triangles):
    return handed_part(points, triangles, incidence(triangles, len(points)))


def cone(slope):
    """Six faces round a node at the origin that rise at an angle `slope`, rad."""
    angle = np.arange(6) * np.pi / 3.0
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.full(6, np.tan(slope))])
    k = np.arange(6)
    return np.vstack([np.zeros(3), ring]), np.column_stack([np.zeros(6, dtype=int), 1 + k, 1 + (k + 1) % 6])


def node_at(mesh, x, y):
    return int(np.argmin(np.hypot(mesh.points[:, 0] - x, mesh.points[:, 1] - y)))


def test_planes_and_domes_hand_nothing_over():
    """Where no edge rises from a node its wear stays."""
    plate, ball = flat_plate(0.03, 0.03, 3e-3), sphere(0.05, 2)
    assert part_of(plate.points, plate.triangles).max() <= FLAT
    assert not part_of(ball.points, ball.triangles).any()
    points, triangles = cone(-0.5)
    assert part_of(points, triangles)[0] == 0.0


@pytest.mark.parametrize("slope", [0.05, 0.3, 0.6, 1.0])
def test_a_pit_hands_over_by_its_slope(slope):
    """At the tip of a hollow cone the part is STRENGTH * sin slope, all of it where that is above 1."""
    points, triangles = cone(slope)
    expected = min(STRENGTH * np.sin(slope), 1.0)
    assert part_of(points, triangles)[0] == pytest.approx(expected, rel=1e-9)


def test_a_dip_in_a_ridge_is_a_hollow():
    """A node that lies low between two nodes of a ridge hands over, though its walls fall; on a straight one hardly."""
    plate = flat_plate(0.02, 0.02, 1e-3)
    points = plate.points.copy()
    points[:, 2] = -np.abs(points[:, 0])
    middle = node_at(plate, 0.0, 0.0)
    assert points[middle, 2] == 0.0
    straight = part_of(points, plate.triangles)[middle]
    points[middle, 2] = -0.6e-3
    assert straight < STRAIGHT_RIDGE < 3.0 * STRAIGHT_RIDGE < part_of(points, plate.triangles)[middle]


def test_smooth_hollows_hand_over_to_first_order():
    """In a round groove the part falls with the edge, and stays a small one."""

    def part(edge):
        plate = flat_plate(0.04, 0.012, edge)
        points = plate.points.copy()
        points[:, 2] = 0.06 - np.sqrt(0.06**2 - points[:, 0] ** 2)
        return part_of(points, plate.triangles)[node_at(plate, 0.0, 0.0)]

    parts = [part(edge) for edge in (2e-3, 1e-3, 0.5e-3)]
    assert parts[0] > FIRST_ORDER * parts[1] > FIRST_ORDER**2 * parts[2] > 0.0
    assert parts[0] < STRENGTH * 2e-3 / 0.06  # edge over radius


def test_faces_keep_their_volume():
    """Handing over stays within each face, and no corner gets less than nothing; nodes may be kept out of it."""
    random = np.random.default_rng(SEED)
    ball = sphere(0.05, 2)
    points = ball.points * (1.0 + 0.2 * random.random((len(ball.points), 1)))
    volume = random.random(ball.triangles.shape)
    matrix = incidence(ball.triangles, len(points))
    result = handed_over(points, ball.triangles, volume, matrix)
    np.testing.assert_allclose(result.sum(axis=1), volume.sum(axis=1), rtol=ROUNDING)
    assert (result >= 0.0).all() and (result != volume).any()
    kept = np.ones(len(points), dtype=bool)
    assert np.array_equal(handed_over(points, ball.triangles, volume, matrix, kept), volume)


def test_a_pit_does_not_run_away():
    """Even wear over many updates: a pit one edge wide gets no deeper below the plate, and the volume is exact."""
    plate = flat_plate(0.02, 0.02, 1e-3)
    points, pit = plate.points.copy(), node_at(plate, 0.0, 0.0)
    points[pit, 2] = -0.4e-3
    lead, start = [0.4e-3], points
    for _ in range(10):
        points = displace(points, plate.triangles, np.full(len(plate.triangles), 2e-5 * 0.5e-6)).points
        lead.append(np.median(points[:, 2]) - points[pit, 2])
    assert (np.diff(lead) < 0.0).all()
    assert lead[-1] < HEALED * lead[0]
    assert (points[:, 2] <= start[:, 2]).all()
