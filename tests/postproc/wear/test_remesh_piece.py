"""A piece round bad faces: put back unchanged it is the old surface; changed, its border and fields still fit."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.mesh import SurfaceMesh, boundary_edges, nonmanifold_edges, volume_above_plane
from bulkwear.postproc.wear.mesh_faults import DEFAULT_BOUNDS, with_target_edges
from bulkwear.postproc.wear.remesh_piece import piece_round

SEED = 20220317
BASE = -0.01  # m, a plane below the plate
ROUNDING = 1e-13  # relative: sums of a few thousand volumes


@pytest.fixture(scope="module")
def plate():
    """A plate of 60 by 60 mm with two labels and a random field, m."""
    mesh = with_target_edges(flat_plate(0.06, 0.06, 1e-3), 1e-3)
    random = np.random.default_rng(SEED)
    part = (mesh.points[mesh.triangles].mean(axis=1)[:, 0] > 0.0).astype(np.int64)
    return SurfaceMesh(
        mesh.points, mesh.triangles, {"part": part}, mesh.point_data | {"depth": random.random(len(mesh.points))}
    )


def near(mesh, x, y):
    """Mask of the single face nearest to a place, m."""
    centre = mesh.points[mesh.triangles].mean(axis=1)
    mask = np.zeros(len(mesh.triangles), dtype=bool)
    mask[np.hypot(centre[:, 0] - x, centre[:, 1] - y).argmin()] = True
    return mask


def table(mesh):
    """Rows of corner coordinates, label and the field at the corners, sorted: the surface without its numbering."""
    corners = mesh.points[mesh.triangles].reshape(-1, 9)
    rows = np.column_stack([corners, mesh.cell_data["part"], mesh.point_data["depth"][mesh.triangles]])
    return rows[np.lexsort(rows.T)]


@pytest.mark.parametrize("place", [(0.0, 0.0), (0.029, 0.029)], ids=["inside", "corner"])
def test_an_unchanged_piece_put_back_gives_the_old_surface(plate, place):
    """Cut out and put back: the same faces with the same labels and fields, bit for bit, and no node twice."""
    piece = piece_round(plate, near(plate, *place), DEFAULT_BOUNDS)
    assert 0 < piece.inside.sum() < len(plate.triangles)
    whole = piece.put_back(piece.mesh)
    assert np.array_equal(table(whole), table(plate))
    assert len(whole.points) == len(plate.points)
    assert "node_of_whole" not in whole.point_data


def test_a_changed_piece_fits(plate):
    """Nodes moved inside of the piece: conforming, the same boundary, and the change of volume is that of the piece."""
    piece = piece_round(plate, near(plate, 0.0, 0.0), DEFAULT_BOUNDS)
    points = piece.mesh.points.copy()
    middle = np.hypot(points[:, 0], points[:, 1]) < 5e-3
    points[middle, 2] -= 1e-4
    changed = SurfaceMesh(points, piece.mesh.triangles, piece.mesh.cell_data, piece.mesh.point_data)
    whole = piece.put_back(changed)
    assert len(nonmanifold_edges(whole.triangles)) == 0
    assert len(boundary_edges(whole.triangles)) == len(boundary_edges(plate.triangles))
    losses = [
        volume_above_plane(a.points, a.triangles, BASE) - volume_above_plane(b.points, b.triangles, BASE)
        for a, b in ((plate, whole), (piece.mesh, changed))
    ]
    assert losses[0] == pytest.approx(losses[1], abs=ROUNDING * volume_above_plane(plate.points, plate.triangles, BASE))
    assert losses[1] > 0.0


def test_new_data_of_the_piece_is_kept(plate):
    """A field that only the piece has is zero elsewhere."""
    piece = piece_round(plate, near(plate, 0.0, 0.0), DEFAULT_BOUNDS)
    carried = np.random.default_rng(SEED).random(len(piece.mesh.points))
    data = piece.mesh.point_data | {"carried_volume_m3": carried}
    whole = piece.put_back(SurfaceMesh(piece.mesh.points, piece.mesh.triangles, piece.mesh.cell_data, data))
    assert whole.point_data["carried_volume_m3"].sum() == pytest.approx(carried.sum(), rel=ROUNDING)


def test_no_piece_of_a_mesh_that_is_bad_all_over(plate):
    """When most faces would be in it, there is no piece."""
    assert piece_round(plate, np.ones(len(plate.triangles), dtype=bool), DEFAULT_BOUNDS) is None
