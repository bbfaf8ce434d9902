"""Conserving displacement: the wear ladder from zero load to random ledgers."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.plate import closed_box, flat_plate, sphere
from bulkwear.meshes.sample import sample_top, sliding_sample
from bulkwear.postproc.mesh import (
    area_vectors,
    areas,
    boundary_edges,
    enclosed_volume,
    nonmanifold_edges,
    shortest_edge_at_nodes,
    unit_normals,
    volume_above_plane,
)
from bulkwear.postproc.wear.directions import inward_directions, rim_directions
from bulkwear.postproc.wear.displacement import StepTooLargeError, displace, mean_area_vectors, swept_volume

SEED = 20220317
ROUNDING = 1e-12  # relative: the solver's own convergence, and sums over a few thousand numbers
GEOMETRY = 1e-9  # relative: volumes of bodies are differences of numbers some 1e4 times larger
SECOND_ORDER = 3.0  # -, halving the step must at least divide a second-order remainder by this (4 in the limit)

TRIANGLE = np.array([[0, 1, 2]])


def bumped_sample(element_size=2e-3):
    """A 60 x 60 mm sample with three bumps and a skirt; m."""
    pattern = ConvexPattern(8e-3, 4e-3, 4e-3, 30e-3, 30e-3, "along_travel", 0.5)
    return sliding_sample(60e-3, 60e-3, element_size, pattern, 0.3e-3, np.radians(3.0))


def box_with_holder():
    """A closed box whose top wears and whose walls and bottom are the holder: mesh, worn mask."""
    mesh = closed_box(0.04, 0.03, 0.02, 0.005)
    return mesh, unit_normals(mesh.points, mesh.triangles)[:, 2] > 0.5


def random_volumes(mesh, step, seed=SEED):
    """Random worn volumes (m,) m3 with a mean depth of about `step` m; a third of the faces is untouched."""
    random = np.random.default_rng(seed)
    size = len(mesh.triangles)
    return areas(mesh.points, mesh.triangles) * step * random.random(size) * (random.random(size) > 1 / 3)


def test_zero_load_leaves_every_bit():
    """No load, nothing carried: coordinates bit-identical (negative zeros too), no step, no volume."""
    mesh = bumped_sample()
    mesh.points[0, 0] = -0.0
    result = displace(mesh.points, mesh.triangles, np.zeros(len(mesh.triangles)))
    assert result.points.tobytes() == mesh.points.tobytes()
    assert not result.step.any() and not result.applied_volume.any() and not result.carried_volume.any()


def test_untouched_nodes_keep_every_bit():
    """Only corners of loaded faces move; all other nodes are bit-identical."""
    mesh = sphere(0.1, 3)
    volume = np.zeros(len(mesh.triangles))
    volume[[5, 77]] = 1e-9
    result = displace(mesh.points, mesh.triangles, volume)
    loaded = np.unique(mesh.triangles[[5, 77]])
    others = np.setdiff1d(np.arange(len(mesh.points)), loaded)
    assert (result.step[loaded] > 0.0).all()
    assert result.points[others].tobytes() == mesh.points[others].tobytes()


def test_uniformly_loaded_plate_recedes_exactly():
    """Volume in proportion to area on a plate: every node, corners too, goes down by V / A."""
    mesh = flat_plate(0.06, 0.04, 0.003)
    depth = 2.5e-5
    result = displace(mesh.points, mesh.triangles, depth * areas(mesh.points, mesh.triangles))
    np.testing.assert_allclose(result.step, depth, rtol=ROUNDING)
    np.testing.assert_allclose(result.points[:, 2], -depth, rtol=ROUNDING)
    assert np.array_equal(result.points[:, :2], mesh.points[:, :2])


def test_rim_slides_down_the_holder_without_a_slit():
    """The rim moves straight down the holder's wall, whose faces follow: the closed body loses exactly V."""
    mesh, worn = box_with_holder()
    depth = 1e-4
    area = areas(mesh.points, mesh.triangles)
    rim = rim_directions(mesh.points, mesh.triangles, worn)
    result = displace(mesh.points, mesh.triangles, depth * area, directions=rim, worn=worn)
    top = np.unique(mesh.triangles[worn])
    np.testing.assert_allclose(result.step[top], depth, rtol=ROUNDING)
    below = np.setdiff1d(np.arange(len(mesh.points)), top)
    assert result.points[below].tobytes() == mesh.points[below].tobytes()
    lost = enclosed_volume(mesh.points, mesh.triangles) - enclosed_volume(result.points, mesh.triangles)
    assert lost == pytest.approx(depth * area[worn].sum(), rel=GEOMETRY)
    assert len(boundary_edges(mesh.triangles)) == 0


def test_wear_of_the_holder_is_ignored():
    """Volumes on faces that do not wear move nothing."""
    mesh, worn = box_with_holder()
    result = displace(mesh.points, mesh.triangles, np.where(worn, 0.0, 1e-9), worn=worn)
    assert result.points.tobytes() == mesh.points.tobytes()
    assert result.carried_volume.sum() == 0.0


def test_rim_is_where_wear_ends():
    """Rim nodes are those on the holder or on an open boundary, no others."""
    mesh, worn = box_with_holder()
    on_edge = np.isclose(np.abs(mesh.points[:, 0]), 0.02) | np.isclose(np.abs(mesh.points[:, 1]), 0.015)
    expected = on_edge & np.isclose(mesh.points[:, 2], 0.02)
    found = np.isfinite(rim_directions(mesh.points, mesh.triangles, worn)).all(axis=1)
    assert np.array_equal(found, expected)
    open_found = np.isfinite(rim_directions(mesh.points, mesh.triangles[worn])).all(axis=1)
    assert np.array_equal(open_found, expected)


def test_mean_area_vector_is_simpsons():
    """The closed form equals (A(0) + 4 A(1/2) + A(1)) / 6 for any straight motion."""
    random = np.random.default_rng(SEED)
    points, motion = random.random((30, 3)), random.random((30, 3)) - 0.5
    triangles = np.arange(30).reshape(10, 3)
    at = [area_vectors(points + t * motion, triangles) for t in (0.0, 0.5, 1.0)]
    expected = (at[0] + 4.0 * at[1] + at[2]) / 6.0
    np.testing.assert_allclose(mean_area_vectors(points, motion, triangles), expected, rtol=1e-9, atol=1e-13)


def test_swept_volume_of_a_prism_and_of_a_tetrahedron():
    """Down by h: area times h. One corner alone: a third of that."""
    points = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0]])
    down = np.tile([0.0, 0.0, -0.5], (3, 1))
    assert swept_volume(points, down, TRIANGLE)[0] == pytest.approx(1.5, rel=ROUNDING)
    down[1:] = 0.0
    assert swept_volume(points, down, TRIANGLE)[0] == pytest.approx(0.5, rel=ROUNDING)


def test_swept_volume_is_the_loss_of_a_closed_body():
    """For large random motions of all nodes the faces sweep exactly the loss of enclosed volume."""
    mesh = sphere(1.0, 2)
    motion = 0.2 * (np.random.default_rng(SEED).random(mesh.points.shape) - 0.5)
    before, after = (enclosed_volume(p, mesh.triangles) for p in (mesh.points, mesh.points + motion))
    assert swept_volume(mesh.points, motion, mesh.triangles).sum() == pytest.approx(before - after, rel=GEOMETRY)


@pytest.mark.parametrize("step_over_edge", [1e-6, 1e-2, 0.1])
@pytest.mark.parametrize("body", ["sphere", "plate", "sample"])
def test_removed_volume_is_the_worn_volume(body, step_over_edge):
    """Swept volume of the worn faces = sum of the worn volumes, whatever the shape and the step."""
    mesh = {"sphere": sphere(0.05, 3), "plate": flat_plate(0.06, 0.04, 0.003), "sample": bumped_sample()}[body]
    worn = mesh.cell_data["part"] >= 0
    edge = shortest_edge_at_nodes(mesh.points, mesh.triangles).min()
    volume = random_volumes(mesh, step_over_edge * edge)
    rim = rim_directions(mesh.points, mesh.triangles, worn)
    result = displace(mesh.points, mesh.triangles, volume, directions=rim, worn=worn)
    swept = swept_volume(mesh.points, result.points - mesh.points, mesh.triangles)[worn].sum()
    assert swept == pytest.approx(volume[worn].sum(), rel=GEOMETRY)
    assert result.applied_volume.sum() == pytest.approx(swept, rel=ROUNDING)


def test_sphere_loses_exactly_the_worn_volume():
    """The body itself is the witness: enclosed volume before minus after = worn volume."""
    mesh = sphere(0.05, 3)
    volume = random_volumes(mesh, 5e-4)
    result = displace(mesh.points, mesh.triangles, volume)
    lost = enclosed_volume(mesh.points, mesh.triangles) - enclosed_volume(result.points, mesh.triangles)
    assert lost == pytest.approx(volume.sum(), rel=GEOMETRY)


@pytest.mark.parametrize("subdivisions", [2, 3, 4])
def test_uniform_wear_of_a_sphere_shrinks_its_radius(subdivisions):
    """Wear V spread evenly over a sphere takes V / (4 pi r^2) off its radius, to first order."""
    radius, depth = 0.05, 5e-5
    mesh = sphere(radius, subdivisions)
    volume = depth * areas(mesh.points, mesh.triangles)
    result = displace(mesh.points, mesh.triangles, volume)
    shrunk = radius - np.linalg.norm(result.points, axis=1)
    # facets: normals of an inscribed sphere err by h^2, h/r = 1.1 / 2^s on an icosahedron; curvature by dr/r
    error = (1.1 / 2**subdivisions) ** 2 + depth / radius
    np.testing.assert_allclose(shrunk, depth, rtol=error)
    assert result.applied_volume.sum() == pytest.approx(volume.sum(), rel=GEOMETRY)


def test_uniform_wear_of_a_sphere_cap_keeps_its_shape():
    """An open cap worn evenly stays a cap of the same centre, its radius less by V / A, at its rim too."""
    radius, depth, subdivisions = 0.05, 1e-4, 4
    mesh = sphere(radius, subdivisions)
    worn = mesh.points[mesh.triangles].mean(axis=1)[:, 2] > 0.4 * radius
    volume = depth * areas(mesh.points, mesh.triangles)
    result = displace(mesh.points, mesh.triangles, volume, worn=worn)
    nodes = np.unique(mesh.triangles[worn])
    shrunk = radius - np.linalg.norm(result.points[nodes], axis=1)
    np.testing.assert_allclose(shrunk, depth, rtol=(1.1 / 2**subdivisions) ** 2 + depth / radius)
    swept = swept_volume(mesh.points, result.points - mesh.points, mesh.triangles)[worn].sum()
    assert swept == pytest.approx(volume[worn].sum(), rel=GEOMETRY)


@pytest.mark.parametrize("subdivisions", [3, 4])
def test_uniform_wear_of_an_ellipsoid_keeps_its_shape(subdivisions):
    """Even wear moves every point of an ellipsoid by V / A along the ellipsoid's own normal, and takes exactly V."""
    axes, depth = np.array([0.05, 0.03, 0.025]), 1e-4
    ball = sphere(1.0, subdivisions)
    points, triangles = ball.points * axes, ball.triangles
    volume = depth * areas(points, triangles)
    result = displace(points, triangles, volume)
    normal = ball.points / axes
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    motion = result.points - points
    inward = -np.einsum("ij,ij->i", motion, normal)
    error = 1.5 * (1.1 / 2**subdivisions) ** 2 + depth * axes.max() / axes.min() ** 2  # facets; largest curvature
    np.testing.assert_allclose(inward, depth, rtol=error)
    assert np.linalg.norm(motion + inward[:, None] * normal, axis=1).max() < 2.0 * error * depth
    lost = enclosed_volume(points, triangles) - enclosed_volume(result.points, triangles)
    assert lost == pytest.approx(volume.sum(), rel=GEOMETRY)


@pytest.mark.parametrize("plate", [flat_plate, lambda *size: sample_top(*size, None)], ids=["regular", "irregular"])
@pytest.mark.parametrize("at_corners", [False, True])
def test_a_depth_field_on_a_plane_is_recovered_to_second_order(plate, at_corners):
    """Volumes of a smooth depth field give that depth at the nodes; halving the edge quarters the error."""

    def depth(at):
        return 5e-5 * np.exp(-((at[..., 0] / 5e-3) ** 2)) * (1.0 + 0.5 * np.cos(at[..., 1] / 4e-3))

    def largest_error(edge):
        mesh = plate(0.04, 0.03, edge)
        weights = (np.ones((3, 3)) + 3.0 * np.eye(3)) / 6.0  # quadrature exact for quadratics
        volume = depth(weights @ mesh.points[mesh.triangles]) * areas(mesh.points, mesh.triangles)[:, None] / 3.0
        volume = volume @ weights if at_corners else volume.sum(axis=1)
        rim = rim_directions(mesh.points, mesh.triangles)
        result = displace(mesh.points, mesh.triangles, volume, directions=rim)
        inside = (np.abs(mesh.points[:, :2]) < (0.018, 0.013)).all(axis=1)  # rim nodes average over one side only
        return np.abs(-result.points[:, 2] - depth(mesh.points))[inside].max()

    errors = [largest_error(edge) for edge in (2e-3, 1e-3, 0.5e-3)]
    assert errors[0] > SECOND_ORDER * errors[1] > SECOND_ORDER**2 * errors[2]


def test_volumes_at_corners_are_those_of_their_faces():
    """A third at each corner is the same as the volume per face; all at one corner moves that node alone."""
    mesh = sphere(0.05, 3)
    volume = random_volumes(mesh, 2e-4)
    whole = displace(mesh.points, mesh.triangles, volume)
    thirds = displace(mesh.points, mesh.triangles, np.tile(volume[:, None] / 3.0, 3))
    np.testing.assert_array_equal(thirds.points, whole.points)
    corner = np.zeros((len(volume), 3))
    corner[7, 1] = 1e-9
    alone = displace(mesh.points, mesh.triangles, corner)
    assert np.flatnonzero(alone.step).tolist() == [mesh.triangles[7, 1]]
    assert alone.applied_volume.sum() == pytest.approx(1e-9, rel=GEOMETRY)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 2**32 - 1),
    step_over_edge=st.floats(1e-6, 1.0),
    limit_over_edge=st.floats(1e-3, 0.5),
    loaded=st.floats(0.01, 1.0),
    carried=st.floats(0.0, 1.0),
)
def test_any_corner_volumes_labels_and_caps(seed, step_over_edge, limit_over_edge, loaded, carried):
    """Random volumes at corners, labels and carry: conserved, within the cap, no face turned, faces in any order."""
    mesh, random = sphere(0.05, 2), np.random.default_rng(seed)
    points = mesh.points * (1.0 + 0.1 * random.random((len(mesh.points), 1)))
    edge = shortest_edge_at_nodes(points, mesh.triangles)
    limit = limit_over_edge * edge * random.random(len(edge))
    volume = (
        step_over_edge * edge.min() * areas(points, mesh.triangles)[:, None] * random.random((len(mesh.triangles), 3))
    )
    volume *= random.random((len(volume), 1)) < loaded
    owed = carried * volume.mean() * random.random(len(points))
    label = random.integers(0, 3, len(mesh.triangles))
    result = displace(points, mesh.triangles, volume, owed, limit, label=label)
    total = volume.sum() + owed.sum()
    lost = enclosed_volume(points, mesh.triangles) - enclosed_volume(result.points, mesh.triangles)
    rounding = 1e-13 * enclosed_volume(points, mesh.triangles)
    assert abs(lost + result.carried_volume.sum() - total) <= ROUNDING * total + rounding
    assert (result.step >= 0.0).all() and (result.step <= limit).all()
    outward = np.einsum("mcx,mx->mc", (result.points - points)[mesh.triangles], unit_normals(points, mesh.triangles))
    assert outward[volume > 0.0].max(initial=0.0) <= 1e-8 * edge.max()
    before, after = (area_vectors(p, mesh.triangles) for p in (points, result.points))
    assert (np.einsum("ij,ij->i", before, after) > 0.0).all()
    order = random.permutation(len(mesh.triangles))
    mixed = displace(points, mesh.triangles[order], volume[order], owed, limit, label=label[order])
    np.testing.assert_allclose(mixed.points, result.points, rtol=0.0, atol=1e-6 * edge.min())


@pytest.mark.parametrize("element_size", [2e-3, 1e-3, 0.5e-3])
def test_groove_volume_does_not_depend_on_the_mesh(element_size):
    """A smooth groove removes its volume at every mesh size; its shape converges to the wear profile."""
    mesh = flat_plate(0.04, 0.03, element_size)
    centre = mesh.points[mesh.triangles].mean(axis=1)
    depth = 5e-5 * np.exp(-((centre[:, 0] / 5e-3) ** 2))
    volume = depth * areas(mesh.points, mesh.triangles)
    result = displace(mesh.points, mesh.triangles, volume, directions=rim_directions(mesh.points, mesh.triangles))
    assert -volume_above_plane(result.points, mesh.triangles) == pytest.approx(volume.sum(), rel=GEOMETRY)
    profile = 5e-5 * np.exp(-((mesh.points[:, 0] / 5e-3) ** 2))
    inside = np.abs(mesh.points[:, 0]) < 0.019  # rim nodes average over one side only
    smoothing = 0.5 * (element_size / 5e-3) ** 2  # node averages over its ring: h^2/4 times the curvature 2/w^2
    np.testing.assert_allclose(-result.points[inside, 2], profile[inside], atol=smoothing * 5e-5)


def test_wear_is_linear_in_the_load_to_first_order():
    """Half the load, half the step; the remainder is of second order (the surface curves)."""
    mesh = sphere(0.05, 3)
    volume = random_volumes(mesh, 2e-4)
    steps = [displace(mesh.points, mesh.triangles, volume * share).step for share in (1.0, 0.5, 0.25)]
    first, second = (np.abs(steps[k] - 2.0 * steps[k + 1]).max() for k in (0, 1))
    assert first > SECOND_ORDER * second > 0.0


def test_many_small_steps_equal_one_large_step_to_first_order():
    """Ten tenths of the wear or all at once: same volume, same shape but for a remainder of second order."""
    mesh = sphere(0.05, 3)

    def gap(scale):
        volume = scale * random_volumes(mesh, 2e-4)
        points = mesh.points
        for _ in range(10):
            points = displace(points, mesh.triangles, volume / 10.0).points
        once = displace(mesh.points, mesh.triangles, volume).points
        lost = enclosed_volume(mesh.points, mesh.triangles) - enclosed_volume(points, mesh.triangles)
        assert lost == pytest.approx(volume.sum(), rel=GEOMETRY)
        return np.abs(points - once).max()

    assert gap(1.0) > SECOND_ORDER * gap(0.5) > 0.0


def test_rotation_and_translation_do_not_matter():
    """The worn surface of a moved body is the moved worn surface."""
    mesh = sphere(0.05, 3)
    volume = random_volumes(mesh, 5e-4)
    rotation, shift = Rotation.from_rotvec([0.3, -0.7, 1.1]).as_matrix(), np.array([0.02, -0.03, 0.05])
    here = displace(mesh.points, mesh.triangles, volume)
    there = displace(mesh.points @ rotation.T + shift, mesh.triangles, volume)
    np.testing.assert_allclose(there.points, here.points @ rotation.T + shift, atol=1e-15)  # m: coordinates' rounding
    np.testing.assert_allclose(there.step, here.step, rtol=0.0, atol=1e-15)


def test_units_do_not_matter():
    """The same body in mm and mm3 gives the same steps times 1000."""
    mesh = sphere(0.05, 3)
    volume = random_volumes(mesh, 5e-4)
    limit = np.full(len(mesh.points), 1.5e-4)
    metres = displace(mesh.points, mesh.triangles, volume, step_limit=limit)
    millimetres = displace(1e3 * mesh.points, mesh.triangles, 1e9 * volume, step_limit=1e3 * limit)
    np.testing.assert_allclose(millimetres.step, 1e3 * metres.step, rtol=ROUNDING)
    np.testing.assert_allclose(
        millimetres.carried_volume, 1e9 * metres.carried_volume, atol=1e9 * volume.sum() * ROUNDING
    )


def test_order_of_faces_and_nodes_does_not_matter():
    """Renumbering faces, nodes and the first corner of each face permutes the result, no more."""
    mesh = sphere(0.05, 3)
    volume = random_volumes(mesh, 5e-4)
    random = np.random.default_rng(SEED)
    faces, nodes = random.permutation(len(mesh.triangles)), random.permutation(len(mesh.points))
    place = np.argsort(nodes)
    triangles = np.roll(place[mesh.triangles[faces]], 1, axis=1)
    here = displace(mesh.points, mesh.triangles, volume)
    there = displace(mesh.points[nodes], triangles, volume[faces])
    np.testing.assert_allclose(there.step, here.step[nodes], rtol=ROUNDING)


def test_capped_nodes_stop_and_carry():
    """No step above its limit; applied + carried = wear; only nodes at the limit carry more than rounding."""
    mesh = sphere(0.05, 3)
    volume = random_volumes(mesh, 5e-4)
    limit = np.full(len(mesh.points), 1.5e-4)
    result = displace(mesh.points, mesh.triangles, volume, step_limit=limit)
    capped = result.step == limit
    assert 0 < capped.sum() < len(capped) and (result.step <= limit).all()
    total = volume.sum()
    assert result.applied_volume.sum() + result.carried_volume.sum() == pytest.approx(total, rel=ROUNDING)
    assert np.abs(result.carried_volume[~capped]).sum() < 2.0 * ROUNDING * total
    assert (result.carried_volume[capped] > -ROUNDING * total).all() and result.carried_volume.sum() > 0.01 * total


def test_zero_load_releases_what_was_carried():
    """Cycles without load work the carried volume off; the body has then lost exactly the wear."""
    mesh = sphere(0.05, 3)
    volume = random_volumes(mesh, 5e-4)
    limit = np.full(len(mesh.points), 1.5e-4)
    points, carried = mesh.points, None
    for cycle in range(5):
        load = volume if cycle == 0 else np.zeros_like(volume)
        result = displace(points, mesh.triangles, load, carried, limit)
        assert carried is None or result.carried_volume.sum() <= carried.sum() + ROUNDING * volume.sum()
        points, carried = result.points, result.carried_volume
    assert np.abs(carried).sum() < GEOMETRY * volume.sum()
    lost = enclosed_volume(mesh.points, mesh.triangles) - enclosed_volume(points, mesh.triangles)
    assert lost == pytest.approx(volume.sum(), rel=GEOMETRY)


def test_a_limit_of_zero_carries_everything():
    """A node that may not move keeps its coordinates bit for bit and its whole volume."""
    mesh = sphere(0.05, 2)
    volume = random_volumes(mesh, 5e-4)
    result = displace(mesh.points, mesh.triangles, volume, step_limit=np.zeros(len(mesh.points)))
    assert result.points.tobytes() == mesh.points.tobytes()
    assert result.carried_volume.sum() == pytest.approx(volume.sum(), rel=ROUNDING)


def test_tangential_direction_carries_everything():
    """A direction along the faces removes nothing however far one goes: the node stays and carries."""
    mesh = flat_plate(0.03, 0.03, 0.003)
    directions = np.full(mesh.points.shape, np.nan)
    directions[40] = (1.0, 0.0, -0.01)
    volume = 1e-6 * areas(mesh.points, mesh.triangles)
    result = displace(mesh.points, mesh.triangles, volume, directions=directions)
    assert result.step[40] == 0.0 and result.carried_volume[40] > 0.0
    assert (np.delete(result.step, 40) > 0.0).all()


def test_folded_node_carries_everything():
    """Two faces back to back have no inward direction: nothing moves, everything is carried."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    triangles = np.array([[0, 1, 2], [0, 2, 1]])
    result = displace(points, triangles, np.array([1e-3, 1e-3]))
    assert result.points.tobytes() == points.tobytes()
    assert result.carried_volume.sum() == pytest.approx(2e-3, rel=ROUNDING)


def test_bump_wear_stays_on_the_bump():
    """Wear of bumps alone moves bump nodes only; the base gives volume only through shared foot nodes."""
    mesh = bumped_sample()
    part = mesh.cell_data["part"]
    volume = np.where(part > 0, random_volumes(mesh, 1e-4), 0.0)
    result = displace(mesh.points, mesh.triangles, volume, worn=part >= 0)
    on_bump = np.zeros(len(mesh.points), dtype=bool)
    on_bump[mesh.triangles[part > 0]] = True
    assert result.points[~on_bump].tobytes() == mesh.points[~on_bump].tobytes()
    swept = swept_volume(mesh.points, result.points - mesh.points, mesh.triangles)
    away_from_bumps = (part == 0) & ~on_bump[mesh.triangles].any(axis=1)
    assert not swept[away_from_bumps].any()
    assert swept[part >= 0].sum() == pytest.approx(volume.sum(), rel=GEOMETRY)
    for bump in range(1, part.max() + 1):  # no wear wanders from bump to bump
        nodes = np.unique(mesh.triangles[part == bump])
        assert result.applied_volume[nodes].sum() == pytest.approx(volume[part == bump].sum(), rel=GEOMETRY)


def test_too_large_a_step_is_refused():
    """Without limits a step above half the shortest altitude is refused, naming node and ratio."""
    mesh = flat_plate(0.03, 0.03, 0.003)
    volume = 0.01 * areas(mesh.points, mesh.triangles)
    with pytest.raises(StepTooLargeError, match=r"node \d+ would step 0.01 m, 4.71 of the shortest altitude"):
        displace(mesh.points, mesh.triangles, volume)


def test_faces_about_to_turn_over_are_held():
    """With limits of the body's own radius no face turns over; what is not removed is carried."""
    mesh = sphere(0.05, 2)
    volume = random_volumes(mesh, 0.05)
    limit = np.full(len(mesh.points), 0.05)
    result = displace(mesh.points, mesh.triangles, volume, step_limit=limit)
    before, after = (area_vectors(p, mesh.triangles) for p in (mesh.points, result.points))
    assert (np.einsum("ij,ij->i", before, after) > 0.0).all()
    assert result.applied_volume.sum() + result.carried_volume.sum() == pytest.approx(volume.sum(), rel=ROUNDING)
    assert result.carried_volume.sum() > 0.0


def test_no_balance_is_told():
    """More wear than body and hardly a limit: refused, naming the largest step over the edge."""
    mesh = sphere(0.05, 1)
    with pytest.raises(StepTooLargeError, match=r"largest step is \d.* of the shortest edge"):
        displace(mesh.points, mesh.triangles, random_volumes(mesh, 0.05), step_limit=np.full(len(mesh.points), 0.5))


def test_a_negative_carry_is_worked_off_before_the_node_moves():
    """What rounding removed too much is owed: a node whose target is negative stays."""
    mesh = sphere(0.05, 2)
    volume = random_volumes(mesh, 1e-5)
    owed = np.full(len(mesh.points), -volume.mean())
    result = displace(mesh.points, mesh.triangles, volume, owed)
    stays = result.applied_volume == 0.0
    assert stays.any() and not stays.all()
    assert result.points[stays].tobytes() == mesh.points[stays].tobytes()
    assert (result.carried_volume[stays] < 0.0).all() and (result.step >= 0.0).all()
    total = result.applied_volume.sum() + result.carried_volume.sum()
    assert total == pytest.approx(volume.sum() + owed.sum(), abs=ROUNDING * volume.sum())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"worn_volume": np.ones(3)}, r"worn_volume has shape \(3,\)"),
        ({"worn_volume": np.full(200, -1e-12)}, "worn_volume holds -1e-12"),
        ({"worn_volume": np.full(200, np.nan)}, "worn_volume holds nan"),
        ({"carried_volume": np.full(121, np.nan)}, "carried_volume holds"),
        ({"carried_volume": np.zeros(5)}, r"carried_volume has shape \(5,\)"),
        ({"step_limit": np.full(121, -1.0)}, "step_limit holds -1"),
        ({"step_limit": np.full(121, np.nan)}, "step_limit holds nan"),
    ],
)
def test_impossible_input_is_refused(arguments, message):
    """Wrong shapes, negative wear and NaN are refused by name."""
    mesh = flat_plate(0.03, 0.03, 0.003)
    with pytest.raises(ValueError, match=message):
        displace(mesh.points, mesh.triangles, **({"worn_volume": np.zeros(200)} | arguments))


@settings(max_examples=25, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 2**32 - 1),
    step_over_edge=st.floats(1e-9, 2.0),
    limit_over_edge=st.floats(1e-3, 0.5),
    loaded=st.floats(0.01, 1.0),
)
def test_any_ledger_any_cap(seed, step_over_edge, limit_over_edge, loaded):
    """Random ledgers and caps: conserved, never outward, never past the cap, no face turned over."""
    mesh = BUMPED
    worn = mesh.cell_data["part"] >= 0
    random = np.random.default_rng(seed)
    edge = shortest_edge_at_nodes(mesh.points, mesh.triangles)
    limit = limit_over_edge * edge * random.random(len(edge))
    volume = areas(mesh.points, mesh.triangles) * step_over_edge * edge.min() * random.random(len(mesh.triangles))
    volume *= worn & (random.random(len(volume)) < loaded)
    rim = rim_directions(mesh.points, mesh.triangles, worn)
    result = displace(mesh.points, mesh.triangles, volume, None, limit, rim, worn)
    total = volume.sum()
    motion = result.points - mesh.points
    swept = swept_volume(mesh.points, motion, mesh.triangles)[worn].sum()
    assert abs(swept + result.carried_volume.sum() - total) <= ROUNDING * total
    assert (result.step >= 0.0).all() and (result.step <= limit).all()
    outward = -inward_directions(mesh.points, mesh.triangles, worn, rim)
    assert (np.einsum("ij,ij->i", motion, outward) <= 1e-16).all()  # m: rounding of coordinates of 0.03 m
    before, after = (area_vectors(p, mesh.triangles) for p in (mesh.points, result.points))
    assert (np.einsum("ij,ij->i", before, after) > 0.0).all()


def test_watertight_stays_watertight_under_repeated_wear():
    """Thirty capped cycles on a sphere: manifold, normals outward, balance closed on the body itself."""
    mesh = sphere(0.05, 3)
    points, carried, total = mesh.points, np.zeros(len(mesh.points)), 0.0
    start = unit_normals(points, mesh.triangles)
    for cycle in range(30):
        volume = random_volumes(mesh, 2e-4, seed=cycle)
        limit = 0.1 * shortest_edge_at_nodes(points, mesh.triangles)
        result = displace(points, mesh.triangles, volume, carried, limit)
        points, carried, total = result.points, result.carried_volume, total + volume.sum()
    assert len(nonmanifold_edges(mesh.triangles)) == 0
    assert (np.einsum("ij,ij->i", start, unit_normals(points, mesh.triangles)) > 0.0).all()
    lost = enclosed_volume(mesh.points, mesh.triangles) - enclosed_volume(points, mesh.triangles)
    assert lost + carried.sum() == pytest.approx(total, rel=GEOMETRY)


BUMPED = bumped_sample(4e-3)
