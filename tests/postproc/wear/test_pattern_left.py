"""Volume of the bumps that is left."""

import numpy as np
import pytest

from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.sample import sample_top
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.wear.pattern_left import pattern_volume

MESH = 0.03  # relative; facets of 1 mm lie inside the ellipsoid
ROUNDING = 1e-9  # relative


def sample(spacing=40e-3):
    """A plate of 40 by 40 mm with bumps of a 8, b 2, h 6 mm every `spacing` (m)."""
    return sample_top(40e-3, 40e-3, 1e-3, ConvexPattern(8e-3, 2e-3, 6e-3, 40e-3, spacing, "along_travel", 0.5))


@pytest.mark.parametrize(("spacing", "count"), [(40e-3, 1), (10e-3, 3)])
def test_a_pristine_bump_is_half_an_ellipsoid(spacing, count):
    """Each bump has 2/3 pi a b h."""
    mesh = sample(spacing)
    assert mesh.cell_data["part"].max() == count
    assert pattern_volume(mesh) == pytest.approx(count * 2.0 / 3.0 * np.pi * 8e-3 * 2e-3 * 6e-3, rel=MESH)


def test_a_lower_base_and_a_flatter_bump():
    """Lowering the sample leaves the volume, halving all heights above the base halves it, a plain one has none."""
    mesh = sample()
    lowered = SurfaceMesh(mesh.points - [0.0, 0.0, 1e-3], mesh.triangles, mesh.cell_data, {})
    flatter = SurfaceMesh(mesh.points * [1.0, 1.0, 0.5], mesh.triangles, mesh.cell_data, {})
    plain = SurfaceMesh(mesh.points, mesh.triangles, {"part": np.zeros(len(mesh.triangles), dtype=np.int64)}, {})
    assert pattern_volume(lowered) == pytest.approx(pattern_volume(mesh), rel=ROUNDING)
    assert pattern_volume(flatter) == pytest.approx(0.5 * pattern_volume(mesh), rel=ROUNDING)
    assert pattern_volume(plain) == 0.0
