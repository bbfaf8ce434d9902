"""The touched side: pieces are turned towards the particles once, and what is pressed from both sides is refused."""

import numpy as np
import pytest
from hypothesis import given, seed, settings
from hypothesis import strategies as st

from bulkwear.postproc.mesh import SurfaceMesh, areas
from bulkwear.postproc.wear.balance import lost_volume
from bulkwear.postproc.wear.built_shape import with_built_shape
from bulkwear.postproc.wear.side import KNOWN, TURNED, UNKNOWN, TouchedSideError, turned_to_flow, with_sides
from bulkwear.postproc.wear.update import wear_update
from tests.support.shapes import box, cone, drum_with_lifters, flipped, moved_rigidly, plate, shifted, welded

SEED = 20220317
SAME = 1e-12  # relative: turned triangles give sums in another order
NOTHING = 0.0
SHAPES = {
    "plate": lambda: plate(0.4, 0.3, 6),
    "body": lambda: box((0.3, 0.2, 0.1), 4),
    "cone": lambda: cone(0.1, 0.3, 0.4, 24, 4, inward=True),
    "drum": lambda: drum_with_lifters(0.5, 6, 0.05, 0.04, 0.3, 2)[0],
}


def even(mesh):
    """Impulse (m,) N s of an even pressure."""
    return areas(mesh.points, mesh.triangles)


def two_plates():
    """Two plates, 0.5 m apart, the upper one with its normals down."""
    lower, upper = plate(0.4, 0.3, 4), flipped(shifted(plate(0.4, 0.3, 4), (0.0, 0.0, 0.5)))
    return welded(lower, upper, labels=True)


def test_pieces_that_look_away_are_turned_once():
    """Each piece by itself: the one that is pressed from behind is turned and told, the other one stays."""
    mesh = two_plates()
    upper = mesh.cell_data["part"] == 1
    front, back = np.where(upper, 0.0, even(mesh)), np.where(upper, even(mesh), 0.0)
    turned, told = turned_to_flow(mesh, front, back)
    assert np.array_equal(turned.triangles[~upper], mesh.triangles[~upper])
    assert np.array_equal(turned.triangles[upper], mesh.triangles[upper][:, [0, 2, 1]])
    assert [(piece.parts, piece.faces, piece.share) for piece in told] == [((1,), int(upper.sum()), 1.0)]
    assert np.array_equal(turned.cell_data["side"], np.where(upper, TURNED, KNOWN))
    again, told = turned_to_flow(turned, front + back, 0.0 * back)
    assert again is turned
    assert told == []


def test_what_nothing_presses_on_stays_unknown():
    """A piece without contacts keeps its triangles, and may be turned later."""
    mesh = two_plates()
    upper = mesh.cell_data["part"] == 1
    first, _ = turned_to_flow(mesh, np.where(upper, 0.0, even(mesh)), 0.0 * even(mesh))
    assert np.array_equal(first.cell_data["side"], np.where(upper, UNKNOWN, KNOWN))
    assert np.array_equal(first.triangles, mesh.triangles)
    second, told = turned_to_flow(first, 0.0 * even(mesh), np.where(upper, even(mesh), 0.0))
    assert len(told) == 1
    assert (second.cell_data["side"][upper] == TURNED).all()


def test_pressed_from_both_sides_is_refused():
    """Named are piece, part, both impulses and the place; a graze from behind of 1 % is allowed."""
    mesh = plate(0.4, 0.3, 4)
    front, back = even(mesh), 0.01 * even(mesh)
    assert turned_to_flow(mesh, front, back)[1] == []
    back[5] += 0.5
    with pytest.raises(
        TouchedSideError, match=r"piece 0 \(part 0, 32 faces\) is pressed from both sides: .* mm, allowed"
    ):
        turned_to_flow(mesh, front, back)


def test_a_soft_sphere_at_a_lip_is_no_fault_of_a_closed_body():
    """A tenth from behind is allowed where the body has a back of its own, a half is not."""
    mesh = box((0.3, 0.2, 0.1), 4)
    assert turned_to_flow(mesh, even(mesh), 0.1 * even(mesh))[1] == []
    with pytest.raises(TouchedSideError, match="from both sides"):
        turned_to_flow(mesh, even(mesh), even(mesh))


def test_the_other_side_than_before_is_refused():
    """Once the touched side is known, contacts on the other one are a fault, not a reason to turn again."""
    mesh, _ = turned_to_flow(plate(0.4, 0.3, 4), even(plate(0.4, 0.3, 4)), NOTHING * even(plate(0.4, 0.3, 4)))
    with pytest.raises(TouchedSideError, match="on the other side than before"):
        turned_to_flow(mesh, NOTHING * even(mesh), even(mesh))


def test_a_vessel_wears_from_inside():
    """A closed body with particles in it: its normals turn inwards, and its wall recedes outwards."""
    mesh = box((0.3, 0.2, 0.1), 4)
    volume = 1e-3 * even(mesh)
    worn, record = wear_update(mesh, volume, pressed=(NOTHING * volume, even(mesh)))
    assert record["turned_faces"] == len(mesh.triangles)
    assert worn.points[:, 2].min() < 0.0
    assert lost_volume(mesh, worn)[0] == pytest.approx(volume.sum(), rel=1e-9, abs=0.0)


@pytest.mark.parametrize("shape", SHAPES)
def test_flipped_input_wears_to_the_same_surface(shape):
    """Normals the right way or the wrong way, built shape known or not: the same nodes, volume and depths."""
    for prepared in (with_built_shape, with_sides):
        mesh = SHAPES[shape]()
        right, wrong = prepared(mesh), prepared(flipped(mesh))
        volume = 1e-3 * even(mesh) * np.random.default_rng(SEED).random(len(mesh.triangles))
        first, told = wear_update(right, volume, pressed=(even(mesh), NOTHING * volume))
        second, other = wear_update(wrong, volume, pressed=(NOTHING * volume, even(mesh)))
        assert second.points == pytest.approx(first.points, rel=SAME, abs=SAME)
        assert lost_volume(flipped(mesh), second)[0] == pytest.approx(lost_volume(mesh, first)[0], rel=1e-9, abs=0.0)
        assert other["largest_depth_m"] == pytest.approx(told["largest_depth_m"], rel=1e-9, abs=0.0)
        assert (told["turned_faces"], other["turned_faces"]) == (0, len(mesh.triangles))


@given(st.tuples(*[st.floats(-np.pi, np.pi)] * 3), st.booleans(), st.integers(0, 2**32 - 1))
@settings(max_examples=10, deadline=None)
@seed(SEED)
def test_nothing_grows_at_any_attitude(angles, wrong, number):
    """Random wear of a plate, turned and flipped at random: no node comes nearer to the particles."""
    mesh = moved_rigidly(plate(0.4, 0.3, 6), angles, (0.0, 0.0, 0.0))
    up = np.cross(mesh.points[7] - mesh.points[0], mesh.points[1] - mesh.points[0])
    given_mesh = flipped(mesh) if wrong else mesh
    volume = 2e-3 * even(mesh) * np.random.default_rng(number).random(len(mesh.triangles))
    sides = (NOTHING * volume, volume) if wrong else (volume, NOTHING * volume)
    worn, _ = wear_update(given_mesh, volume, pressed=sides)
    assert ((worn.points - mesh.points) @ up <= 1e-15).all()


def test_faces_that_do_not_wear_do_not_count():
    """A holder that is touched from behind says nothing about the side of what wears."""
    mesh = plate(0.4, 0.3, 4)
    part = np.where(np.arange(len(mesh.triangles)) < 4, -1, 0)
    mesh = SurfaceMesh(mesh.points, mesh.triangles, {"part": part})
    front, back = np.where(part < 0, 0.0, even(mesh)), np.where(part < 0, even(mesh), 0.0)
    assert turned_to_flow(mesh, front, back, part >= 0)[1] == []
