"""Plain bodies against closed forms."""

import math

import numpy as np
import pytest

from bulkwear.meshes.plate import closed_box, flat_plate, sphere
from bulkwear.postproc.mesh import (
    area_vectors,
    areas,
    boundary_edges,
    enclosed_volume,
    nonmanifold_edges,
    smallest_angles,
)

ROUNDING = 1e-12  # relative: sums of a few thousand float64 terms


def test_plate_area_normals_and_edges():
    """Area width x length, normals up, no leg longer than the element size, also when it does not divide."""
    plate = flat_plate(1.0, 2.0, 0.3)
    vectors = area_vectors(plate.points, plate.triangles)
    assert vectors.sum(axis=0) == pytest.approx([0, 0, 2.0], rel=ROUNDING)
    assert vectors[:, 2].min() > 0
    legs = np.diff(np.unique(plate.points[:, 0])), np.diff(np.unique(plate.points[:, 1]))
    assert max(legs[0].max(), legs[1].max()) <= 0.3
    assert smallest_angles(plate.points, plate.triangles).min() > 40  # 41.2 degrees for cells of 0.25 by 0.286
    assert nonmanifold_edges(plate.triangles).size == 0


def test_diagonals_balance():
    """With an even number of cells the chessboard of diagonals prefers no direction."""
    plate = flat_plate(1.0, 1.0, 0.25)
    direction = plate.points[plate.triangles] - plate.points[np.roll(plate.triangles, 1, axis=1)]
    diagonals = direction[(direction[..., 0] != 0) & (direction[..., 1] != 0)]
    assert (diagonals[:, 0] * diagonals[:, 1]).sum() == pytest.approx(0.0, abs=ROUNDING)


@pytest.mark.parametrize("subdivisions", [2, 3])
def test_sphere_converges_with_the_square_of_the_edge(subdivisions):
    """Inscribed sphere: volume below 4/3 pi r3, error falling fourfold when the edges are halved."""
    exact = 4 / 3 * math.pi * 0.5**3

    def error(level):
        ball = sphere(0.5, level)
        assert boundary_edges(ball.triangles).size == 0
        return exact - enclosed_volume(ball.points, ball.triangles)

    ratio = error(subdivisions) / error(subdivisions + 1)
    assert 3.8 < ratio < 4.2  # second order; higher terms stay below 5 % from the second subdivision


def test_box():
    """A closed box: exact volume and surface, watertight, standing on z = 0."""
    box = closed_box(1.0, 2.0, 3.0, 0.7)
    assert enclosed_volume(box.points, box.triangles) == pytest.approx(6.0, rel=ROUNDING)
    assert areas(box.points, box.triangles).sum() == pytest.approx(22.0, rel=ROUNDING)
    assert boundary_edges(box.triangles).size == nonmanifold_edges(box.triangles).size == 0
    assert box.points[:, 2].min() == 0.0


def test_labels_are_base():
    """Every triangle of a plain body belongs to the base, in int64."""
    for surface in (flat_plate(1.0, 1.0, 0.5), sphere(1.0, 1), closed_box(1.0, 1.0, 1.0, 0.5)):
        assert surface.cell_data.keys() == {"part", "column", "row"}
        for label in surface.cell_data.values():
            assert label.dtype == np.int64
            assert (label == 0).all()


@pytest.mark.parametrize("width, length, element_size", [(0, 1, 1), (1, -1, 1), (1, 1, float("nan"))])
def test_senseless_plates_are_refused(width, length, element_size):
    """Lengths must be positive numbers."""
    with pytest.raises(ValueError, match="must be greater than 0 m"):
        flat_plate(width, length, element_size)
