"""Side, direction, tangential work and drive in the load ledger: closed forms, invariances, moving meshes."""

from types import SimpleNamespace

import numpy as np
import pytest

from bulkwear.postproc.wear.ledger import (
    LEDGER_FIELDS,
    MEAN_FIELDS,
    POSITION_FIELDS,
    SUMMED_FIELDS,
    VECTOR_UNITS,
    LedgerBuilder,
    columns_of_solver,
    pressed_sides,
    vector_columns,
)
from bulkwear.postproc.wear.mesh_frame import facet_frames
from tests.postproc.wear.test_ledger import (
    CORNERS,
    DENSITY,
    EFFECTIVE_MODULUS,
    RADIUS,
    ROUND_OFF,
    VECTORS,
    assert_same,
    batch_of,
    ledger,
    random_samples,
    rotated,
    sample,
    solver_columns,
    turn,
    vector,
)

DT = 1e-3  # s, that a sample of `ledger` stands for
LEFT = 1e-11  # of sums of order one: what products with rotations leave in float64
SCALARS = (*SUMMED_FIELDS, "contact_radius_m")
RUBBING = {"force": [[0.6, 0.0, 2.0]], "particle_velocity": [[-0.3, 0.0, 0.0]]}  # friction against the sliding


def rows(table, name):
    """Vectors of a column name, (m, 3)."""
    return vector(table, vector_columns(name))


def test_the_impulse_is_that_of_the_reaction():
    """The mesh gets minus the force on the particle, friction and pulling included."""
    np.testing.assert_allclose(rows(ledger([sample(**RUBBING)]), "impulse")[0], [-0.6 * DT, 0.0, -2.0 * DT])
    pulled = ledger([sample(force=[[0.0, 0.0, -2.0]])])
    assert rows(pulled, "impulse")[0] == pytest.approx([0.0, 0.0, 2.0 * DT])
    assert pulled["normal_impulse_N_s"][0] == 0.0


def test_friction_does_the_work_of_its_force_over_the_sliding():
    """W_t = F_t L while it brakes, and less than nothing when elastic unloading pushes along."""
    braked = ledger([sample(**RUBBING)])["tangential_work_J"][0]
    pushed = ledger([sample(**{**RUBBING, "particle_velocity": [[0.3, 0.0, 0.0]]})])["tangential_work_J"][0]
    assert braked == pytest.approx(0.6 * 0.3 * DT, rel=ROUND_OFF)
    assert pushed == pytest.approx(-0.6 * 0.3 * DT, rel=ROUND_OFF)


def test_friction_sees_the_spin_and_no_normal_force():
    """v_t is that of the contact point on the lever arm R - delta/2; approach does no tangential work."""
    spinning = {"force": [[0.6, 0.0, 2.0]], "angular_velocity": [[0.0, 10.0, 0.0]]}  # contact point: -10 R along x
    assert ledger([sample(**spinning)])["tangential_work_J"][0] == pytest.approx(0.6 * 10.0 * RADIUS * DT)
    assert ledger([sample(particle_velocity=[[0.0, 0.0, -0.7]])])["tangential_work_J"][0] == 0.0


def test_a_wall_that_drives_does_work():
    """Force on the particle times the wall's velocity: what the drive must give; a wall at rest gives nothing."""
    driven = sample(force=[[0.6, 0.0, 2.0]], wall_velocity=[[0.5, 0.0, 0.1]])
    assert ledger([driven])["drive_work_J"][0] == pytest.approx((0.6 * 0.5 + 2.0 * 0.1) * DT, rel=ROUND_OFF)
    assert ledger([sample(**RUBBING)])["drive_work_J"][0] == 0.0


def test_the_drive_gives_what_friction_takes_and_the_particle_gets():
    """drive = tangential work + F . v of the contact point, where nothing approaches: energy is conserved."""
    moving = sample(force=[[0.6, 0.1, 2.0]], wall_velocity=[[0.5, 0.2, 0.0]], particle_velocity=[[0.4, -0.1, 0.0]])
    table = ledger([moving])
    gained = (0.6 * 0.4 - 0.1 * 0.1) * DT
    assert table["drive_work_J"][0] == pytest.approx(table["tangential_work_J"][0] + gained, rel=ROUND_OFF)


def test_the_side_is_that_of_the_particle_s_centre():
    """A particle below a facet that looks up presses on its back: total and back are one, the front has nothing."""
    below = sample(centre=[[0.0, 0.0, -RADIUS]], force=[[0.6, 0.0, -2.0]])
    table = ledger([below])
    np.testing.assert_array_equal(rows(table, "back_impulse"), rows(table, "impulse"))
    front, back = pressed_sides(table, facet_frames(CORNERS)[:, 2])
    assert (front[0], back[0]) == (0.0, pytest.approx(2.0 * DT))
    assert not rows(ledger([sample(**RUBBING)]), "back_impulse").any()


def test_a_sphere_on_an_edge_is_on_no_back():
    """Beside an acute edge the centre lies behind one of the two facets: that says nothing of the side it touches."""
    beside = np.array([[0.3 * RADIUS, 0.0, -np.sqrt(1.0 - 0.3**2) * RADIUS]])  # 17 degrees off the straight
    table = ledger([sample(centre=beside, force=200.0 * beside)])
    assert rows(table, "impulse").any()
    assert not rows(table, "back_impulse").any()
    assert [side[0] for side in pressed_sides(table, facet_frames(CORNERS)[:, 2])] == [0.0, 0.0]


def test_both_sides_pressed_are_told_apart():
    """3 N above and 2 N below leave 1 N in sum, but 3 and 2 on the sides."""
    both = sample(
        2, triangle=[4, 4], centre=[[0.0, 0.0, RADIUS], [0.0, 0.0, -RADIUS]], contact_point=np.zeros((2, 3)),
        force=[[0.0, 0.0, 3.0], [0.0, 0.0, -2.0]],
    )  # fmt: skip
    table = ledger([both])
    front, back = pressed_sides(table, facet_frames(CORNERS)[:, 2])
    assert rows(table, "impulse")[4] == pytest.approx([0.0, 0.0, -DT])
    assert (front[4], back[4]) == (pytest.approx(3.0 * DT), pytest.approx(2.0 * DT))


def test_a_side_that_is_pulled_is_not_pressed():
    """Damping can pull; neither side is pressed then."""
    pulled = ledger([sample(force=[[0.0, 0.0, -2.0]])])
    assert [side[0] for side in pressed_sides(pulled, facet_frames(CORNERS)[:, 2])] == [0.0, 0.0]


def test_flipped_facets_swap_the_sides_and_nothing_else():
    """Normals of the file say which side is the front; impulse and moment do not depend on them."""
    crowd = random_samples(straight=1.0)
    plain, flipped = ledger(crowd), ledger(crowd, corners=CORNERS[:, ::-1])
    same = [name for name in LEDGER_FIELDS if not name.startswith("back")]
    assert_same(flipped, plain, same)
    swapped = rows(plain, "impulse") - rows(plain, "back_impulse")
    np.testing.assert_allclose(rows(flipped, "back_impulse"), swapped, atol=LEFT * DT)
    sides, other = (
        pressed_sides(table, sign * facet_frames(CORNERS)[:, 2]) for table, sign in ((plain, 1.0), (flipped, -1.0))
    )
    np.testing.assert_allclose(other[::-1], sides, atol=LEFT * DT)


def test_the_moment_is_that_about_the_centroid():
    """Sum of r x impulse with r from the centroid to each contact point."""
    place = np.array([0.7, 0.2, 0.0])
    contact = sample(contact_point=[place], centre=[place + np.array([0.0, 0.0, RADIUS])], force=[[0.6, 0.0, 2.0]])
    expected = np.cross(place - CORNERS[0].mean(axis=0), [-0.6 * DT, 0.0, -2.0 * DT])
    np.testing.assert_allclose(rows(ledger([contact]), "moment")[0], expected, rtol=ROUND_OFF)


def moving_pose(step):
    """A mesh that turns and flies, differently at every step."""
    return turn(100 + step), np.array([0.3, -0.2, 0.5]) * (step + 1)


def moved(contacts):
    """The same contacts, with the mesh and all at the pose of their step."""
    rotation, translation = moving_pose(contacts.step)
    there = rotated(contacts, rotation)
    for name in ("contact_point", "centre"):
        setattr(there, name, getattr(there, name) + translation)
    return there


def test_a_mesh_that_moves_has_the_ledger_of_one_at_rest():
    """Contacts that turn and fly with their mesh: places and vectors come back in the mesh's own frame."""
    crowd = random_samples()
    table = ledger([moved(contacts) for contacts in crowd], pose=moving_pose)
    assert_same(table, ledger(crowd), SCALARS)
    for names in VECTORS:
        np.testing.assert_allclose(vector(table, names), vector(ledger(crowd), names), rtol=0, atol=10 * LEFT)


def test_kernels_see_the_facets_where_they_are():
    """The angle of impact is against the triangle in its pose."""
    crowd, kernels = random_samples(), {"finnie_work": {}}
    table = ledger([moved(contacts) for contacts in crowd], pose=moving_pose, kernels=kernels)
    np.testing.assert_allclose(table["finnie_work_J"], ledger(crowd, kernels=kernels)["finnie_work_J"], rtol=1e-9)


def test_batches_of_a_moving_mesh_are_its_samples():
    """add_batch takes each sample's own step, samples without contacts included."""
    flying = [moved(contacts) for contacts in random_samples()]
    options = {"corners": CORNERS, "pose": moving_pose}
    builder = LedgerBuilder(12, 0, EFFECTIVE_MODULUS, DENSITY, **options)
    for first in range(0, len(flying), 7):
        builder.add_batch(batch_of(flying[first : first + 7]), DT)
    assert_same(builder.table(), ledger(flying, **options))


def test_contacts_across_a_periodic_boundary_are_those_of_the_facet():
    """A contact seen one box further on touches the same place of the facet."""
    crowd, box = random_samples(), np.array([100.0, 0.0, 70.0])
    far = box * [-1.0, 0.0, 2.0]
    wrapped = []
    for contacts in crowd:
        there = SimpleNamespace(**vars(contacts))
        for name in ("contact_point", "centre"):
            setattr(there, name, getattr(contacts, name) + far)
        wrapped.append(there)
    for names in [SCALARS, *VECTORS]:
        found, expected = (vector(ledger(each, periods=box), names) for each in (wrapped, crowd))
        np.testing.assert_allclose(found, expected, rtol=0, atol=100 * LEFT)  # 140 m away in float64


def test_without_facets_their_columns_are_missing():
    """Side and moment need the corners; all else is the same."""
    crowd = random_samples()
    table = ledger(crowd, corners=None)
    missing = {*vector_columns("back_impulse"), *vector_columns("moment")}
    assert set(LEDGER_FIELDS) - set(table) == missing
    assert_same(table, ledger(crowd), [name for name in LEDGER_FIELDS if name not in missing])


@pytest.mark.parametrize("options", [{"corners": CORNERS[:5]}, {"corners": None, "periods": (1.0, 0.0, 0.0)}])
def test_facets_of_another_mesh_are_refused(options):
    """As many facets as triangles, and facets where images are looked for."""
    with pytest.raises(ValueError, match=r"corners of the facets have the shape .*, allowed is \(12, 3, 3\)\."):
        ledger([], **options)


def test_frames_of_facets_are_right_handed_and_turn_with_them():
    """Along the first edge, across it in the facet, normal; orthonormal."""
    corners, rotation = np.random.default_rng(5).normal(size=(30, 3, 3)), turn(6)
    frames = facet_frames(corners)
    np.testing.assert_allclose(frames @ frames.transpose(0, 2, 1), np.tile(np.eye(3), (30, 1, 1)), atol=ROUND_OFF)
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, rtol=ROUND_OFF)
    np.testing.assert_allclose(facet_frames(corners @ rotation.T), frames @ rotation.T, atol=LEFT)
    np.testing.assert_allclose(facet_frames(CORNERS[:1])[0], np.eye(3), atol=ROUND_OFF)


def test_vectors_of_the_solver_come_from_its_facets_frames():
    """What the solver sums along, across and normal is x, y, z of the file's frame."""
    random = np.random.default_rng(8)
    corners, weights = random.normal(size=(12, 3, 3)), np.full((12, 3), 1 / 3)
    vectors = {name: random.normal(size=(12, 3)) for name in VECTOR_UNITS}
    inside = {name: np.einsum("mij,mj->mi", facet_frames(corners), values) for name, values in vectors.items()}
    table = columns_of_solver(solver_columns(weights, inside), corners)
    for name, expected in vectors.items():
        np.testing.assert_allclose(rows(table, name), expected, atol=LEFT)
    assert set(MEAN_FIELDS) == {"contact_radius_m", *POSITION_FIELDS}
