"""Archard's law knows no particle size: a pin of another radius at the same load wears alpha F L (Yan 2022, 4.3.2)."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bulkwear.meshes.disc import track_disc
from bulkwear.workflows.engine.derived import rayleigh_time
from tests.verification.ledger_cases import total
from tests.verification.pin_cases import PIN, RAYLEIGH_FRACTION, PinCase, arc, set_down

pytestmark = pytest.mark.solver

TRACK, INNER, OUTER, ELEMENT, BAND = 0.080, 0.060, 0.100, 1e-3, 2e-3  # m; section 4.3.2, the inner rim is ours
LOAD = 1.0  # N
MEDIAN_RADIUS = 1.325e-3  # m, of d50 = 2.65 mm: scale 1
DENSITY = 2460.0  # kg/m3, of scale 1; the mass is kept, as in the source
SPEED_UP = 20.0  # -, over the source's 180 degrees per second; Archard knows no speed
WORK = 1e-6  # -, of F L; the source says 6e-3. Measured: 3e-15
CYCLES = 4  # of a quarter turn


@pytest.fixture(scope="module")
def mesh():
    """The disc of 100 mm with elements of 1 mm round the track."""
    return track_disc(TRACK, INNER, OUTER, ELEMENT, BAND)


def pin_of_scale(scale: float) -> PinCase:
    """A pin `scale` times as large as the median particle, of the same mass, at its own share of the Rayleigh time."""
    radius, density = scale * MEDIAN_RADIUS, DENSITY / scale**3
    step = RAYLEIGH_FRACTION * rayleigh_time(radius, density, **PIN)
    case = PinCase(track_radius=TRACK, pin_radius=radius, density=density, load=LOAD, time_step=step)
    return replace(case, angular_velocity=SPEED_UP * case.angular_velocity).exact()


def worn_over_archard(folder, mesh, case: PinCase) -> float:
    """Work of one revolution over F L, -."""
    set_down(folder, case, mesh)
    cuts = np.linspace(0, case.steps_per_turn, CYCLES + 1).astype(int)
    work = sum(
        total(arc(folder, case, mesh, k, cuts[k - 1], cuts[k] - cuts[k - 1])[0], "sliding_work_J")
        for k in range(1, CYCLES + 1)
    )
    return work / (LOAD * 2.0 * math.pi * TRACK)


@pytest.mark.parametrize("scale", [1, *(pytest.param(scale, marks=pytest.mark.verify) for scale in (2, 4, 8))])
def test_every_scale_wears_load_times_distance(tmp_path, mesh, scale):
    """The same work at every scale: F L, where the source finds it within 0.6 %."""
    assert worn_over_archard(tmp_path, mesh, pin_of_scale(scale)) == pytest.approx(1.0, rel=WORK)
