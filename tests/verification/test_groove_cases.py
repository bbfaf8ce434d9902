"""What the grooves are made with, without a solver: the plain pressure, the coefficients, the starting height."""

import numpy as np
import pytest

from meshes.plate import flat_plate
from postproc.wear.patch import ContactPatch, spread
from tests.verification.groove_cases import (
    DEPTH,
    PASSES,
    pressure_disc,
    segment_area,
    spread_once,
    touching_height,
    wear_coefficients,
)
from tests.verification.ledger_cases import LOAD, RADIUS

PATCH = 0.35e-3  # m, contact radius
EDGE = PATCH / 12  # m
ROUNDING = 1e-12  # relative; sums over some hundred triangles
RESPONSE_ERROR = 0.03  # -, of 1; lattice and mesh
NOT_INVERTED = 0.01  # -, of 1; lattice and mesh where the response is next to nothing
LOWEST = 1.1  # wavelength over contact radius where the response of one spreading is lowest


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
