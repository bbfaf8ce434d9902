"""Local thickness measured and given, what is left of it, and where a part is worn through."""

import re

import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh, areas, enclosed_volume, unit_normals
from bulkwear.postproc.wear.balance import lost_volume
from bulkwear.postproc.wear.built_shape import with_built_shape
from bulkwear.postproc.wear.thickness import remaining_thickness, through_phrase, with_thickness, worn_through
from bulkwear.postproc.wear.update import wear_update, with_depths
from tests.support.shapes import box, cone, flipped, moved_rigidly, plate, shifted, welded

RAY = 1e-6  # relative: rays begin a thousandth of an element off the corner, on the flat face
EXACT = 1e-9  # relative
THICK = 0.02  # m
MEET = 5e-5  # m, where two sides meet: what the back has lost is known by faces, which differ by an update


def hollow_box():
    """A box of 0.3 x 0.2 x 0.1 m inside with walls of THICK: outside and cavity, one part."""
    outer = shifted(box((0.3 + 2 * THICK, 0.2 + 2 * THICK, 0.1 + 2 * THICK), 6), (-THICK, -THICK, -THICK))
    return welded(box((0.3, 0.2, 0.1), 6, inward=True), outer)


def on_cavity(mesh):
    """Mask of the faces of the cavity of `hollow_box`."""
    corners = mesh.points[mesh.triangles]
    inside = (corners > -1e-9).all(axis=2) & (corners < np.array([0.3, 0.2, 0.1]) + 1e-9).all(axis=2)
    return inside.all(axis=1)


def test_a_wall_s_thickness_is_measured_to_its_back():
    """From inside and outside, at flat places and edges, turned anyhow: the wall's thickness."""
    for mesh in (hollow_box(), moved_rigidly(hollow_box(), (0.4, -1.0, 2.0), (3.0, 1.0, -2.0))):
        thickness = with_thickness(mesh).point_data["local_thickness_m"]
        inner = np.unique(mesh.triangles[on_cavity(hollow_box())])
        assert thickness[inner] == pytest.approx(THICK, rel=RAY, abs=0.0)


def test_a_hopper_s_wall():
    """Between two cones of one slope the thickness square to the wall is the same everywhere, polygons apart."""
    slope, around = 0.4, 60
    inner = cone(0.1, 0.3, slope, around, 6, inward=True)
    outer = cone(0.1 + THICK / np.cos(slope), 0.3, slope, around, 6, inward=False)
    shell = welded(inner, outer)
    thickness = with_thickness(shell).point_data["local_thickness_m"]
    height = shell.points[:, 2]
    on_inner = np.isin(np.round(shell.points, 9), np.round(inner.points, 9)).all(axis=1)
    # rays from the inner wall go down as they go out: those near the lower rim leave below the outer one
    seen = on_inner & (height > 2.0 * THICK)
    assert thickness[seen] == pytest.approx(THICK, rel=1.0 - np.cos(np.pi / around), abs=0.0)
    assert np.isnan(thickness[on_inner & (height == 0.0)]).all()


def test_plates_without_a_back_have_a_given_thickness():
    """Measured it is unknown; given by part, nodes between two parts have the thinner one."""
    mesh = welded(plate(0.2, 0.2, 4), shifted(plate(0.2, 0.2, 4), (0.2, 0.0, 0.0)), labels=True)
    assert np.isnan(with_thickness(mesh).point_data["local_thickness_m"]).all()
    thickness = with_thickness(mesh, {0: 0.03, 1: 0.01}).point_data["local_thickness_m"]
    assert np.array_equal(thickness, np.where(mesh.points[:, 0] < 0.199, 0.03, 0.01))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({7: 0.1}, "for part 7, allowed are the parts that wear: 0"),
        (0.0, "part 0 is 0.0 m"),
        (np.nan, "part 0 is nan m"),
    ],
)
def test_senseless_thickness_is_refused(given, message):
    """Thickness of a part that is not there, of zero and of no number."""
    with pytest.raises(ValueError, match=message):
        with_thickness(plate(0.2, 0.2, 2), given)


def test_remaining_thickness_of_an_eroded_box():
    """One inner side worn by d: there the wall has t - d left, elsewhere t."""
    mesh = with_thickness(with_built_shape(hollow_box()))
    corners = mesh.points[mesh.triangles]
    floor = on_cavity(mesh) & (corners[:, :, 2].max(axis=1) < 1e-9)
    worn, _ = wear_update(mesh, floor * 5e-3 * areas(mesh.points, mesh.triangles))
    left, nodes = remaining_thickness(worn), np.unique(mesh.triangles[floor])
    assert left[nodes] == pytest.approx(THICK - 5e-3, rel=RAY, abs=0.0)
    under = (mesh.points[:, 2] < -0.5 * THICK) & (mesh.points[:, :2] >= 0.0).all(axis=1)
    under &= (mesh.points[:, :2] <= (0.3, 0.2)).all(axis=1)
    assert left[under] == pytest.approx(THICK - 5e-3, rel=RAY, abs=0.0)  # seen from outside it is as thin
    others = np.setdiff1d(np.arange(len(left)), np.union1d(nodes, np.flatnonzero(under)))
    assert left[others] == pytest.approx(mesh.point_data["local_thickness_m"][others])
    assert lost_volume(mesh, worn)[0] == pytest.approx(0.06 * 5e-3, rel=EXACT, abs=0.0)
    assert with_depths(worn, mesh).point_data["remaining_thickness_m"][nodes] == pytest.approx(
        THICK - 5e-3, rel=RAY, abs=0.0
    )


def test_worn_through_is_found_with_its_place():
    """A plate of 10 mm after 4, 8 and 12 mm: through in the third update, told with the place."""
    mesh = with_thickness(plate(0.2, 0.2, 4), 0.01)
    for number in range(3):
        assert through_phrase(mesh) is None
        mesh, record = wear_update(mesh, 4e-3 * areas(mesh.points, mesh.triangles))
        assert (record["through_nodes"] > 0) == (number == 2)
    assert worn_through(mesh).all()
    assert (remaining_thickness(mesh) == 0.0).all()
    phrase = r"worn through at 25 nodes, first at \(.*, -12\) mm, where the part was 10 mm thick"
    assert re.fullmatch(phrase, through_phrase(mesh))


def test_wear_stops_at_the_back_where_asked():
    """Capped, nodes end at the back exactly; the law's volume beyond it is told apart, and the balance closes."""
    pristine = with_thickness(plate(0.2, 0.2, 4), 0.01)
    mesh, law, beyond = pristine, 0.0, 0.0
    for _ in range(4):
        mesh, record = wear_update(mesh, 4e-3 * areas(mesh.points, mesh.triangles), back="cap")
        law, beyond = law + record["worn_volume_m3"], beyond + record["beyond_back_volume_m3"]
        lost = lost_volume(pristine, mesh)[0]
        assert lost + record["carried_volume_m3"] + beyond == pytest.approx(law, rel=EXACT, abs=0.0)
    assert mesh.points[:, 2] == pytest.approx(-0.01, rel=EXACT, abs=0.0)
    assert beyond == pytest.approx(law * 6.0 / 16.0, rel=EXACT, abs=0.0)
    assert record["carried_volume_m3"] == 0.0


@pytest.mark.parametrize("wrong", [False, True])
def test_a_thin_body_worn_from_both_sides_is_through_when_they_meet(wrong):
    """A closed plate of 2 mm, 0.04 mm per update on either face: both have lost half when it is through, not all.

    With its normals the wrong way it is the same. Capped, the faces do not pass through one another.
    """
    body = box((0.1, 0.08, 2e-3), 6)
    mesh = with_thickness(with_built_shape(flipped(body) if wrong else body))
    area = areas(mesh.points, mesh.triangles)
    centre = mesh.points[mesh.triangles].mean(axis=1)[:, :2] - (0.05, 0.04)
    broad = (np.abs(unit_normals(mesh.points, mesh.triangles)[:, 2]) > 0.9) & (np.abs(centre) < 0.03).all(axis=1)
    for number in range(40):
        pressed = (0.0 * area, area) if wrong and number == 0 else (area, 0.0 * area)
        mesh, record = wear_update(mesh, broad * 4e-5 * area, pressed=pressed, back="cap")
        if number < 24:
            assert record["through_nodes"] == 0
    middle = (np.abs(mesh.points[:, :2] - (0.05, 0.04)) < 0.01).all(axis=1)
    assert worn_through(mesh)[middle].all()
    top, bottom = (mesh.points[middle & (body.points[:, 2] > level)][:, 2].min() for level in (1e-3, -1.0))
    assert top == pytest.approx(1e-3, abs=MEET)
    assert bottom == pytest.approx(1e-3, abs=MEET)
    assert enclosed_volume(mesh.points, mesh.triangles) >= 0.0
    assert record["beyond_back_volume_m3"] > 0.0


def test_an_edge_is_not_through_before_its_faces_are():
    """A cube worn evenly by 1.4 mm of 2: edge nodes have gone 1.4 and 1.7 times as far and have 0.6 mm left too."""
    mesh = with_thickness(with_built_shape(box((0.02, 0.02, 0.02), 4)), 2e-3)
    for _ in range(14):
        mesh, record = wear_update(mesh, 1e-4 * areas(mesh.points, mesh.triangles))
    assert mesh.point_data["removed_thickness_m"].max() > 1.9e-3
    assert record["through_nodes"] == 0
    assert remaining_thickness(mesh) == pytest.approx(0.6e-3, abs=0.05e-3)  # the cube shrinks by 7 % on the way


def test_a_sharp_edge_is_not_called_worn_through():
    """A slanted block, worn at its top: along the edge of 45 degrees there was no thickness, so none was worn away."""
    block = box((0.1, 0.08, 0.05), 5)
    slanted = SurfaceMesh(block.points + block.points[:, 2:] * [-1.0, 0.0, 0.0], block.triangles)
    mesh = with_thickness(with_built_shape(slanted))
    local, top = mesh.point_data["local_thickness_m"], slanted.points[:, 2] > 0.05 - 1e-9
    sharp = top & (slanted.points[:, 0] < -0.05 + 1e-9)
    assert sharp.any()
    assert (local[sharp] == 0.0).all()
    assert (local[top & ~sharp] > 1e-3).all()
    upper = unit_normals(mesh.points, mesh.triangles)[:, 2] > 0.9
    for _ in range(3):
        mesh, record = wear_update(mesh, upper * 1e-3 * areas(mesh.points, mesh.triangles), back="cap")
        assert record["through_nodes"] == 0
    assert through_phrase(mesh) is None
    assert mesh.points[sharp] == pytest.approx(slanted.points[sharp], abs=EXACT)


def test_a_thin_part_is_not_reached_through_from_behind():
    """Rays look along the inward normal: seen from its other side a plate over another one has its own back."""
    mesh = welded(plate(0.2, 0.2, 4), flipped(shifted(plate(0.2, 0.2, 4), (0.0, 0.0, -0.05))))
    assert with_thickness(mesh).point_data["local_thickness_m"] == pytest.approx(0.05, rel=RAY, abs=0.0)
