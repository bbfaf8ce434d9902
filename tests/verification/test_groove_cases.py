"""What the grooves are made and measured with, without a solver: pressure, coefficients, height, sections."""

import numpy as np
import pytest
from scipy.optimize import brentq

from bulkwear.meshes.plate import flat_plate
from bulkwear.meshes.sample import sample_top
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.wear.patch import ContactPatch, spread
from bulkwear.workflows.cases.pin_on_disc.contours import AREA_SHARE
from tests.verification.groove_cases import (
    DEPTH,
    PASSES,
    mean_section,
    pressure_disc,
    section_profile,
    segment_area,
    spread_once,
    touching_height,
    wear_coefficients,
    width_of_area,
)
from tests.verification.ledger_cases import LOAD, RADIUS

PATCH = 0.35e-3  # m, contact radius
EDGE = PATCH / 12  # m
ROUNDING = 1e-12  # relative; sums over some hundred triangles
RESPONSE_ERROR = 0.03  # -, of 1; lattice and mesh
NOT_INVERTED = 0.01  # -, of 1; lattice and mesh where the response is next to nothing
LOWEST = 1.1  # wavelength over contact radius where the response of one spreading is lowest
HALF_WIDTH = 1.2e-3  # m, of the parabola, DEPTH deep
FINE = np.linspace(-2e-3, 2e-3, 4001)  # m
FINE_ERROR = 1e-5  # relative; 1200 intervals across the groove, second order
POLYGON_ERROR = 0.01  # relative; 24 straight edges across the parabola: 2/3 of (1/12)^2 of its area lie outside them


@pytest.fixture(scope="module")
def plate():
    """A fine flat plate, the triangle in its middle loaded in its centroid: (mesh, volume, patch)."""
    mesh = flat_plate(6 * PATCH, 6 * PATCH, EDGE)
    centroid = mesh.points[mesh.triangles].mean(axis=1)
    volume = np.zeros(len(mesh.triangles))
    volume[np.argmin((centroid**2).sum(axis=1))] = 1e-12
    return mesh, volume, ContactPatch(centroid, np.full(len(volume), PATCH))


@pytest.mark.parametrize("rings", [1, 2, 3, 10])
def test_plain_pressure_has_the_moments_of_hertz(rings):
    """Weights sum to 1, mean exactly in the centre, mean of r^2 = 2/5, all points inside the disc."""
    points, weights = pressure_disc(rings)
    assert weights.sum() == pytest.approx(1.0, rel=ROUNDING)
    assert np.abs(weights @ points).max() < ROUNDING
    assert weights @ (points**2).sum(axis=1) == pytest.approx(0.4, rel=ROUNDING)
    assert (points**2).sum(axis=1).max() < 1.0


@pytest.mark.parametrize("wavelength", [0.8, LOWEST, 1.4, 2.0, 4.0])
def test_plain_pressure_brings_waves_back_inverted(plate, wavelength):
    """A wave comes out of the Hertz pressure times h = 3 (sin q - q cos q) / q^3, q = 2 pi a / wavelength.

    Waves of about 1.1 a turn their sign; by the product's own patch none does.
    """
    mesh, volume, patch = plate
    x = mesh.points[mesh.triangles][:, :, 0] - patch.position[volume > 0.0][0, 0]
    q = 2.0 * np.pi / wavelength
    with spread_once():
        once = spread(mesh.points, mesh.triangles, volume, patch)
    product = spread(mesh.points, mesh.triangles, volume, patch)
    response, ours = ((corners * np.cos(q * x / PATCH)).sum() / volume.sum() for corners in (once, product))
    assert response == pytest.approx(3.0 * (np.sin(q) - q * np.cos(q)) / q**3, abs=RESPONSE_ERROR)
    assert ours > -NOT_INVERTED
    if wavelength == LOWEST:
        assert response < -0.05


def test_coefficients_add_up_to_the_groove():
    """All strokes at the plain load make a segment of the pin's circle, DEPTH deep; each later one stands for more."""
    coefficients = wear_coefficients()
    assert len(coefficients) == PASSES
    assert coefficients.sum() * LOAD == pytest.approx(segment_area(DEPTH), rel=ROUNDING)
    assert (np.diff(coefficients) > 0.0).all()
    half_circle = segment_area(RADIUS)
    assert half_circle == pytest.approx(0.5 * np.pi * RADIUS**2, rel=ROUNDING)


def test_pin_starts_where_it_touches(plate):
    """Over a flat plate the centre is one radius high, less by what lies between the points that are looked at."""
    height = touching_height(plate[0], 0.01e-3, -0.02e-3)
    assert RADIUS - EDGE**2 / (4.0 * RADIUS) < height <= RADIUS


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
