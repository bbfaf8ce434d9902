"""Sections of grooves against closed forms: a parabola, a segment of a circle, and a surface that is cut."""

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq
from workflows.cases.pin_on_disc.groove import (
    AREA_SHARE,
    largest_differences,
    mean_section,
    section_profile,
    stroke_table,
    width_of_area,
)

from meshes.plate import flat_plate
from meshes.sample import sample_top
from postproc.mesh import SurfaceMesh

HALF_WIDTH, DEPTH = 1.2e-3, 0.3e-3  # m, of the parabola
RADIUS = 3.0e-3  # m, of the circle
FINE = np.linspace(-2e-3, 2e-3, 4001)  # m
FINE_ERROR = 1e-5  # relative; 1200 intervals across the groove, second order
POLYGON_ERROR = 0.01  # relative; 24 straight edges across the parabola: 2/3 of (1/12)^2 of its area lie outside them


def parabola(x):
    """Depth (m) of the parabola at x (m)."""
    return DEPTH * np.maximum(1.0 - (x / HALF_WIDTH) ** 2, 0.0)


def parabola_width(share):
    """Width (m) of that share: u solves (3 u - u^3) / 2 = share, u in half-widths."""
    return 2.0 * HALF_WIDTH * brentq(lambda u: 0.5 * (3.0 * u - u**3) - share, 0.0, 1.0)


@pytest.mark.parametrize("share", [0.5, 0.9, AREA_SHARE])
def test_width_of_a_parabola(share):
    """The middle part of a parabola, by its cubic; shifting the groove changes nothing."""
    for shift in (0.0, 0.31e-3):
        assert width_of_area(FINE, parabola(FINE - shift), share) == pytest.approx(
            parabola_width(share), rel=FINE_ERROR
        )


def test_width_of_a_circular_segment():
    """The middle 95 % of a segment as a sphere leaves it: strips of 2 (sqrt(R^2 - x^2) - (R - d)) dx."""
    rim = np.sqrt(2.0 * RADIUS * DEPTH - DEPTH**2)

    def area(half):
        return 0.5 * (half * np.sqrt(RADIUS**2 - half**2) + RADIUS**2 * np.arcsin(half / RADIUS)) - half * (
            RADIUS - DEPTH
        )

    expected = 2.0 * brentq(lambda half: area(half) - AREA_SHARE * area(rim), 0.0, rim)
    depth = np.maximum(np.sqrt(np.maximum(RADIUS**2 - FINE**2, 0.0)) - (RADIUS - DEPTH), 0.0)
    assert width_of_area(FINE, depth) == pytest.approx(expected, rel=FINE_ERROR)


def test_a_tail_without_area_does_not_widen_the_groove():
    """What is not worn does not count: unworn plate on one side changes nothing."""
    wider = np.concatenate([FINE, [5e-3, 9e-3]])
    depth = parabola(wider)
    assert width_of_area(wider, depth) == pytest.approx(parabola_width(AREA_SHARE), rel=FINE_ERROR)


@pytest.mark.parametrize("share", [0.0, 1.0, -0.5, 1.5])
def test_shares_outside_their_range_are_refused(share):
    with pytest.raises(ValueError, match="share of the area"):
        width_of_area(FINE, parabola(FINE), share)


def test_a_section_without_area_is_refused():
    with pytest.raises(ValueError, match="no area"):
        width_of_area(FINE, np.zeros_like(FINE))


def grooved(mesh):
    """A mesh pressed down to the parabola, along y."""
    points = mesh.points.copy()
    points[:, 2] -= parabola(points[:, 0])
    return SurfaceMesh(points, mesh.triangles)


@pytest.mark.parametrize("y", [0.0, 0.137e-3, -0.2e-3])
def test_profile_of_a_cut_mesh_is_that_of_its_edges(y):
    """A plate of squares cut along a row of nodes or between two: the profile is linear between nodes, exactly."""
    size = 0.1e-3
    mesh = grooved(flat_plate(4e-3, 1e-3, size))
    nodes = np.unique(np.round(mesh.points[:, 0], 9))
    np.testing.assert_allclose(section_profile(mesh, y, nodes), parabola(nodes), atol=1e-12)
    between = 0.5 * (nodes[1:] + nodes[:-1])
    chord = 0.5 * (parabola(nodes[1:]) + parabola(nodes[:-1]))
    np.testing.assert_allclose(section_profile(mesh, y, between), chord, atol=0.02 * DEPTH)  # diagonals cut in between


def test_profile_does_not_ask_for_an_order_of_triangles():
    """Triangles in any order give the same section."""
    mesh = grooved(sample_top(4e-3, 2e-3, 0.1e-3, None))
    shuffled = np.random.default_rng(7).permutation(len(mesh.triangles))
    other = SurfaceMesh(mesh.points, mesh.triangles[shuffled])
    for y in (0.0, 0.21e-3):
        np.testing.assert_allclose(section_profile(other, y, FINE), section_profile(mesh, y, FINE), atol=1e-15)


def test_mean_section_of_a_parabolic_groove():
    """Depth, width and area (4/3 of half-width times depth) of an unstructured mesh, to the error of its edges."""
    section = mean_section(grooved(sample_top(4e-3, 2e-3, 0.1e-3, None)), np.linspace(-0.5e-3, 0.5e-3, 5))
    assert section["depth_m"] == pytest.approx(DEPTH, rel=POLYGON_ERROR)
    assert section["width_m"] == pytest.approx(parabola_width(AREA_SHARE), rel=POLYGON_ERROR)
    assert section["area_m2"] == pytest.approx(4.0 / 3.0 * HALF_WIDTH * DEPTH, rel=POLYGON_ERROR)


def test_a_plane_beside_the_surface_is_refused():
    with pytest.raises(ValueError, match="misses the surface"):
        section_profile(flat_plate(1e-3, 1e-3, 0.5e-3), 0.6e-3, FINE)


def two_grooves():
    """Strokes of one scheme on two meshes, and one stroke of the other scheme."""
    row = {
        "load_times_distance_J": 0.02,
        "law_volume_m3": 4e-10,
    }
    return pd.DataFrame(
        [
            {"scheme": scheme, "edges_per_width": edges, "stroke": stroke, "depth_m": depth, "width_m": 1e-3}
            | {"work_J": 0.02 * rise, "removed_volume_m3": removed, "carried_volume_m3": 1e-10}
            | row
            for scheme, edges, stroke, depth, rise, removed in (
                ("conserving", 5, 1, 10e-6, 1.0, 3e-10),
                ("conserving", 5, 2, 20e-6, 1.1, 3e-10),
                ("conserving", 10, 2, 25e-6, 1.1, 3e-10),
                ("per_triangle", 5, 1, 40e-6, 1.0, 20e-10),
            )
        ]
    )


def test_table_of_chosen_strokes():
    """Rows in the order asked for; volumes over the law's, work over F L, lengths in um and mm."""
    table = stroke_table(two_grooves(), [("conserving", 2), ("conserving", 1), ("per_triangle", 1)])
    assert list(zip(table["scheme"], table["strokes"], table["edges_per_width"], strict=True)) == [
        ("conserving", 2, 5),
        ("conserving", 2, 10),
        ("conserving", 1, 5),
        ("per_triangle", 1, 5),
    ]
    np.testing.assert_allclose(table["depth_um"], [20.0, 25.0, 10.0, 40.0])
    np.testing.assert_allclose(table["width_mm"], 1.0)
    np.testing.assert_allclose(table["removed_over_archard"], [0.75, 0.75, 0.75, 5.0])
    np.testing.assert_allclose(table["accounted_over_archard"], [1.0, 1.0, 1.0, 5.25])
    np.testing.assert_allclose(table["work_over_load_times_distance"], [1.1, 1.1, 1.0, 1.0])


def test_differences_between_meshes():
    """Largest over least minus 1 among the meshes of one scheme after the same number of strokes."""
    found = largest_differences(stroke_table(two_grooves(), [("conserving", 2), ("conserving", 1)])).set_index(
        "strokes"
    )
    assert found.loc[2, "depth_difference"] == pytest.approx(0.25)
    assert found.loc[1, "depth_difference"] == found.loc[2, "width_difference"] == 0.0
