"""Directions of the nodes: into the body, and wear leaves the part it fell on."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.plate import closed_box, flat_plate, sphere
from bulkwear.meshes.sample import sliding_sample
from bulkwear.postproc.mesh import area_vectors, areas, enclosed_volume, shortest_edge_at_nodes, unit_normals
from bulkwear.postproc.wear.directions import (
    OUTWARD_TOLERANCE,
    LabelParting,
    SliceEnds,
    inward_directions,
    loaded_directions,
    rim_directions,
    slice_directions,
)
from bulkwear.postproc.wear.displacement import displace, swept_volume
from tests.support.shapes import drum_with_lifters

SEED = 20220317
ROUNDING = 1e-12  # relative: sums over a few thousand numbers
PARTED = 1e-9  # relative: volume of each label; directions converge to 1e-10
MISPLACED = 0.03  # -, of a bump's wear that mean normals take out of the base at its foot at least, 5 % at 1-2 mm
FEW_AT_THE_FOOT = 2e-3  # -, of the wear of the base that comes out of bumps, as no foot node may leave a facet
FEW_MISPLACED = 1e-4  # -, where a direction had to be turned into one loaded face at the cost of its label


def bumped_sample(element_size):
    """A 60 x 60 mm sample with three bumps and a skirt; m."""
    pattern = ConvexPattern(8e-3, 4e-3, 4e-3, 30e-3, 30e-3, "along_travel", 0.5)
    return sliding_sample(60e-3, 60e-3, element_size, pattern, 0.3e-3, np.radians(3.0))


def worn_by_part(mesh, volume, labels=True, mean_normals=False):
    """Volume (m3) that each part of a sample is to lose and what its faces sweep; base first."""
    part = mesh.cell_data["part"]
    worn = part >= 0
    directions = rim_directions(mesh.points, mesh.triangles, worn)
    if mean_normals:
        directions = inward_directions(mesh.points, mesh.triangles, worn, directions)
    limit = 0.1 * shortest_edge_at_nodes(mesh.points, mesh.triangles)
    label = part if labels else None
    result = displace(mesh.points, mesh.triangles, volume, None, limit, directions, worn, label)
    assert not (result.step == limit).any()
    swept = swept_volume(mesh.points, result.points - mesh.points, mesh.triangles)
    return tuple(np.bincount(part[worn], each[worn]) for each in (volume, swept))


@pytest.mark.parametrize("element_size", [4e-3, 2e-3, 1e-3])
@pytest.mark.parametrize("on_base", [0.0, 0.3])
def test_each_part_loses_its_own_volume(element_size, on_base):
    """Even wear of the bumps, with and without wear of the base: every part sweeps exactly its own volume."""
    mesh = bumped_sample(element_size)
    part = mesh.cell_data["part"]
    volume = 2e-5 * areas(mesh.points, mesh.triangles) * np.where(part > 0, 1.0, on_base)
    wanted, swept = worn_by_part(mesh, volume)
    np.testing.assert_allclose(swept, wanted, rtol=PARTED, atol=PARTED * wanted.sum())


def test_uneven_wear_hardly_leaves_its_part():
    """Random wear of base and bumps: parts keep their volume but for the few nodes turned into a face."""
    mesh = bumped_sample(2e-3)
    random = np.random.default_rng(SEED)
    volume = 2e-5 * areas(mesh.points, mesh.triangles) * random.random(len(mesh.triangles))
    wanted, swept = worn_by_part(mesh, volume * (mesh.cell_data["part"] >= 0))
    np.testing.assert_allclose(swept, wanted, rtol=0.0, atol=FEW_MISPLACED * wanted.sum())


@pytest.mark.parametrize("element_size", [2e-3, 1e-3])
def test_mean_normals_take_wear_of_bumps_out_of_the_base(element_size):
    """What the directions are for: with area-weighted normals some 5 % of a bump's wear comes out of the base."""
    mesh = bumped_sample(element_size)
    volume = 2e-5 * areas(mesh.points, mesh.triangles) * (mesh.cell_data["part"] > 0)
    wanted, mean_swept = worn_by_part(mesh, volume, mean_normals=True)
    _, loaded_swept = worn_by_part(mesh, volume, labels=False)
    assert mean_swept[0] > MISPLACED * wanted.sum()
    assert loaded_swept[0] < 0.4 * mean_swept[0]  # already weighting with the wear saves most


def test_edge_goes_with_the_face_that_wears():
    """Wear of a box's top alone: every node of the top goes straight down, the walls stay plane."""
    mesh = closed_box(0.04, 0.03, 0.02, 0.005)
    top = unit_normals(mesh.points, mesh.triangles)[:, 2] > 0.5
    area, depth = areas(mesh.points, mesh.triangles), 1e-4
    result = displace(mesh.points, mesh.triangles, depth * area * top)
    np.testing.assert_array_equal(result.points[:, :2], mesh.points[:, :2])
    lost = enclosed_volume(mesh.points, mesh.triangles) - enclosed_volume(result.points, mesh.triangles)
    assert lost == pytest.approx(depth * area[top].sum(), rel=PARTED)


def test_edge_of_two_worn_parts_follows_both():
    """Sides of a box that wear by depths of their own: their common edge moves by either depth."""
    mesh = closed_box(0.04, 0.03, 0.02, 0.005)
    normal = unit_normals(mesh.points, mesh.triangles)
    side = np.abs(normal).argmax(axis=1) * 2 + (normal.sum(axis=1) > 0.0)  # 0 ... 5
    depth = np.array([0.0, 1e-5, 0.0, 0.0, 0.0, 3e-5])  # m: the side at +x and the top
    volume = areas(mesh.points, mesh.triangles) * depth[side]
    result = displace(mesh.points, mesh.triangles, volume, label=side)
    motion = result.points - mesh.points
    high = [np.isclose(mesh.points[:, axis], mesh.points[:, axis].max()) for axis in (0, 1, 2)]
    low_y = np.isclose(mesh.points[:, 1], mesh.points[:, 1].min())
    edge = high[0] & high[2] & ~high[1] & ~low_y
    assert edge.sum() > 3
    np.testing.assert_allclose(motion[edge], np.tile((-1e-5, 0.0, -3e-5), (edge.sum(), 1)), rtol=0.02, atol=1e-9)


def test_corners_of_three_parts_are_left_to_the_load():
    """Two labels part at the edges of a box whose sides are labels; its eight corners have three of them."""
    mesh = closed_box(0.04, 0.03, 0.02, 0.005)
    normal = unit_normals(mesh.points, mesh.triangles)
    side = np.abs(normal).argmax(axis=1) * 2 + (normal.sum(axis=1) > 0.0)
    parting = LabelParting(mesh.points, mesh.triangles, np.ones((len(side), 3)), side)
    nodes, _ = parting(area_vectors(mesh.points, mesh.triangles[parting.near]))
    on_sides = sum(
        np.isclose(np.abs(mesh.points[:, k] - (0.0, 0.0, 0.01)[k]), (0.02, 0.015, 0.01)[k]) for k in range(3)
    )
    assert np.array_equal(np.sort(nodes), np.flatnonzero(on_sides == 2))


def test_carried_volume_goes_along_the_mean_normal():
    """At an edge between two labels, one of them worn, a large carried volume turns the node to the mean normal."""
    mesh = closed_box(0.02, 0.02, 0.02, 0.005)
    side = (unit_normals(mesh.points, mesh.triangles)[:, 2] > 0.5).astype(np.int64)
    volume = np.outer(side, np.ones(3)) * 1e-12
    directions = []
    for carried in (0.0, 1.0):
        parting = LabelParting(mesh.points, mesh.triangles, volume, side, np.full(len(mesh.points), carried))
        nodes, found = parting(area_vectors(mesh.points, mesh.triangles[parting.near]))
        directions.append(found)
    np.testing.assert_allclose(directions[0], np.tile((0.0, 0.0, -1.0), (len(nodes), 1)), atol=ROUNDING)
    mean = inward_directions(mesh.points, mesh.triangles)[nodes]
    np.testing.assert_allclose(directions[1], mean, atol=1e-9)  # the load is 1e-12 of what is carried


def test_ridge_slides_down_the_face_that_does_not_wear():
    """A ridge of 30 degrees, one side worn: its nodes go down in the plane of the other side, never out of it."""
    ends = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    feet = np.sin(np.radians(15.0)) * np.array([0.0, 1.0, 0.0]) - np.array([0.0, 0.0, np.cos(np.radians(15.0))])
    points = np.concatenate((ends, ends + feet, ends + feet * (1.0, -1.0, 1.0)))
    faces = np.array([[0, 2, 1], [2, 3, 1], [0, 1, 4], [1, 5, 4]])
    normal = unit_normals(points, faces)
    assert normal[0] @ normal[2] == pytest.approx(np.cos(np.radians(150.0)))
    direction = loaded_directions(points, faces, np.outer((1.0, 1.0, 0.0, 0.0), np.ones(3)))[:2]
    np.testing.assert_allclose(direction @ normal[2], 0.0, atol=0.02)  # the correction goes 1 % too far
    assert (direction @ normal[2] <= OUTWARD_TOLERANCE).all()
    assert (direction @ normal[0] < -0.4).all()


@pytest.mark.parametrize("element_size", [4e-3, 1e-3])
def test_wear_of_the_base_alone_grows_no_bump(element_size):
    """Nodes at the foot go down the flank, out of none of its faces; the bumps lose next to nothing."""
    mesh = bumped_sample(element_size)
    part = mesh.cell_data["part"]
    volume = 2e-5 * areas(mesh.points, mesh.triangles) * (part == 0)
    rim = rim_directions(mesh.points, mesh.triangles, part >= 0)
    result = displace(mesh.points, mesh.triangles, volume, directions=rim, worn=part >= 0, label=part)
    motion = (result.points - mesh.points)[mesh.triangles]
    outward = np.einsum("mcx,mx->mc", motion, unit_normals(mesh.points, mesh.triangles))
    assert outward[part >= 0].max() <= 2.0 * OUTWARD_TOLERANCE * result.step.max()
    swept = swept_volume(mesh.points, result.points - mesh.points, mesh.triangles)
    assert 0.0 <= swept[part > 0].sum() < FEW_AT_THE_FOOT * volume.sum()


def test_no_direction_without_load_or_between_faces_back_to_back():
    """Unloaded nodes and nodes of two opposite faces have none; the carried volume alone gives the mean normal."""
    mesh = flat_plate(0.01, 0.01, 1e-3)
    nothing = np.zeros((len(mesh.triangles), 3))
    assert not loaded_directions(mesh.points, mesh.triangles, nothing).any()
    carried = loaded_directions(mesh.points, mesh.triangles, nothing, carried_volume=np.ones(len(mesh.points)))
    np.testing.assert_allclose(carried, np.tile((0.0, 0.0, -1.0), (len(mesh.points), 1)), atol=ROUNDING)
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    faces = np.array([[0, 1, 2], [0, 2, 1]])
    assert not loaded_directions(points, faces, np.array([[1.0, 1.0, 1.0], [2.0, 2.0, 2.0]])).any()


@settings(max_examples=30, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), roughness=st.floats(0.0, 0.9), loaded=st.floats(0.05, 1.0))
def test_never_outward_of_any_face(seed, roughness, loaded):
    """On random crumpled bodies with random labels and loads no node leaves a face, loaded or not."""
    random = np.random.default_rng(seed)
    mesh = sphere(0.05, 2)
    points = mesh.points * (1.0 + roughness * (random.random((len(mesh.points), 1)) - 0.5))
    volume = random.random((len(mesh.triangles), 3)) * (random.random((len(mesh.triangles), 1)) < loaded)
    label = random.integers(0, 3, len(mesh.triangles))
    direction = loaded_directions(points, mesh.triangles, volume)
    parting = LabelParting(points, mesh.triangles, volume, label)
    nodes, parted = parting(area_vectors(points, mesh.triangles[parting.near]))
    assert len(np.unique(nodes)) == len(nodes)
    direction[nodes] = parted
    normal = unit_normals(points, mesh.triangles)
    outward = np.einsum("mcx,mx->mc", direction[mesh.triangles], normal)
    assert outward.max() <= 2.0 * OUTWARD_TOLERANCE
    length = np.linalg.norm(direction, axis=1)
    assert (np.isclose(length, 1.0, atol=ROUNDING) | (length == 0.0)).all()
    assert (length == 0.0).mean() < 1.0


def test_a_slice_stays_within_its_ends():
    """Rough wear of a drum with lifters, round after round: nodes on the ends keep their place along the axis bit for
    bit, no face grows, and the volume is the law's. Without the ends given they leave the slice.
    """
    drawn, _ = drum_with_lifters(0.5, 8, 0.04, 0.06, 0.1, 4)
    axis = 1
    along = drawn.points[:, axis]
    ends = SliceEnds(axis, along.min(), along.max())
    at_ends = (along == ends.low) | (along == ends.high)
    rng = np.random.default_rng(SEED)
    left = {}
    for held in (True, False):
        points = drawn.points
        for _ in range(4):
            volume = 2e-3 * areas(points, drawn.triangles) * rng.uniform(0.0, 2.0, len(drawn.triangles))
            given_way = slice_directions(points, drawn.triangles, ends) if held else None
            limit = 0.2 * shortest_edge_at_nodes(points, drawn.triangles)
            result = displace(points, drawn.triangles, volume, None, limit, given_way)
            motion = result.points - points
            if held:
                normals = unit_normals(points, drawn.triangles)
                outward = np.einsum("mij,mj->mi", motion[drawn.triangles], normals)
                assert outward.max() <= OUTWARD_TOLERANCE * np.abs(motion).max()
                kept = result.applied_volume.sum() + result.carried_volume.sum()
                assert kept == pytest.approx(volume.sum(), rel=ROUNDING)
                assert swept_volume(points, motion, drawn.triangles).sum() > 0.5 * volume.sum()
            points = result.points
        left[held] = np.abs(points[at_ends, axis] - along[at_ends]).max()
    assert left[True] == 0.0 and left[False] > 1e-4


def test_only_the_rim_on_an_end_is_held():
    """Inner nodes, and a rim off the ends, go their own way: NaN."""
    drawn, _ = drum_with_lifters(0.5, 8, 0.04, 0.06, 0.1, 4)
    axis = 1
    along = drawn.points[:, axis]
    found = slice_directions(drawn.points, drawn.triangles, SliceEnds(axis, along.min(), 1.0))
    assert (np.isfinite(found).all(axis=1) == (along == along.min())).all()
    assert (found[along == along.min(), axis] == 0.0).all()
