"""Faults of a surface: angles, aspects, edges, folds and faces that cut one another."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate, sphere
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.wear.mesh_faults import (
    Bounds,
    folded_faces,
    mesh_faults,
    tangle_message,
    with_target_edges,
)

EXACT = 1e-12  # relative: closed forms of single triangles


def test_sound_surfaces_have_no_faults():
    """Plate and sphere: no bad face; edges are at their own target."""
    for mesh in (flat_plate(0.06, 0.039, 0.003), sphere(0.01, 3)):
        faults = mesh_faults(with_target_edges(mesh))
        assert not faults.faces.any()
        assert len(faults.intersecting) == 0


def test_aspect_of_an_equilateral_triangle():
    """Longest edge over smallest altitude: 2 / sqrt 3 when equilateral, infinite without area."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0.5, np.sqrt(0.75), 0], [2, 0, 0.0]])
    for corners, aspect in (([0, 1, 2], 2.0 / np.sqrt(3.0)), ([0, 1, 3], np.inf)):
        faults = mesh_faults(SurfaceMesh(points, np.array([corners]), {}))
        assert faults.largest_aspect == pytest.approx(aspect, rel=EXACT)


def test_fold_of_two_faces():
    """Two faces at an edge fold when their normals differ by more than the bound; a face without area always."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 1, 0.1], [2, 0, 0.0]])
    folded = np.array([[0, 1, 2], [1, 0, 3]])  # the second lies back over the first
    assert folded_faces(points, folded, 165.0).all()
    points[3] = (0.0, -1.0, 0.1)
    assert not folded_faces(points, folded, 165.0).any()
    assert folded_faces(points, np.array([[0, 1, 4]]), 165.0).all()


def test_edges_against_their_target():
    """An edge beyond the bounds over the mean target of its ends makes its faces bad; kept boundary edges do not."""
    plate = flat_plate(0.02, 0.02, 0.004)
    assert mesh_faults(with_target_edges(plate, 0.02)).edges.sum() > 0
    assert not mesh_faults(with_target_edges(plate, 0.004)).edges.any()
    with pytest.raises(ValueError, match="allowed is a length above 0"):
        with_target_edges(plate, 0.0)


def test_holder_counts_only_when_tangled():
    """Acute faces of the holder are no fault."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, -0.05, 0.0]])
    mesh = SurfaceMesh(points, np.array([[0, 1, 2], [0, 3, 1]]), {"part": np.array([0, -1])})
    assert not mesh_faults(mesh).faces.any()
    worn = SurfaceMesh(points, mesh.triangles, {"part": np.array([0, 0])})
    assert mesh_faults(worn).acute.tolist() == [False, True]


def test_message_names_place_and_cause():
    """The phrase gives the faces, the place in mm and the count."""
    sheets = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0], [1, 1, -1], [1, 1, 2], [5, 5, 2.0]])  # mm
    mesh = SurfaceMesh(sheets * 1e-3, np.array([[0, 1, 2], [3, 4, 5]]))
    message = tangle_message(mesh, mesh_faults(mesh))
    assert message == "faces 0 and 1 of the worn surface cut one another at (1, 1, 0) mm; 2 such faces"


def test_bounds_out_of_range():
    """A bound no triangle can meet is refused with its name and range."""
    with pytest.raises(ValueError, match="smallest_angle_deg is 61, allowed is"):
        Bounds(smallest_angle_deg=61)
