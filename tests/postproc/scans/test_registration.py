"""A scan in any position finds back to its sample by what did not wear."""

import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.scans import registration
from bulkwear.postproc.scans.registration import CELL, position_error, register, symmetries
from bulkwear.postproc.scans.start import (
    IDENTITY,
    RigidMotion,
    largest_distance,
    plane_step,
    rough_positions,
    turned_about,
)
from bulkwear.postproc.wear.old_surface import OldSurface
from tests.support import scanned_sample as sample

POSITION = 20e-6  # m, asked of a registration: the accuracy of the scanner
MONTE_CARLO = 0.15  # -, of an error estimated from a hundred trials: its own standard error is 0.07
ROUNDING = 1e-12


@pytest.fixture(scope="module", autouse=True)
def registered_again():
    """Two tests register a scan that was registered before."""
    with sample.rough_positions_once():
        yield


@pytest.fixture(scope="module")
def pristine():
    return sample.pristine_sample()


def corners(mesh):
    return np.stack(np.meshgrid(*np.stack([mesh.points.min(axis=0), mesh.points.max(axis=0)], axis=1)), -1).reshape(
        -1, 3
    )


@pytest.mark.parametrize(("seed", "pattern"), [(1, sample.PATTERN), pytest.param(3, None, marks=pytest.mark.verify)])
def test_known_motion_is_recovered(seed, pattern):
    """Worn by up to 0.3 mm, with noise, a hole and outliers, turned anyhow: found to 0.02 mm, the right way round."""
    mesh = sample.pristine_sample(pattern)
    motion = sample.any_motion(seed)
    scan = sample.scan_of(sample.worn_sample(mesh), motion, 30_000, seed=seed)
    found = register(scan, mesh, sample.NOISE, leading_edge=sample.leading_edge(motion))
    assert largest_distance(found.motion.after(motion), IDENTITY, corners(mesh)) < POSITION
    assert found.uncertainty < POSITION
    assert found.spread == pytest.approx(sample.NOISE, rel=0.05)
    assert found.symmetric == (2 if pattern else 4)


@pytest.mark.verify
def test_half_a_sample_is_enough(pristine):
    """One half is missing, bumps and holder: no row of bumps beside, and within the stated uncertainty."""
    motion = sample.any_motion(6)
    scan = sample.scan_of(sample.worn_sample(pristine), IDENTITY, 20_000, seed=6)
    scan = motion(scan[scan[:, 0] < 0.0])
    found = register(scan, pristine, sample.NOISE, leading_edge=sample.leading_edge(motion))
    assert largest_distance(found.motion.after(motion), IDENTITY, corners(pristine)) < found.uncertainty
    assert found.uncertainty > 2.0 * POSITION


def test_without_a_leading_edge_a_symmetric_sample_is_refused(pristine):
    """Half a turn looks the same: nothing is guessed."""
    scan = sample.scan_of(sample.worn_sample(pristine), sample.any_motion(1), 30_000, seed=1)
    with pytest.raises(ValueError, match="looks the same in 2 positions"):
        register(scan, pristine, sample.NOISE)


@pytest.mark.verify
def test_even_wear_is_taken_for_a_shift_only_where_all_decides(pristine):
    """The holder keeps an even loss in view; a best fit of everything loses most of it."""
    worn = sample.worn_sample(pristine)
    scan = sample.scan_of(worn, IDENTITY, 4000, outliers=0.0)
    edge = sample.leading_edge(IDENTITY)
    by_holder, by_all = (
        register(scan, pristine, sample.NOISE, deciding, edge).motion.translation[2] for deciding in ("holder", "all")
    )
    assert abs(by_holder) < 0.1 * sample.BASE_LOSS
    assert by_all > 0.5 * sample.BASE_LOSS


def test_a_surface_without_holder_is_refused(pristine):
    labels = {name: np.maximum(label, 0) for name, label in pristine.cell_data.items()}
    mesh = SurfaceMesh(pristine.points, pristine.triangles, labels)
    with pytest.raises(ValueError, match="no holder"):
        register(pristine.points, mesh, sample.NOISE)


def test_a_scan_in_a_wrong_unit_is_refused(pristine):
    """Read in inches it fits nowhere: said, not forced."""
    scan = sample.scan_of(pristine, sample.any_motion(1), 5000) * 25.4
    with pytest.raises(ValueError, match="check the unit"):
        register(scan, pristine, sample.NOISE, leading_edge=scan[0])


def test_a_scan_without_the_holder_is_refused(pristine, monkeypatch):
    """What decides must be scanned: refused although the scan lies where it belongs."""
    monkeypatch.setattr(registration, "rough_positions", lambda scan, mesh: [IDENTITY])
    inside = np.abs(pristine.points[:, :2]).max(axis=1) < 0.9 * sample.SIDE / 2
    with pytest.raises(ValueError, match="of what decides"):
        register(pristine.points[inside], pristine, sample.NOISE, leading_edge=sample.leading_edge(IDENTITY))


def test_symmetries(pristine):
    """The plain square has four, the pattern of straight and shifted rows two."""
    assert len(symmetries(pristine, OldSurface(pristine.points, pristine.triangles))) == 2
    plain = sample.pristine_sample(None)
    assert len(symmetries(plain, OldSurface(plain.points, plain.triangles))) == 4


def three_planes(count, generator):
    """Points (3 count, 3) m on three faces of a cube of 0.1 m, each in cells of its own, and the normals."""
    points, normals = [], []
    for axis in range(3):
        face = generator.uniform(0.0, 0.1, (count, 3))
        face[:, axis] = 0.0
        points.append(face)
        normals.append(np.tile(np.eye(3)[axis], (count, 1)))
    return np.concatenate(points), np.concatenate(normals)


def test_position_error_is_that_of_repeated_fits():
    """The estimate is what a hundred fits to errors that are even over cells scatter by."""
    generator = np.random.default_rng(4)
    points, normals = three_planes(1500, generator)
    cell = np.unique(np.floor(points / CELL).astype(int), axis=0, return_inverse=True)[1].ravel()
    corner = np.full((1, 3), 0.1)
    away = []
    for _ in range(100):
        error = generator.normal(0.0, sample.NOISE, cell.max() + 1)[cell]
        step = plane_step(points + error[:, None] * normals, points, normals, np.ones(len(points)))
        away.append(step(corner) - corner)
    scatter = np.sqrt((np.concatenate(away) ** 2).sum(axis=1).mean())
    assert position_error(points, normals, sample.NOISE, corner) == pytest.approx(scatter, rel=MONTE_CARLO)


def test_one_plane_holds_nothing_within_it():
    points = np.column_stack([np.random.default_rng(1).uniform(0.0, 0.1, (500, 2)), np.zeros(500)])
    assert position_error(points, np.tile((0.0, 0.0, 1.0), (500, 1)), sample.NOISE, np.ones((1, 3))) == np.inf


def test_points_on_one_line_show_no_surface(pristine):
    """Nor do points in one place."""
    for along in (np.linspace(0.0, 1.0, 200), np.zeros(200)):
        with pytest.raises(ValueError, match="in one place or on one line"):
            rough_positions(np.outer(along, (1.0, 0.0, 0.0)), pristine)


def test_motions_undo_each_other():
    motion = sample.any_motion(7)
    points = np.random.default_rng(2).normal(size=(20, 3))
    assert np.abs(motion.inverse(motion(points)) - points).max() < ROUNDING
    assert np.abs(motion.after(motion.inverse)(points) - points).max() < ROUNDING
    turned = turned_about(np.array([0.0, 0.0, np.pi]), np.array([1.0, 0.0, 0.0]), np.zeros(3))
    assert np.abs(turned(np.zeros((1, 3))) - (2.0, 0.0, 0.0)).max() < ROUNDING
    assert RigidMotion(turned.rotation, np.zeros(3)).angle == pytest.approx(np.pi)
