"""How many triangles a sphere touches: distances from triangles, a flat grid, a regular polyhedron."""

import numpy as np
import pytest

from benchmarks.touched import distances, mean_touched_on_flat, touched

ABOVE = np.array([0.0, 0.0, 3.0])
RIGHT = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def grid(cells):
    """Right-angled triangles of edge 1 on cells x cells squares at z = 0, (2 cells^2, 3, 3)."""
    x, y = (place.ravel() for place in np.meshgrid(np.arange(cells), np.arange(cells)))
    lower = np.stack([np.column_stack([x + i, y + j]) for i, j in ((0, 0), (1, 0), (0, 1))], axis=1)
    upper = np.stack([np.column_stack([x + i, y + j]) for i, j in ((1, 1), (0, 1), (1, 0))], axis=1)
    flat = np.concatenate([lower, upper]).astype(float)
    return np.concatenate([flat, np.zeros((*flat.shape[:2], 1))], axis=2)


def test_distance_is_to_face_edge_or_corner():
    """Above the face, beside an edge, beyond a corner: 2, 5 of 3 and 4, sqrt(3)."""
    centres = np.array([[0.2, 0.2, 2.0], [0.5, -3.0, 4.0], [2.0, -1.0, 1.0], [-1.0, -1.0, -1.0]])
    found = distances(centres, np.broadcast_to(RIGHT, (4, 3, 3)))
    assert found == pytest.approx([2.0, 5.0, np.sqrt(3.0), np.sqrt(3.0)])


def test_a_sphere_in_a_corner_touches_all_that_meet_there():
    """Above a face's middle one triangle, above an edge's middle two, above a node six."""
    ends = np.array([[2.3, 2.3, 1.0], [2.5, 2.5, 1.0], [2.0, 2.0, 1.0]])
    meets, count = touched(ends + ABOVE, ends, 2.0, 1e-4, grid(5))
    assert meets.all() and list(count) == [1, 2, 6]


def test_what_passes_beside_is_not_counted():
    """A sphere that ends clear of the surface does not meet it."""
    ends = np.array([[2.3, 2.3, 1.0], [2.3, 2.3, 2.5]])
    meets, count = touched(ends + ABOVE, ends, 2.0, 1e-4, grid(5))
    assert list(meets) == [True, False] and list(count) == [1]


def test_on_a_flat_the_number_is_the_touched_disc_grown():
    """Triangles that a disc of radius r meets at random: (area + perimeter r + pi r^2) over the area; r^2 = 2 R d."""
    reach = 0.2
    radius, overlap = 2.0, 2.0 - np.sqrt(4.0 - reach**2)
    expected = (0.5 + (2.0 + np.sqrt(2.0)) * reach + np.pi * reach**2) / 0.5
    # 4000 places, whose number scatters by about one: standard error 0.016
    assert mean_touched_on_flat(radius, overlap, grid(8), 4000) == pytest.approx(expected, abs=0.06)
