"""Cases of wear steps: each runs, and a digest of what they give tells the last bit."""

import numpy as np
import pytest

from benchmarks.wear_steps import BEFORE, CASES, earlier_version
from benchmarks.wear_steps_case import parts_of, run
from bulkwear.postproc.mesh import SurfaceMesh


@pytest.mark.parametrize("case", CASES)
def test_every_case_runs_and_gives_the_same_again(case):
    """Tiny sizes: processor time above 0, and something to compare that does not change."""
    (seconds, found), (_, again) = run(case, True), run(case, True)
    assert seconds > 0.0
    assert b"".join(parts_of(found)) == b"".join(parts_of(again)) != b""


def test_the_last_bit_counts():
    """A coordinate that is the next larger number, or a field of another name, gives other bytes."""
    points = np.eye(3)
    meshes = [SurfaceMesh(points, [[0, 1, 2]], {"part": np.zeros(1)}), SurfaceMesh(points, [[0, 1, 2]])]
    points = points.copy()
    points[0, 0] = np.nextafter(1.0, 2.0)
    meshes.append(SurfaceMesh(points, [[0, 1, 2]], {"part": np.zeros(1)}))
    assert len({b"".join(parts_of(mesh)) for mesh in meshes}) == 3


def test_a_version_that_is_there_is_taken_as_it_is(tmp_path):
    """Checked out before: nothing is asked of the repository."""
    (tmp_path / f"commit_{BEFORE}").mkdir()
    assert earlier_version(tmp_path) == tmp_path / f"commit_{BEFORE}"
