"""Contact patch: what it keeps, where it may go, and its shape against Hertz."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from scipy.special import j0

from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.plate import closed_box, flat_plate, sphere
from bulkwear.meshes.sample import sample_top, sliding_sample
from bulkwear.postproc.mesh import areas, node_area_vectors, sum_over_nodes, unit_normals
from bulkwear.postproc.wear.ledger import hertz_contact_radius
from bulkwear.postproc.wear.patch import (
    MESH_VARIANCE,
    ContactPatch,
    barycentric_weights,
    chosen_radius,
    hertz_disc,
    physical_radius,
    spread,
)

SEED = 20220317
ROUNDING = 1e-12  # relative: sums over some 1e5 numbers
PLACE = 1e-12  # m: rounding of positions of some 1e-2 m, weighted over a patch
LONE_PATCH = 0.02  # -, rms over the rms: quadrature on a regular mesh. Measured: 0.003 (irregular: 0.03 to 0.05)
FADED = 0.001  # -, of the peak: beyond the rim of the patch, and the faces that reach over it, is nothing
LARGEST_WAVE_NUMBER = 100.0  # times a; what is cut off is below 1e-3 of the peak, its square falls with q^-4
RESPONSE_ERROR = 0.015  # -, of 1: quadrature, and the linear deposit on edges of a/12
LOWEST = 1.1  # wavelength over contact radius where the pressure itself would answer with the most negative
FRAME = 1e-9  # -, of the volume: a rotated body has other rounding errors in its edges


def one_contact(mesh, triangle, weights, radius, volume=1e-12):
    """Corner volumes after one contact on a triangle, and its position (3,) m."""
    position = np.full((len(mesh.triangles), 3), np.nan)
    position[triangle] = weights @ mesh.points[mesh.triangles[triangle]]
    load = np.zeros(len(mesh.triangles))
    load[triangle] = volume
    worn = mesh.cell_data["part"] >= 0
    patch = ContactPatch(position, np.where(load > 0.0, radius, np.nan))
    return spread(mesh.points, mesh.triangles, load, patch, worn), position[triangle]


def random_contacts(mesh, random, loaded=0.3, largest_radius=8e-3):
    """Volume, patch and worn mask of contacts at random places of random width."""
    count = len(mesh.triangles)
    weights = random.dirichlet((1.0, 1.0, 1.0), count)
    volume = random.random(count) * (random.random(count) < loaded) * 1e-12
    position = np.einsum("mc,mcx->mx", weights, mesh.points[mesh.triangles])
    return volume, ContactPatch(position, largest_radius * random.random(count)), mesh.cell_data["part"] >= 0


@pytest.mark.parametrize("rings", [1, 2, 3, 10])
def test_disc_has_the_moments_of_hertz(rings):
    """Weights sum to 1, mean exactly in the centre, mean of r^2 = 2/5, all points within sqrt(2)."""
    points, weights = hertz_disc(rings)
    square = (points**2).sum(axis=1)
    assert weights.sum() == pytest.approx(1.0, rel=ROUNDING)
    assert np.abs(weights @ points).max() < ROUNDING
    assert weights @ square == pytest.approx(0.4, rel=ROUNDING)
    assert square.max() < 2.0


@pytest.mark.parametrize("radius_over_edge", [0.0, 0.3, 1.0, 3.0, 8.0])
def test_volume_and_mean_position_are_kept(radius_over_edge):
    """On a plane, patches within one face or over hundreds keep the volume and its mean position exactly."""
    mesh = flat_plate(0.04, 0.04, 1e-3)
    weights = np.array([0.2, 0.5, 0.3])
    corners, position = one_contact(mesh, 1641, weights, radius_over_edge * 1e-3)
    assert corners.min() >= 0.0
    assert corners.sum() == pytest.approx(1e-12, rel=ROUNDING)
    mean = np.einsum("mc,mcx->x", corners, mesh.points[mesh.triangles]) / corners.sum()
    np.testing.assert_allclose(mean, position, rtol=0.0, atol=PLACE)


def test_a_patch_the_mesh_cannot_resolve_stays_on_its_face():
    """Narrower than what the mesh itself spreads: the touched face alone, its corners by the contact's place."""
    mesh = flat_plate(0.02, 0.02, 1e-3)
    weights = np.array([0.2, 0.5, 0.3])
    squares = 4.0e-6  # m2, of the edges of a face: 1 + 1 + 2 mm2
    corners, _ = one_contact(mesh, 400, weights, 0.99 * np.sqrt(MESH_VARIANCE * squares))
    np.testing.assert_allclose(corners[400], 1e-12 * weights, rtol=ROUNDING)
    assert not np.delete(corners, 400, axis=0).any()


def test_straight_track_within_a_face_is_exact_however_long():
    """Hat functions are linear: the mean of a track's deposits is the deposit of its mean position."""
    mesh = flat_plate(0.02, 0.02, 1e-3)
    ends = np.array([[0.8, 0.15, 0.05], [0.1, 0.2, 0.7]])
    track = np.linspace(0.0, 1.0, 11)[:, None] * (ends[1] - ends[0]) + ends[0]
    every = np.mean([one_contact(mesh, 400, weights, 0.0)[0] for weights in track], axis=0)
    np.testing.assert_allclose(every, one_contact(mesh, 400, ends.mean(axis=0), 0.0)[0], rtol=0.0, atol=1e-24)


def pressure_response(q):
    """What is left of a wave under the pressure sqrt(1 - r^2): its Fourier transform over that at 0, q > 0 - ."""
    return 3.0 * (np.sin(q) - q * np.cos(q)) / q**3


def test_depth_under_a_resolved_patch_is_the_pressure_of_hertz_spread_twice():
    """Over hundreds of faces the depth is V times the inverse Hankel transform of the square of the pressure's."""
    mesh = sample_top(12e-3, 12e-3, 0.4e-3, None)
    radius, volume = 4e-3, 1e-12
    middle = int(np.argmin(np.linalg.norm(mesh.points[mesh.triangles].mean(axis=1), axis=1)))
    corners, position = one_contact(mesh, middle, np.full(3, 1 / 3), radius, volume)
    nodal = np.bincount(mesh.triangles.ravel(), corners.ravel(), len(mesh.points))
    depth = nodal / np.linalg.norm(node_area_vectors(mesh.points, mesh.triangles), axis=1)
    distance = np.linalg.norm(mesh.points - position, axis=1) / radius
    q = np.linspace(1e-3, LARGEST_WAVE_NUMBER, 2000)
    waves = pressure_response(q / np.sqrt(2.0)) ** 2 * j0(np.multiply.outer(distance, q)) * q
    expected = volume * np.trapezoid(waves, q, axis=1) / (2.0 * np.pi * radius**2)
    error = (depth - expected)[distance < np.sqrt(2.0)]
    assert np.sqrt((error**2).mean() / (expected[distance < np.sqrt(2.0)] ** 2).mean()) < LONE_PATCH
    assert depth[distance > 1.5].max() < FADED * expected.max()


@pytest.mark.parametrize("wavelength", [0.8, LOWEST, 1.4, 2.0, 4.0])
def test_no_wave_comes_out_of_a_patch_inverted(wavelength):
    """A wave of that length over a comes out times the square of what one pressure of a / sqrt(2) leaves of it.

    Under the pressure itself waves of about 1.1 a would turn their sign: wear of a ridge would fall beside it.
    """
    radius = 1e-3
    mesh = flat_plate(6 * radius, 6 * radius, radius / 12)
    middle = int(np.argmin(np.linalg.norm(mesh.points[mesh.triangles].mean(axis=1), axis=1)))
    corners, position = one_contact(mesh, middle, np.full(3, 1 / 3), radius)
    x = (mesh.points[mesh.triangles][:, :, 0] - position[0]) / radius
    q = 2.0 * np.pi / wavelength
    response = (corners * np.cos(q * x)).sum() / corners.sum()
    assert response == pytest.approx(pressure_response(q / np.sqrt(2.0)) ** 2, abs=RESPONSE_ERROR)
    if wavelength == LOWEST:
        assert pressure_response(q) < -5.0 * RESPONSE_ERROR


def test_a_patch_keeps_off_what_does_not_wear():
    """On a sample with skirt and bumps: nothing on the holder, nothing lost, wherever the contacts are."""
    mesh = SAMPLE
    volume, patch, worn = random_contacts(mesh, np.random.default_rng(SEED))
    corners = spread(mesh.points, mesh.triangles, volume, patch, worn)
    assert not corners[~worn].any()
    assert corners.sum() == pytest.approx(volume[worn].sum(), rel=ROUNDING)
    assert (corners[worn].sum(axis=1) > 0.0).sum() > (volume[worn] > 0.0).sum()  # it did spread


def test_a_patch_stays_on_its_side_of_thin_and_sharp_things():
    """On a box one edge thick a wide patch on the top reaches neither the walls nor the bottom."""
    mesh = closed_box(0.02, 0.02, 1e-3, 1e-3)
    up = unit_normals(mesh.points, mesh.triangles)[:, 2]
    for triangle in np.flatnonzero(up > 0.5)[::97]:
        corners, _ = one_contact(mesh, triangle, np.full(3, 1 / 3), 4e-3)
        assert not corners[up < 0.5].any()
        assert corners.sum() == pytest.approx(1e-12, rel=ROUNDING)


def test_a_patch_does_not_turn_by_more_than_sixty_degrees():
    """On a ball as wide as the patch, only faces within 60 degrees of the touched one share."""
    mesh = sphere(2e-3, 4)
    corners, _ = one_contact(mesh, 1000, np.full(3, 1 / 3), 4e-3)
    normals = unit_normals(mesh.points, mesh.triangles)
    cosine = normals @ normals[1000]
    assert not corners[cosine < 0.5].any()
    assert (corners[cosine > 0.55].sum(axis=1) > 0.0).mean() > 0.9


def test_wear_follows_the_surface_round_a_curve():
    """On a cylinder-like ball of large radius the patch is as on the plane: variance a^2/5 along both axes."""
    mesh = sphere(0.05, 6)
    radius = 6e-3
    corners, position = one_contact(mesh, 4000, np.full(3, 1 / 3), radius)
    normal = position / np.linalg.norm(position)
    first = np.cross(normal, (0.3, 0.4, 0.5))
    first /= np.linalg.norm(first)
    for axis in (first, np.cross(normal, first)):
        along = (mesh.points[mesh.triangles] - position) @ axis
        variance = (corners * along**2).sum() / corners.sum()
        assert variance == pytest.approx(radius**2 / 5.0, rel=0.02)  # curvature (a/R)^2 and the mesh's own share


@settings(max_examples=20, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), loaded=st.floats(0.001, 1.0), largest=st.floats(0.0, 8e-3))
def test_any_contacts_are_conserved_and_their_order_does_not_matter(seed, loaded, largest):
    """Random contacts on a sample: conserved, >= 0; faces renumbered and corners rolled change nothing."""
    mesh = SAMPLE
    random = np.random.default_rng(seed)
    volume, patch, worn = random_contacts(mesh, random, loaded, largest)
    here = spread(mesh.points, mesh.triangles, volume, patch, worn)
    assert here.min() >= 0.0 and not here[~worn].any()
    assert abs(here.sum() - volume[worn].sum()) <= ROUNDING * volume.sum()
    order = random.permutation(len(mesh.triangles))
    mixed = ContactPatch(patch.position[order], patch.radius[order])
    there = spread(mesh.points, np.roll(mesh.triangles[order], 1, axis=1), volume[order], mixed, worn[order])
    np.testing.assert_allclose(np.roll(there, -1, axis=1), here[order], rtol=0.0, atol=FRAME * volume.sum())


def test_rotation_does_not_matter():
    """The patch of a turned and shifted body is the same."""
    mesh = SAMPLE
    volume, patch, worn = random_contacts(mesh, np.random.default_rng(SEED))
    rotation, shift = Rotation.from_rotvec([0.3, -0.7, 1.1]).as_matrix(), np.array([0.02, -0.03, 0.05])
    turned = ContactPatch(patch.position @ rotation.T + shift, patch.radius)
    here = spread(mesh.points, mesh.triangles, volume, patch, worn)
    there = spread(mesh.points @ rotation.T + shift, mesh.triangles, volume, turned, worn)
    nodes = [
        sum_over_nodes(mesh.triangles[:, [k]].repeat(3, 1), each[:, k], len(mesh.points))
        for each in (here, there)
        for k in range(3)
    ]
    np.testing.assert_allclose(sum(nodes[3:]), sum(nodes[:3]), rtol=0.0, atol=FRAME * volume.sum())


def test_no_load_no_volume():
    """Without wear all corner volumes are zero, and missing positions are no fault."""
    mesh = flat_plate(0.01, 0.01, 1e-3)
    count = len(mesh.triangles)
    patch = ContactPatch(np.full((count, 3), np.nan), np.full(count, np.nan))
    assert not spread(mesh.points, mesh.triangles, np.zeros(count), patch).any()


@pytest.mark.parametrize(
    ("position", "radius", "message"),
    [
        ((np.nan, 0.0, 0.0), 1e-3, "triangle 7 is worn but its mean contact position"),
        ((0.5, 0.5, 0.0), 1e-3, "does not lie on it"),
        (None, np.nan, "triangle 7 is worn but its contact radius is nan m"),
        (None, -1e-3, "triangle 7 is worn but its contact radius is -0.001 m"),
    ],
)
def test_wear_without_a_contact_is_refused(position, radius, message):
    """A worn triangle needs a position on it and a radius; the message names the triangle."""
    mesh = flat_plate(0.01, 0.01, 1e-3)
    centres = mesh.points[mesh.triangles].mean(axis=1)
    if position is not None:
        centres[7] = position
    volume = np.zeros(len(centres))
    volume[7] = 1e-12
    with pytest.raises(ValueError, match=message):
        spread(mesh.points, mesh.triangles, volume, ContactPatch(centres, np.full(len(centres), radius)))


def test_a_position_beside_its_triangle_counts_at_its_edge():
    """Contact points at edges may lie half an overlap beside the triangle: the volume goes to that edge."""
    mesh = flat_plate(0.01, 0.01, 1e-3)
    corners, _ = one_contact(mesh, 100, np.array([-0.2, 0.6, 0.6]), 0.0)
    np.testing.assert_allclose(corners[100], 1e-12 * np.array([0.0, 0.5, 0.5]), rtol=ROUNDING, atol=1e-26)


def test_barycentric_weights_give_the_point_back():
    """Weights times corners is the point; points off the plane are projected."""
    random = np.random.default_rng(SEED)
    points, triangles = random.random((30, 3)), np.arange(30).reshape(10, 3)
    weights = random.dirichlet((1.0, 1.0, 1.0), 10)
    position = np.einsum("mc,mcx->mx", weights, points[triangles])
    lifted = position + 0.1 * unit_normals(points, triangles)
    for place in (position, lifted):
        np.testing.assert_allclose(barycentric_weights(points, triangles, place), weights, atol=1e-9)
    assert (areas(points, triangles) > 0.0).all()


def test_physical_radius_is_that_of_the_true_contact():
    """a_sim (E_sim/E)^(1/3) / s is the Hertz radius of F/s^2 on a sphere of R/s with the true modulus."""
    force, radius, soft, stiff, scale = 0.7, 4e-3, 7e7, 5e9, 3.0
    simulated = hertz_contact_radius(force, radius, soft)
    true = hertz_contact_radius(force / scale**2, radius / scale, stiff)
    assert physical_radius(simulated, soft, stiff, scale) == pytest.approx(true, rel=ROUNDING)
    with pytest.raises(ValueError, match=r"true_modulus is 0\.0, allowed"):
        physical_radius(simulated, soft, 0.0, scale)


def test_choice_of_the_radius():
    """simulated: as it is; physical: times the factor; a length: that length wherever there was contact."""
    ledger = np.array([1e-4, np.nan, 3e-4])
    np.testing.assert_array_equal(chosen_radius("simulated", ledger, 0.5), ledger)
    np.testing.assert_array_equal(chosen_radius("physical", ledger, 0.5), 0.5 * ledger)
    np.testing.assert_array_equal(chosen_radius(2e-4, ledger), [2e-4, np.nan, 2e-4])
    for wrong in ("hertz", -1e-3, np.nan):
        with pytest.raises(ValueError, match=f"patch is .*{wrong}"):
            chosen_radius(wrong, ledger)


PATTERN = ConvexPattern(8e-3, 4e-3, 4e-3, 30e-3, 30e-3, "along_travel", 0.5)
SAMPLE = sliding_sample(60e-3, 60e-3, 4e-3, PATTERN, 0.3e-3, np.radians(3.0))
