"""One wear update of a mesh, its record and its checks."""

import numpy as np
import pytest

from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.plate import flat_plate
from bulkwear.meshes.sample import sliding_sample
from bulkwear.postproc.mesh import SurfaceMesh, areas, smallest_angles, worn_faces
from bulkwear.postproc.wear.balance import BALANCE_TOLERANCE, BalanceError, lost_volume, volume_balance
from bulkwear.postproc.wear.caps import step_limit
from bulkwear.postproc.wear.displacement import StepTooLargeError, swept_volume
from bulkwear.postproc.wear.patch import ContactPatch
from bulkwear.postproc.wear.update import wear_update, with_depths

SEED = 20220317
ROUNDING = 1e-12  # relative: sums over a few thousand numbers
DEPTH = 1e-9  # relative: depths are differences of coordinates some 1e4 times larger
DOWN = (0.0, 0.0, -1.0)  # where the rim of a sample slides
FIELDS = ("removed_thickness_m", "height_loss_m", "ray_depth_m", "carried_volume_m3")


@pytest.fixture(scope="module")
def sample():
    """A 60 x 60 mm sample, three bumps, skirt, 0.3 mm above the floor; m."""
    pattern = ConvexPattern(8e-3, 4e-3, 4e-3, 30e-3, 30e-3, "along_travel", 0.5)
    return sliding_sample(60e-3, 60e-3, 4e-3, pattern, 0.3e-3, np.radians(3.0))


def random_volume(mesh, depth, seed=SEED):
    """Random worn volumes (m,) m3 of the faces that wear, mean depth about `depth` m."""
    random = np.random.default_rng(seed)
    return worn_faces(mesh) * areas(mesh.points, mesh.triangles) * 2.0 * depth * random.random(len(mesh.triangles))


def test_zero_load_leaves_every_bit(sample):
    """No wear: coordinates bit-identical, all fields zero, labels and triangles kept."""
    worn, record = wear_update(sample, np.zeros(len(sample.triangles)), wall=DOWN)
    worn = with_depths(worn, sample)
    assert worn.points.tobytes() == sample.points.tobytes()
    assert all(not worn.point_data[name].any() for name in FIELDS)
    assert np.array_equal(worn.cell_data["part"], sample.cell_data["part"])
    assert record["applied_volume_m3"] == record["carried_volume_m3"] == record["largest_step_m"] == 0.0


def test_uniform_wear_of_a_plate_gives_one_depth():
    """Three even updates of a plate: thickness, height loss and ray depth are all 3 V / A, rim included."""
    plate, down = flat_plate(0.06, 0.039, 0.003), 1e-5
    mesh = plate
    for _ in range(3):
        mesh, record = wear_update(mesh, down * areas(mesh.points, mesh.triangles), wall=DOWN)
    worn = with_depths(mesh, plate)
    for name in FIELDS[:3]:
        np.testing.assert_allclose(worn.point_data[name], 3.0 * down, rtol=DEPTH)
    assert record["largest_depth_m"] == pytest.approx(3.0 * down, rel=DEPTH)
    assert record["largest_step_m"] == pytest.approx(down, rel=DEPTH)
    assert record["smallest_angle_deg"] == pytest.approx(45.0, rel=DEPTH)


def test_balance_closes_over_capped_cycles(sample):
    """At every moment applied + carried = alpha * work, and what was applied is what the geometry lost."""
    mesh, total, applied = sample, 0.0, 0.0
    for cycle in range(5):
        volume = random_volume(mesh, 2e-5, seed=cycle)
        limit = step_limit(mesh.points, mesh.triangles, 0.1, 0.01, 0.2)
        new, record = wear_update(mesh, volume, limit, wall=DOWN)
        swept = swept_volume(mesh.points, new.points - mesh.points, mesh.triangles)[worn_faces(mesh)]
        assert record["applied_volume_m3"] == pytest.approx(swept.sum(), rel=ROUNDING)
        assert record["worn_volume_m3"] == pytest.approx(volume.sum(), rel=ROUNDING)
        assert record["largest_step_m"] <= limit.max()
        assert record["carried_volume_m3"] == pytest.approx(new.point_data["carried_volume_m3"].sum(), rel=ROUNDING)
        total, applied, mesh = total + record["worn_volume_m3"], applied + record["applied_volume_m3"], new
        assert volume_balance(applied, record["carried_volume_m3"], total) < BALANCE_TOLERANCE
    assert record["carried_volume_m3"] > 0.01 * total  # the caps did bite
    angles = smallest_angles(mesh.points, mesh.triangles[worn_faces(mesh)])
    assert record["smallest_angle_deg"] == pytest.approx(angles.min(), rel=ROUNDING)


def test_wear_of_the_holder_is_not_counted(sample):
    """Volumes on the skirt move nothing and stand in no sum."""
    volume = np.where(worn_faces(sample), 0.0, 1e-9)
    worn, record = wear_update(sample, volume, wall=DOWN)
    assert worn.points.tobytes() == sample.points.tobytes()
    assert record["worn_volume_m3"] == record["carried_volume_m3"] == 0.0


def test_rim_goes_straight_down_and_never_out(sample):
    """Rim nodes keep x and y; no node of the skirt below the rim moves."""
    worn = sample
    for cycle in range(3):  # after uneven wear the normals at the rim lean, its path must not
        worn, _ = wear_update(worn, random_volume(sample, 1e-5, seed=cycle), wall=DOWN)
    faces = worn_faces(sample)
    rim = np.intersect1d(sample.triangles[faces], sample.triangles[~faces])
    assert np.array_equal(worn.points[rim, :2], sample.points[rim, :2])
    assert (worn.points[rim, 2] < sample.points[rim, 2]).all()
    below = np.setdiff1d(sample.triangles[~faces], rim)
    assert worn.points[below].tobytes() == sample.points[below].tobytes()


def test_fields_are_zero_where_nothing_was_removed(sample):
    """Wear on one bump leaves all depths of nodes off that bump at zero; on it all are positive."""
    volume = np.where(sample.cell_data["part"] == 1, random_volume(sample, 1e-5), 0.0)
    worn, _ = wear_update(sample, volume, wall=DOWN)
    worn = with_depths(worn, sample)
    on_bump = np.zeros(len(sample.points), dtype=bool)
    on_bump[sample.triangles[sample.cell_data["part"] == 1]] = True
    for name in FIELDS[:3]:
        assert not worn.point_data[name][~on_bump].any()
        assert (worn.point_data[name][on_bump] > 0.0).all()


def test_smallest_angle_is_that_of_the_worn_faces():
    """An acute triangle of the holder is not reported: 45 degrees, not its 5.7."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, -0.05, 0.0]])
    mesh = SurfaceMesh(points, np.array([[0, 1, 2], [0, 3, 1]]), {"part": np.array([0, -1])})
    _, record = wear_update(mesh, np.zeros(2), wall=DOWN)
    assert record["smallest_angle_deg"] == pytest.approx(45.0, rel=DEPTH)


def test_other_point_data_survive(sample):
    """Data that the update does not know are handed on."""
    marked = SurfaceMesh(sample.points, sample.triangles, sample.cell_data, {"mark": np.arange(len(sample.points))})
    worn, _ = wear_update(marked, random_volume(sample, 1e-5), wall=DOWN)
    assert np.array_equal(worn.point_data["mark"], marked.point_data["mark"])


def test_patch_spreads_and_the_balance_still_closes(sample):
    """With a contact patch more nodes move than without, base and bumps in sum lose the same volume."""
    volume = random_volume(sample, 1e-5) * (np.arange(len(sample.triangles)) % 7 == 0)
    centres = sample.points[sample.triangles].mean(axis=1)
    patch = ContactPatch(centres, np.full(len(centres), 6e-3))
    limit = step_limit(sample.points, sample.triangles, 0.1, 0.01, 0.2)
    spread_mesh, spread_record = wear_update(sample, volume, limit, patch=patch, wall=DOWN)
    mesh, record = wear_update(sample, volume, limit, wall=DOWN)
    assert spread_record["worn_volume_m3"] == record["worn_volume_m3"] == pytest.approx(volume.sum(), rel=ROUNDING)
    moved, spread_moved = ((each.point_data["removed_thickness_m"] > 0.0).sum() for each in (mesh, spread_mesh))
    assert spread_moved > moved
    lost, rounding = lost_volume(sample, spread_mesh)
    assert volume_balance(lost, spread_record["carried_volume_m3"], volume.sum(), rounding) < BALANCE_TOLERANCE
    assert abs(spread_record["excess_volume_m3"]) < ROUNDING * volume.sum()


def test_unknown_scheme_is_refused(sample):
    """The message names the allowed ones."""
    with pytest.raises(ValueError, match="scheme 'other' is unknown, allowed are: conserving, per_triangle"):
        wear_update(sample, np.zeros(len(sample.triangles)), scheme="other", wall=DOWN)


def test_too_large_a_step_is_refused(sample):
    """Without caps wear of a centimetre on millimetre triangles is refused."""
    with pytest.raises(StepTooLargeError, match="of the shortest altitude"):
        wear_update(sample, random_volume(sample, 1e-2), wall=DOWN)


def test_balance_raises_above_its_tolerance():
    """Lost or invented volume raises; the tolerance itself passes; no wear at all is balanced."""
    assert volume_balance(0.75, 0.25, 1.0) == 0.0
    assert volume_balance(0.0, 0.0, 0.0) == 0.0
    assert volume_balance(0.75, 0.25, 1.0 + 0.5 * BALANCE_TOLERANCE) > 0.0
    for applied, carried, law in (
        (0.75, 0.25, 1.0 + 2.0 * BALANCE_TOLERANCE),
        (1e-12, 0.0, 0.0),
        (np.nan, 0.0, 1.0),
    ):
        with pytest.raises(BalanceError, match="differ from the worn volume"):
            volume_balance(applied, carried, law)
