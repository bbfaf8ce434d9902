"""What is left on faces of a part, at rims too."""

import numpy as np
import pytest

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.wear.thickness import LOST_THICKNESS, remaining_thickness, with_thickness
from bulkwear.workflows.cases.equipment.remaining import left_of_faces

THICK, BAND, WORN, GIVEN = 0.010, 0.001, 0.002, 0.004  # m; band: of the rim, square to the top
HALF, OVERHANG = 0.010, 0.002  # m, of the base; of the top, by which its rim stands out on each side
SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
NEXT = (1, 2, 3, 0)
FLAT = slice(0, 6)  # faces of top and base


def undercut_slab() -> SurfaceMesh:
    """A slab whose sides lean inward below the band of its rim; a node is in the middle of its top."""
    levels = ((HALF, 0.0), (HALF + OVERHANG, THICK - BAND), (HALF + OVERHANG, THICK))
    rings = [np.column_stack([half * SQUARE, np.full(4, z)]) for half, z in levels]
    fan = [(12, 8 + k, 8 + j) for k, j in enumerate(NEXT)]
    sides = [
        face
        for below in (0, 4)
        for k, j in enumerate(NEXT)
        for face in ((below + k, below + j, below + 4 + j), (below + k, below + 4 + j, below + 4 + k))
    ]
    points = np.vstack([*rings, [[0.0, 0.0, THICK]]])
    return SurfaceMesh(points, np.array([*fan, (0, 2, 1), (0, 3, 2), *sides]))


def test_a_face_at_a_rim_is_as_thick_as_it_was_built():
    """Rays from the rim pass the base, so that its nodes are as thick as the slab is wide: the top's faces are not."""
    pristine = undercut_slab()
    built = with_thickness(pristine)
    assert remaining_thickness(built)[8:12] == pytest.approx(np.full(4, 2.0 * (HALF + OVERHANG)))
    assert left_of_faces(built, pristine)[FLAT] == pytest.approx(np.full(6, THICK))
    lost = built.point_data | {LOST_THICKNESS: np.full(len(built.points), WORN)}
    worn = SurfaceMesh(built.points, built.triangles, built.cell_data, lost)
    assert left_of_faces(worn, pristine)[FLAT] == pytest.approx(np.full(6, THICK - WORN))
    assert left_of_faces(with_thickness(pristine, GIVEN), pristine) == pytest.approx(
        np.full(len(built.triangles), GIVEN)
    )
    assert np.isnan(left_of_faces(pristine, pristine)).all()
