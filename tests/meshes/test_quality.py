"""Quality figures of a mesh whose angles are known."""

import numpy as np
import pytest

from bulkwear.meshes.plate import flat_plate
from bulkwear.meshes.quality import quality, quality_table
from bulkwear.postproc.mesh import SurfaceMesh


def test_squares_have_angles_of_45_degrees():
    """Square cells: smallest angles 45 degrees, NaN for parts that do not occur, shortest edge the side."""
    numbers = quality(flat_plate(1.0, 1.0, 0.25))
    assert numbers["triangles"] == 32
    assert numbers["bumps"] == numbers["on_bumps"] == 0
    assert numbers["shortest_edge_m"] == pytest.approx(0.25)
    assert numbers["base_smallest_deg"] == pytest.approx(45.0)
    assert np.isnan(numbers["skirt_smallest_deg"])


def test_parts_are_told_apart():
    """A worse triangle on a bump shows in the bump's figures and not in the base's."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0.1, 0]])
    mesh = SurfaceMesh(points, np.array([[0, 1, 2], [0, 1, 3]]), {"part": np.array([0, 1])})
    numbers = quality(mesh)
    assert numbers["base_smallest_deg"] == pytest.approx(45.0)
    assert numbers["bump_smallest_deg"] == pytest.approx(np.degrees(np.arctan(0.1)))
    assert quality_table([("two", mesh)]).splitlines()[-1] == "| two | 1 | 2 | 1 | 45 / 45 | 6 / 6 | nan / nan |"
