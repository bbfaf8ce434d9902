"""The plane triangulation round prescribed nodes."""

import numpy as np
import pytest

from bulkwear.meshes.plane import mesh_plane, rectangle_rim
from bulkwear.postproc.mesh import area_vectors, boundary_edges

ROUNDING = 1e-12  # relative: sums of a few thousand float64 terms


def square_hole(centre, half):
    """Four corners of a square, anticlockwise."""
    return np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half + centre


def area(plane, triangles):
    """Signed area of plane triangles."""
    return area_vectors(np.column_stack([plane.points, 0 * plane.points[:, 0]]), triangles)[:, 2].sum()


def test_rim_nodes_are_even_and_anticlockwise():
    """The rim starts at the corner -x, -y, runs anticlockwise and has no edge above the element size."""
    rim = rectangle_rim(1.0, 0.5, 0.3)
    assert len(rim) == 2 * (4 + 2)
    assert rim[0].tolist() == [-0.5, -0.25]
    after = np.roll(rim, -1, axis=0)
    assert (rim[:, 0] * after[:, 1] - rim[:, 1] * after[:, 0]).sum() / 2 == pytest.approx(0.5, rel=ROUNDING)
    assert np.linalg.norm(after - rim, axis=1).max() <= 0.3


def test_prescribed_nodes_are_kept_bit_for_bit():
    """Nodes of rim and holes come first, unchanged, and together are the boundary of the base."""
    rim = rectangle_rim(1.0, 1.0, 0.1)
    holes = np.array([square_hole((0.2, 0.1), 1 / 30), square_hole((-0.2, -0.1), 1 / 30)])
    plane = mesh_plane(rim, holes, 0.1, frame_width=0.0)
    assert plane.points[: len(rim)].tobytes() == rim.tobytes()
    assert plane.points[len(rim) : len(rim) + 8].tobytes() == holes.tobytes()
    assert set(boundary_edges(plane.base).ravel().tolist()) == set(range(len(rim) + 8))
    assert len(boundary_edges(plane.base)) == len(rim) + 8
    assert area(plane, plane.base) == pytest.approx(1.0 - 2 * (2 / 30) ** 2, rel=ROUNDING)


def test_frame_surrounds_the_rim():
    """The frame shares the rim's edges, in the opposite sense, and has the area of a rectangular ring."""
    rim = rectangle_rim(1.0, 0.6, 0.1)
    plane = mesh_plane(rim, np.empty((0, 0, 2)), 0.1, frame_width=0.25)
    assert area(plane, plane.base) == pytest.approx(0.6, rel=ROUNDING)
    assert area(plane, plane.frame) == pytest.approx(1.5 * 1.1 - 0.6, rel=ROUNDING)
    inner = set(map(tuple, boundary_edges(plane.base).tolist()))
    outer = set(map(tuple, boundary_edges(plane.frame)[:, ::-1].tolist()))
    assert inner < outer


def test_base_coarsens_away_from_small_holes():
    """Finely divided holes do not refine the whole base: away from them the triangles keep their size."""
    rim = rectangle_rim(1.0, 1.0, 0.02)
    angle = 2 * np.pi * np.arange(40) / 40
    foot = 0.03 * np.column_stack([np.cos(angle), np.sin(angle)])
    centres = np.array([(x, y) for x in (-0.3, 0.0, 0.3) for y in (-0.3, 0.0, 0.3)])
    plane = mesh_plane(rim, centres[:, None] + foot, 0.02, frame_width=0.0)
    corners = np.column_stack([plane.points, 0 * plane.points[:, 0]])
    size = area_vectors(corners, plane.base)[:, 2]
    distance = np.linalg.norm(corners[plane.base].mean(axis=1)[:, None, :2] - centres, axis=2).min(axis=1)
    equilateral = np.sqrt(3) / 4
    assert size[distance > 0.1].mean() > 0.8 * equilateral * 0.02**2
    assert size[distance < 0.035].mean() < 2 * equilateral * 0.0047**2  # the foot's edges are 4.7 mm
