"""Estimated numbers of triangles against meshes."""

import math

import pytest

from bulkwear.meshes.disc import track_disc, track_stretch
from bulkwear.meshes.estimate import disc_triangles, sample_triangles, stretch_triangles
from bulkwear.meshes.pattern import ConvexPattern
from bulkwear.meshes.sample import sliding_sample

SAMPLE = 0.1  # relative; of the twenty-six samples of the screening within 7 %
DISC = 0.05  # relative; of the studies' discs within 1 %
STRETCH = 0.1  # relative; triangles count that only just reach in
SKIRTS = {"straight": (1e-4, math.radians(1.0), 0.0), "curved": (5e-5, math.radians(1.0), 0.41)}
PATTERNS = {
    "plain": None,
    "long bumps": ConvexPattern(8e-3, 2e-3, 6e-3, 40e-3, 20e-3),
    "flat bumps": ConvexPattern(8e-3, 8e-3, 1.5e-3, 40e-3, 20e-3),
    "round bumps": ConvexPattern(4e-3, 4e-3, 3e-3, 40e-3, 40e-3),
}


@pytest.mark.parametrize("pattern", PATTERNS)
@pytest.mark.parametrize(("element_size", "skirt"), [(1.5e-3, "straight"), (2e-3, "straight"), (1.5e-3, "curved")])
def test_samples(pattern, element_size, skirt):
    """Areas over the area of a triangle of the target edge; bumps, their finer elements and the skirt included."""
    given = (80e-3, 80e-3, element_size, PATTERNS[pattern], *SKIRTS[skirt])
    made = len(sliding_sample(*given).triangles)
    assert sample_triangles(*given) == pytest.approx(made, rel=SAMPLE)


@pytest.mark.parametrize("sizes", [(22e-3, 20e-3, 24e-3, 0.3e-3, 0.75e-3), (40e-3, 30e-3, 50e-3, 1e-3, 0.75e-3)])
def test_discs_and_their_stretches(sizes):
    """The integral of one over the triangles' area across the track, times its length."""
    mesh, arc = track_disc(*sizes), math.radians(40.0)
    assert disc_triangles(*sizes) == pytest.approx(len(mesh.triangles), rel=DISC)
    reach = 2.5 * sizes[3]
    chosen = len(track_stretch(mesh, sizes[0], 0.0, arc, reach))
    assert stretch_triangles(*sizes, arc, reach) == pytest.approx(chosen, rel=STRETCH)


def test_a_whole_turn_is_no_more_than_the_disc():
    """A stretch that reaches everywhere, all round, has as many triangles as the disc but for its rounded ends."""
    sizes = (22e-3, 20e-3, 24e-3, 0.3e-3, 0.75e-3)
    ends = 0.5 * math.pi * 2e-3 / (2.0 * math.pi * 22e-3)
    assert stretch_triangles(*sizes, 2.0 * math.pi, 2e-3) <= (1.0 + 1.2 * ends) * disc_triangles(*sizes)
