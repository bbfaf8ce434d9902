"""A bump worn down under a prescribed field, remeshed on the way: volume, shape and labels."""

import numpy as np
import pytest

from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.sample import sample_top
from bulkwear.postproc.mesh import areas, centroids, unit_normals, volume_above_plane
from bulkwear.postproc.mesh_checks import intersecting_faces
from bulkwear.postproc.wear.caps import step_limit
from bulkwear.postproc.wear.mesh_faults import mesh_faults, with_target_edges
from bulkwear.postproc.wear.pattern_left import pattern_volume
from bulkwear.postproc.wear.remesh import remesh
from bulkwear.postproc.wear.remesh_patch import neighbours
from bulkwear.postproc.wear.update import wear_update

pytestmark = pytest.mark.verify

BALANCE = 1e-6  # relative to alpha * work, over all updates
OUTWARD = 0.01  # -, over the target edge, of every single remeshing
CLOSED = 1e-12  # relative to the volume worn: change of the body's volume by one remeshing
EDGE_FRACTION = 0.2  # -, cap of a step over the shortest edge
SPEED = 1.5e-5  # m per update, of a level face at z = 0: no step above the caps, so nothing is shaped by them
MOST_UPDATES = 800
HOLLOW_DEG = 8.0  # mean over the bump's edges of the angle by which they are hollow; 15 where pits run away
LEFT = 0.05  # -, of the bump's volume


def bump_sample(element_size):
    """A plate of 20 by 30 mm with one bump, a 8, b 2, h 6 mm."""
    pattern = ConvexPattern(8e-3, 2e-3, 6e-3, 40e-3, 40e-3, "along_travel", 0.5)
    return with_target_edges(sample_top(20e-3, 30e-3, element_size, pattern))


def over_all(mesh):
    """Rate (m,) per face, -: level faces wear faster than steep ones, high ones faster than low ones."""
    upward = np.maximum(unit_normals(mesh.points, mesh.triangles)[:, 2], 0.0)
    height = np.maximum(centroids(mesh.points, mesh.triangles)[:, 2], 0.0)
    return (0.3 + 0.7 * upward) * (1.0 + height / 2e-3)


def on_one_flank(mesh):
    """Rate (m,) per face, -: only faces turned to +y wear, those above the base."""
    facing = np.maximum(unit_normals(mesh.points, mesh.triangles)[:, 1], 0.0)
    return 2.0 * facing * np.clip(centroids(mesh.points, mesh.triangles)[:, 2] / 0.5e-3, 0.0, 1.0)


def at_the_top(mesh):
    """Rate (m,) per face, -: with the square of the height, whatever the slope."""
    return 0.5 + 4.0 * (np.maximum(centroids(mesh.points, mesh.triangles)[:, 2], 0.0) / 6e-3) ** 2


def hollow_angle(mesh):
    """Mean angle (degrees) by which the edges of the bump are hollow, weighted by length; 0 for a convex shape."""
    points, faces = mesh.points, mesh.triangles[mesh.cell_data["part"] > 0]
    pairs, opposite = neighbours(faces)
    normals = unit_normals(points, faces)[pairs]
    ends = [points[faces[pairs[:, 0], (opposite[:, 0] + k) % 3]] for k in (1, 2)]
    rise = ((points[faces[pairs[:, 1], opposite[:, 1]]] - ends[0]) * normals[:, 0]).sum(axis=1)
    angle = np.degrees(np.arccos(np.clip((normals[:, 0] * normals[:, 1]).sum(axis=1), -1.0, 1.0)))
    return np.average(np.where(rise > 0.0, angle, 0.0), weights=np.linalg.norm(ends[1] - ends[0], axis=1))


def wear(pristine, speed, updates, stop, rate=over_all):
    """Wear and remesh at a speed (m per update) times a rate (-).

    Yields (mesh, its remeshing, volume worn so far in m3) after every update.
    """
    mesh, total = pristine, 0.0
    for _ in range(updates):
        volume = speed * rate(mesh) * areas(mesh.points, mesh.triangles)
        limit = step_limit(mesh.points, mesh.triangles, EDGE_FRACTION, 1.0, 1.0)
        mesh, _ = wear_update(mesh, volume, limit, wall=(0.0, 0.0, -1.0))
        outcome = remesh(mesh)
        mesh, total = outcome.mesh, total + volume.sum()
        yield mesh, outcome, total
        if pattern_volume(mesh) < stop * pattern_volume(pristine):
            return


def balance_error(pristine, mesh, total):
    """Relative error of pristine minus present volume plus carried = alpha * work."""
    removed = volume_above_plane(pristine.points, pristine.triangles) - volume_above_plane(mesh.points, mesh.triangles)
    return abs(removed + mesh.point_data["carried_volume_m3"].sum() - total) / total


def test_balance_over_200_updates_with_remeshing():
    """Pristine minus present volume plus carried = alpha * work to 1e-6; no remeshed surface stands out by 1 %."""
    pristine, remeshed = bump_sample(2e-3), 0
    for mesh, outcome, total in wear(pristine, SPEED / 1.5, 200, 0.0):
        assert balance_error(pristine, mesh, total) < BALANCE
        assert outcome.largest_outward <= OUTWARD
        assert abs(outcome.volume_change_m3) < CLOSED * total
        remeshed += outcome.faces_changed > 0
    assert remeshed > 10


@pytest.mark.parametrize("rate", [over_all, on_one_flank, at_the_top])
def test_bump_is_worn_through(rate):
    """A bump worn until less than 5 % is left: nothing folded, cut or jagged, balance closed, labels alive."""
    pristine = bump_sample(2e-3)
    for mesh, outcome, total in wear(pristine, SPEED, MOST_UPDATES, LEFT, rate):
        assert not outcome.faults.tangled.any()
        assert abs(outcome.volume_change_m3) < CLOSED * total
        assert balance_error(pristine, mesh, total) < BALANCE
        assert outcome.largest_outward <= OUTWARD
        assert set(np.unique(mesh.cell_data["part"])) == {0, 1}
        assert hollow_angle(mesh) < HOLLOW_DEG
    assert pattern_volume(mesh) < LEFT * pattern_volume(pristine)
    assert len(intersecting_faces(mesh.points, mesh.triangles)) == 0
    assert not mesh_faults(mesh).folded.any()
    rim = [np.sort(m.points[np.abs(m.points[:, 1]) > 15e-3 - 1e-9, 0]) for m in (pristine, mesh)]
    assert np.array_equal(*rim)
