"""Clumps: volume, centre of mass and inertia of spheres that overlap, by closed forms of spheres and lenses."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bulkwear.postproc.clump import union_moments, unit_clump

QUADRATURE = 3e-4  # relative; points on the edge of an overlap count wholly or not at all. Measured: 1.1e-4
ROUNDING = 1e-9  # relative; whole spheres are integrated exactly but for rounding
RADIUS, HALF = 1.3, 0.7  # any unit: of two equal spheres, and half the distance of their centres
TURNS = list(Rotation.random(4, rng=20220317))


def caps_cut_off():
    """Volume, and integrals of z^2 and x^2 over two spheres at -HALF and HALF on z, of which each ends at z = 0.

    A disc at height z on the upper sphere has radius^2 s = R^2 - (z - a)^2: dV = pi s dz, and its x^2 is pi s^2/4 dz.
    """
    z = np.polynomial.Polynomial([0.0, 1.0])
    section = RADIUS**2 - (z - HALF) ** 2
    over = [np.pi * section, np.pi * section * z**2, np.pi / 4.0 * section**2]
    return [2.0 * (each.integ()(HALF + RADIUS) - each.integ()(0.0)) for each in over]


def test_single_sphere():
    """4/3 pi R^3, its centre, and R^2/5 of its volume about its centre."""
    middle = np.array([0.4, -1.0, 2.0])
    volume, first, second = union_moments(middle[None], np.array([RADIUS]))
    assert volume == pytest.approx(4.0 / 3.0 * np.pi * RADIUS**3, rel=QUADRATURE)
    assert first / volume == pytest.approx(middle, rel=QUADRATURE)
    about = second / volume - np.outer(middle, middle)
    assert about == pytest.approx(RADIUS**2 / 5.0 * np.eye(3), abs=QUADRATURE * np.sum(middle**2))


@pytest.mark.parametrize("turn", TURNS, ids=range(len(TURNS)))
def test_two_overlapping_spheres(turn):
    """The union of two spheres, however it is turned, has the volume and moments of two spheres cut by their plane."""
    centres = turn.apply([[0.0, 0.0, HALF], [0.0, 0.0, -HALF]])
    volume, first, second = union_moments(centres, np.full(2, RADIUS))
    expected, along, across = caps_cut_off()
    assert volume == pytest.approx(expected, rel=QUADRATURE)
    assert first / volume == pytest.approx(np.zeros(3), abs=QUADRATURE * RADIUS)
    upright = turn.inv().as_matrix() @ second @ turn.as_matrix()
    assert upright == pytest.approx(np.diag([across, across, along]), abs=QUADRATURE * along)


def test_spheres_that_only_touch_are_added():
    """Two spheres of different size: volumes, and the centre of mass by their volumes."""
    centres, radii = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]]), np.array([1.0, 2.0])
    volume, first, _ = union_moments(centres, radii)
    assert volume == pytest.approx(4.0 / 3.0 * np.pi * 9.0, rel=QUADRATURE)
    assert first[0] / volume == pytest.approx(3.0 * 8.0 / 9.0, rel=QUADRATURE)


@pytest.mark.parametrize("unit", [1.0, 1e-3])
def test_unit_clump_has_the_volume_of_a_sphere_of_diameter_one(unit):
    """In whatever unit and place a clump is given: its equivalent diameter is 1, its centre of mass the origin."""
    centres = np.array([[0.0, 0.0, 0.0], [1.0, 0.2, 0.0], [0.1, 0.8, 0.6]])
    clump = unit_clump(unit * (centres + 5.0), unit * np.array([1.0, 0.8, 0.6]))
    volume, first, second = union_moments(clump.centres, clump.radii)
    assert volume == pytest.approx(np.pi / 6.0, rel=QUADRATURE)
    assert first == pytest.approx(np.zeros(3), abs=QUADRATURE)
    inertia = (np.trace(second) * np.eye(3) - second) / volume
    assert clump.inertia == pytest.approx(inertia, abs=QUADRATURE)
    assert np.linalg.eigvalsh(clump.inertia).min() > 0.0


def test_inertia_of_a_sphere_and_reach():
    """One sphere: 2/5 m R^2 is a tenth of m d^2, and it reaches half its diameter."""
    clump = unit_clump(np.array([[2.0, 0.0, 0.0]]), np.array([5.0]))
    assert clump.inertia == pytest.approx(0.1 * np.eye(3), rel=QUADRATURE, abs=ROUNDING)
    assert clump.reach == pytest.approx(0.5, rel=QUADRATURE)
