"""Bodies of one surface: taken apart and put together again, nothing is lost, renamed or out of order."""

import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.wear.bodies import body, together
from bulkwear.postproc.wear.thickness import REMAINING_THICKNESS, with_thickness
from bulkwear.postproc.wear.update import REMOVED_THICKNESS, with_depths
from tests.support.own_solids import box

LABELS = (0, -2, 2)  # a part that wears, a rigid one, one that wears


def of_label(label, size, corner):
    """A box with a label, and values that name each of its faces and nodes."""
    points, triangles = box(size, corner)
    faces, nodes = 100.0 * label + np.arange(12), 100.0 * label + np.arange(8)
    return SurfaceMesh(
        points,
        triangles,
        {"part": np.full(12, label), "load": faces},
        {"name": nodes, "path": nodes[:, None] * [1, 2, 3]},
    )


@pytest.fixture
def three():
    """Three boxes, the second in the room of the first: parts may stand in one another's way as drawn."""
    corners = ((0, 0, 0), (0.01, 0.01, 0.01), (0.3, 0, 0))
    return [of_label(label, (0.1, 0.08, 0.06), corner) for label, corner in zip(LABELS, corners, strict=True)]


def same(one, other):
    """Whether two surfaces are the same to the last bit, types of data included."""
    np.testing.assert_array_equal(one.points, other.points, strict=True)
    np.testing.assert_array_equal(one.triangles, other.triangles)
    for name in ("cell_data", "point_data"):
        ours, theirs = getattr(one, name), getattr(other, name)
        assert list(ours) == list(theirs)
        for key in ours:
            np.testing.assert_array_equal(ours[key], theirs[key], strict=True)
    return True


def test_apart_and_together_is_the_surface(three):
    """Each body is the box that it was, and all of them are the surface."""
    whole = together(three)
    assert whole.cell_data["part"].tolist() == np.repeat(LABELS, 12).tolist()
    apart = [body(whole, whole.cell_data["part"] == label) for label in LABELS]
    assert all(same(one, box) for one, box in zip(apart, three, strict=True))
    assert same(together(apart), whole)


def test_faces_of_bodies_need_not_follow_one_another(three):
    """Of faces in any order a body keeps theirs, and each face its corners and data."""
    whole, order = together(three), np.random.default_rng(1).permutation(36)
    mixed = SurfaceMesh(
        whole.points,
        whole.triangles[order],
        {name: values[order] for name, values in whole.cell_data.items()},
        whole.point_data,
    )
    for label in LABELS:
        one = body(mixed, mixed.cell_data["part"] == label)
        theirs = np.flatnonzero(mixed.cell_data["part"] == label)
        np.testing.assert_array_equal(one.points[one.triangles], mixed.points[mixed.triangles[theirs]])
        np.testing.assert_array_equal(one.cell_data["load"], mixed.cell_data["load"][theirs])
        np.testing.assert_array_equal(
            one.point_data["name"][one.triangles], mixed.point_data["name"][mixed.triangles[theirs]]
        )
        assert len(one.points) == 8


def test_data_that_a_body_lacks_is_nothing_there(three):
    """Zeros of the same kind and width, on its own faces and nodes alone."""
    first, second, third = three
    bare = SurfaceMesh(second.points, second.triangles, {"part": second.cell_data["part"]})
    whole = together([first, bare, third])
    assert whole.point_data["path"].shape == (24, 3)
    assert not whole.point_data["path"][8:16].any() and not whole.cell_data["load"][12:24].any()
    np.testing.assert_array_equal(whole.point_data["path"][16:], third.point_data["path"])
    assert whole.cell_data["part"].dtype == first.cell_data["part"].dtype


def test_body_of_faces_that_share_nodes_has_its_own_nodes():
    """A side of a box, whose nodes other sides share, is a surface of four nodes."""
    points, triangles = box((1.0, 1.0, 1.0))
    top = (points[triangles][:, :, 2] == 1.0).all(axis=1)
    side = body(SurfaceMesh(points, triangles), top)
    assert len(side.points) == 4 and len(side.triangles) == 2 and (side.points[:, 2] == 1.0).all()


def test_body_that_does_not_wear_has_no_depth(three):
    """Depths of a rigid body are 0, its remaining thickness is not known."""
    rigid = with_thickness(three[1])
    found = with_depths(SurfaceMesh(rigid.points, rigid.triangles, rigid.cell_data, rigid.point_data), three[1])
    assert REMOVED_THICKNESS not in three[1].point_data
    assert not found.point_data["ray_depth_m"].any() and not found.point_data["normal_depth_m"].any()
    assert np.isnan(found.point_data[REMAINING_THICKNESS]).all()
