"""Places within closed bodies, and surfaces on surfaces."""

import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.wear.bodies import together
from bulkwear.workflows.cases.equipment.bodies import closed_faces, first_within, is_within, on_surface, share_a_piece
from tests.workflows.cases.equipment.scenes import box, without_lid


def test_a_large_facet_is_found_in_small_room():
    """Whose corners lie all far out; beside the room, or through a corner of its box only, there is nothing."""
    facet = np.array([[-5.0, -5.0, 0.01], [5.0, -5.0, 0.01], [0.0, 9.0, 0.01]])
    triangle, half = np.array([[0, 1, 2]]), np.array([0.1, 0.1, 0.1])
    found = first_within(facet, triangle, half, 0.02)
    assert found is not None and (np.abs(found) < half).all() and found[2] == pytest.approx(0.01)
    assert first_within(facet + np.array([0, 0, 0.1]), triangle, half, 0.02) is None
    assert first_within(facet, triangle, half, 0.02, lambda at: np.hypot(at[:, 0] - 9.0, at[:, 1]) < 1.0) is None
    assert first_within(facet, triangle, np.array([0.1, -0.1, 0.1]), 0.02) is None


def test_a_place_within_bodies():
    """Within one of two, in a cavity, beside them; open pieces enclose nothing."""
    two = together([box((1.0, 1.0, 1.0), 0.5), box((1.0, 1.0, 1.0), 0.5, (3.0, 0.0, 0.0))])
    places = {(0.1, 0.2, 0.0): True, (3.1, 0.0, 0.3): True, (1.5, 0.0, 0.0): False, (9.0, 0.0, 0.0): False}
    assert {place: is_within(two.points, two.triangles, np.array(place)) for place in places} == places
    open_too = together([two, without_lid((1.0, 1.0, 1.0), 0.5, (6.0, 0.0, 0.0))])
    closed = closed_faces(open_too.triangles)
    assert closed.sum() == len(two.triangles)
    assert not is_within(open_too.points, open_too.triangles[~closed][:0], np.array([6.0, 0.0, 0.0]))


def test_how_much_of_a_surface_lies_on_another():
    """All of a body drawn with other facets, half of a plate on a wall, nothing of one beside it."""
    plate, finer = box((0.4, 0.1, 0.03), 0.025), box((0.4, 0.1, 0.03), 0.02)
    wall = box((0.6, 0.3, 0.1), 0.05, (0.0, 0.0, -0.065))
    assert on_surface(plate, finer) == on_surface(finer, plate) == 1.0
    assert on_surface(plate, wall) == 0.0  # it stands out of the box round the wall
    assert on_surface(plate, together([wall, box((0.1, 0.1, 0.4), 0.1, (0.5, 0.3, 0.0))])) == pytest.approx(
        0.04 / (2.0 * (0.04 + 0.012 + 0.003)), abs=0.02
    )
    assert on_surface(plate, box((0.4, 0.1, 0.03), 0.025, (0.0, 0.0, 0.001))) < 0.2


def test_whether_two_surfaces_have_a_piece_in_common():
    """The same body, alone or one of several, with other facets; no body that only a larger piece has a side on."""
    plate, finer = box((0.4, 0.1, 0.03), 0.025), box((0.4, 0.1, 0.03), 0.02)
    bolt, wall = box((0.1, 0.1, 0.1), 0.05, (1.0, 0.0, 0.0)), box((0.4, 0.1, 0.03), 0.025, (0.0, 0.0, -0.03))
    for other, alike in (
        (finer, True),
        (together([bolt, finer]), True),
        (wall, False),
        (together([bolt, wall]), False),
    ):
        for body in (plate, together([plate, box((0.2, 0.2, 0.2), 0.1, (0.0, 3.0, 0.0))])):
            assert share_a_piece(body, other, 0.9) is share_a_piece(other, body, 0.9) is alike
    lid = SurfaceMesh(
        plate.points, plate.triangles[(plate.points[plate.triangles][:, :, 2] > 0.015 - 1e-9).all(axis=1)]
    )
    assert on_surface(lid, plate) == 1.0
    assert not share_a_piece(lid, plate, 0.9)
