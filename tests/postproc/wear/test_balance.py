"""Volumes lost by surfaces of any shape and attitude, the growth check, and the balance of volumes."""

import numpy as np
import pytest
from hypothesis import given, seed, settings
from hypothesis import strategies as st

from bulkwear.postproc.mesh import SurfaceMesh, areas, boundary_nodes, enclosed_volume, nonmanifold_edges
from bulkwear.postproc.wear.balance import GrowthError, check_growth, lost_volume, volume_balance
from bulkwear.postproc.wear.built_shape import with_built_shape
from bulkwear.postproc.wear.caps import edge_limit
from bulkwear.postproc.wear.mesh_faults import Bounds, with_target_edges
from bulkwear.postproc.wear.remesh import remesh
from bulkwear.postproc.wear.update import wear_update, with_depths
from tests.support.shapes import box, cone, drum_with_lifters, flipped, moved_rigidly, plate, sheet, shifted, welded

SEED = 20220317
EXACT = 1e-11  # relative to the volume lost: differences of cones some hundred times larger
BALANCE = 1e-9  # relative: what is asked of an update
DEPTH = 1e-9  # relative: depths are differences of coordinates some 1e4 times larger
UPDATES = 5
ANGLES = st.tuples(*[st.floats(-np.pi, np.pi)] * 3)
SHIFTS = st.tuples(*[st.floats(-10.0, 10.0)] * 3)


def uniform(mesh, depth):
    """Worn volume (m,) m3 of an even depth (m)."""
    return depth * areas(mesh.points, mesh.triangles)


def uneven(mesh, depth, number):
    """Worn volume (m,) m3 that differs from face to face, `depth` (m) on average."""
    return uniform(mesh, depth) * 2.0 * np.random.default_rng(SEED + number).random(len(mesh.triangles))


def worn_unevenly(mesh, depth, updates=UPDATES, limit=0.1):
    """The mesh after some uneven updates, capped, and the volume (m3) of the law; the balance holds after each."""
    present, law = mesh, 0.0
    for number in range(updates):
        volume = uneven(present, depth, number)
        cap = edge_limit(present.points, present.triangles, limit)
        present, record = wear_update(present, volume, cap)
        law += record["worn_volume_m3"]
        lost, rounding = lost_volume(mesh, present)
        assert abs(lost + record["carried_volume_m3"] - law) <= BALANCE * law
        assert volume_balance(lost, record["carried_volume_m3"], law, rounding) <= BALANCE
    return present, law


def cylinder(inward):
    """A third of a cylinder of 0.2 m radius and 0.4 m length, open at all its edges."""
    mesh = sheet(
        np.linspace(0.0, 2.0, 25), np.linspace(0.0, 0.4, 13), lambda a, y: (0.2 * np.cos(a), y, 0.2 * np.sin(a))
    )
    return mesh if inward else flipped(mesh)


SHAPES = {
    "plate": lambda: plate(0.4, 0.3, 10),
    "inside of a cylinder": lambda: cylinder(True),
    "outside of a cylinder": lambda: cylinder(False),
    "body": lambda: box((0.3, 0.2, 0.1), 6),
    "cone": lambda: cone(0.1, 0.3, 0.4, 30, 8, inward=True),
    "drum": lambda: drum_with_lifters(0.5, 6, 0.05, 0.04, 0.3, 4)[0],
    "two plates": lambda: welded(plate(0.4, 0.3, 8), shifted(plate(0.4, 0.3, 8), (0.0, 0.0, 0.5)), labels=True),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("angles", [(0.0, 0.0, 0.0), (0.5 * np.pi, 0.0, 0.0), (0.7, -1.1, 2.3)])
def test_what_was_lost_is_what_the_law_took(shape, angles):
    """Five uneven updates of a shape, lying, upright and askew: lost plus carried is the law's volume in each."""
    mesh = moved_rigidly(SHAPES[shape](), angles, (1.3, -0.4, 2.2))
    worn, law = worn_unevenly(mesh, 1e-3)
    carried = worn.point_data["carried_volume_m3"].sum()
    assert lost_volume(mesh, worn)[0] + carried == pytest.approx(law, rel=BALANCE, abs=0.0)
    assert carried < 0.5 * law  # most of it is lost, not put off


@given(ANGLES, SHIFTS)
@settings(max_examples=10, deadline=None)
@seed(SEED)
def test_rigid_motion_changes_no_volume(angles, shift):
    """A plate with receding rims loses the same at every attitude and place, and its depth is the same."""
    mesh = plate(0.4, 0.3, 6)
    expected, record = wear_update(mesh, uneven(mesh, 1e-3, 1))
    turned = moved_rigidly(mesh, angles, shift)
    worn, found = wear_update(turned, uneven(mesh, 1e-3, 1))
    lost = lost_volume(turned, worn)[0]
    assert lost == pytest.approx(
        lost_volume(mesh, expected)[0], rel=1e-9, abs=0.0
    )  # coordinates up to 10 m, wear of 1 mm
    assert found["largest_depth_m"] == pytest.approx(record["largest_depth_m"], rel=1e-9, abs=0.0)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_units_do_not_matter(scale):
    """The same shape in other units loses that unit's volume."""
    mesh = cylinder(True)
    large = SurfaceMesh(scale * mesh.points, mesh.triangles)
    worn, big = (wear_update(each, uneven(each, 1e-3 * s, 1))[0] for each, s in ((mesh, 1.0), (large, scale)))
    assert lost_volume(large, big)[0] == pytest.approx(scale**3 * lost_volume(mesh, worn)[0], rel=EXACT, abs=0.0)


def test_a_closed_body_loses_what_it_encloses_less():
    """The swept volume of a box is the difference of the volumes it encloses."""
    mesh = box((0.3, 0.2, 0.1), 6)
    worn, law = worn_unevenly(mesh, 1e-3)
    difference = enclosed_volume(mesh.points, mesh.triangles) - enclosed_volume(worn.points, worn.triangles)
    assert lost_volume(mesh, worn)[0] == pytest.approx(difference, rel=EXACT, abs=0.0)
    assert difference == pytest.approx(law, rel=0.1, abs=0.0)  # the rest is carried


def test_a_plate_at_any_angle_loses_area_times_depth():
    """Even wear: A d, rim included; thickness, ray depth and depth along the pristine normal are d."""
    mesh = moved_rigidly(plate(0.4, 0.3, 10), (0.9, 0.2, -0.4), (0.0, 0.0, 5.0))
    worn, record = wear_update(mesh, uniform(mesh, 2e-3))
    assert lost_volume(mesh, worn)[0] == pytest.approx(0.12 * 2e-3, rel=EXACT, abs=0.0)
    assert record["largest_depth_m"] == pytest.approx(2e-3, rel=DEPTH, abs=0.0)
    assert record["rim_recession_m"] == pytest.approx(2e-3, rel=DEPTH, abs=0.0)
    fields = with_depths(worn, mesh).point_data
    for name in ("removed_thickness_m", "normal_depth_m"):
        assert fields[name] == pytest.approx(2e-3, rel=DEPTH, abs=0.0)
    ray = fields["ray_depth_m"]
    assert ray[np.isfinite(ray)] == pytest.approx(2e-3, rel=DEPTH, abs=0.0)
    assert np.isfinite(ray).sum() > 0.5 * len(ray)  # at rims it may pass beside the pristine plate
    assert "height_loss_m" not in fields  # its plan has moved
    assert np.array_equal(np.flatnonzero(fields["free_rim"]), boundary_nodes(mesh.triangles))


def test_without_panels_a_corner_is_taken_for_a_pit():
    """Then a cavity's floor hands the wear of its edges on: 1.5 times the depth somewhere, the volume is the same."""
    mesh = box((0.3, 0.2, 0.1), 6, inward=True)
    side = np.isclose(mesh.points[mesh.triangles][:, :, 2].max(axis=1), 0.0)
    worn, _ = wear_update(mesh, side * uniform(mesh, 2e-3))
    assert lost_volume(mesh, worn)[0] == pytest.approx(0.06 * 2e-3, rel=EXACT, abs=0.0)
    assert worn.points[:, 2].min() < -1.5 * 2e-3


def test_one_inner_side_of_a_box_recedes_as_a_whole():
    """A cavity of which one side wears evenly by d grows by A d; the other sides stay in their planes."""
    mesh = with_built_shape(box((0.3, 0.2, 0.1), 6, inward=True))
    side = np.isclose(mesh.points[mesh.triangles][:, :, 2].max(axis=1), 0.0)
    worn, _ = wear_update(mesh, side * uniform(mesh, 2e-3))
    assert lost_volume(mesh, worn)[0] == pytest.approx(0.06 * 2e-3, rel=EXACT, abs=0.0)
    assert worn.points[:, 2].min() == pytest.approx(-2e-3, rel=DEPTH, abs=0.0)
    assert worn.points[:, :2] == pytest.approx(mesh.points[:, :2], abs=1e-15)


@pytest.mark.parametrize(("around", "tolerance"), [(30, 8e-3), (120, 7e-4)])
def test_a_cone_worn_evenly(around, tolerance):
    """A hopper's cone inside, worn by d: lateral area times d, plus d^2/2 times the difference of the girths it gains.

    V = d pi (r1 + r2) s + O(d^2), s the slant height. Polygons of n sides are shorter than circles by pi^2 / (6 n^2),
    and their corners go 1 / cos(pi / n) times as far as their sides; the second order is d / (r1 + r2) of V, 2e-4.
    """
    radius, height, slope, depth = 0.1, 0.3, 0.4, 1e-4
    mesh = with_built_shape(cone(radius, height, slope, around, 8, inward=True))
    worn, _ = wear_update(mesh, uniform(mesh, depth))
    slant, upper = height / np.cos(slope), radius + height * np.tan(slope)
    assert lost_volume(mesh, worn)[0] == pytest.approx(np.pi * (radius + upper) * slant * depth, rel=tolerance, abs=0.0)
    assert worn.point_data["removed_thickness_m"] == pytest.approx(depth, rel=tolerance, abs=0.0)


def test_lifters_of_a_drum_lose_their_height():
    """Even wear of the tops of all bars by d: number times width times length times d; the shell stays."""
    drum, top = drum_with_lifters(0.5, 6, 0.05, 0.04, 0.3, 4)
    mesh = with_built_shape(drum)
    worn, record = wear_update(mesh, top * uniform(mesh, 2e-3))
    assert lost_volume(mesh, worn)[0] == pytest.approx(6 * 0.04 * 0.3 * 2e-3, rel=EXACT, abs=0.0)
    moved = (worn.points != mesh.points).any(axis=1)
    on_top = np.zeros(len(mesh.points), dtype=bool)
    on_top[mesh.triangles[top]] = True
    assert np.array_equal(moved, on_top)
    assert record["largest_depth_m"] == pytest.approx(2e-3, rel=DEPTH, abs=0.0)


def test_remeshing_keeps_what_was_lost():
    """A bowl worn and remeshed until its triangles are others: the balance stays, the rim receding all along."""
    mesh = with_target_edges(
        sheet(
            np.linspace(-0.1, 0.1, 21), np.linspace(-0.1, 0.1, 21), lambda x, y: (x, y, 2.0 * (x**2 + y**2) + 0.3 * x)
        )
    )
    present, law, changed = mesh, 0.0, 0
    for number in range(8):
        volume = uneven(present, 4e-3, number)
        present, record = wear_update(present, volume, edge_limit(present.points, present.triangles, 0.3))
        law += record["worn_volume_m3"]
        outcome = remesh(present, Bounds(smallest_angle_deg=30.0))
        present, changed = outcome.mesh, changed + outcome.faces_changed
        lost, rounding = lost_volume(mesh, present)
        assert volume_balance(lost, present.point_data["carried_volume_m3"].sum(), law, rounding) <= BALANCE
    assert changed > 50
    assert not len(nonmanifold_edges(present.triangles))


def test_a_face_that_leaves_the_body_is_told():
    """Motion along the normals of touched faces is growth, named with its place; of untouched ones it is none."""
    mesh = plate(0.4, 0.4, 4)
    out = np.zeros_like(mesh.points)
    out[12] = (0.0, 0.0, 1e-3)
    touched = np.ones(len(mesh.triangles), dtype=bool)
    with pytest.raises(GrowthError, match=r"touched faces would leave the body, most at \("):
        check_growth(mesh.points, out, mesh.triangles, touched)
    check_growth(mesh.points, -out, mesh.triangles, touched)
    check_growth(mesh.points, out, mesh.triangles, ~touched)
