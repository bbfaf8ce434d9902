"""Impacts of a sphere that sticks to a wall: how far the time step moves what each rolling model lets rebound."""

import numpy as np
import pytest

from bulkwear.workflows.engine.derived import rayleigh_time
from bulkwear.workflows.engine.solver import OWN_ROLLING_MODELS
from tests.support.rolling_spheres import (
    DENSITY,
    DUMP,
    HEAD,
    POISSONS_RATIO,
    RADII,
    SHEAR_MODULUS,
    WALLS,
    placed,
    simulated,
)

pytestmark = pytest.mark.solver

FALL, ALONG, FRICTION = 1.0, 0.2, 0.9  # m/s, m/s, -: sticks, as the slope of the impact is far below the friction
SECONDS = 4e-3  # s, several times what the impact takes
FINE, COARSE = 0.01, 0.2  # of the Rayleigh time
ALIKE = 0.03  # -: at a wall the three models are one law, which steps of FINE resolve; seen 0.32 and under cdt 0.31
STEADY = 0.1  # -: what a coarse step moves, as it begins and ends a contact late; seen 0.08
LOST = 0.2  # -, as much as cdt at the least loses at COARSE; seen 0.21


def rebound(folder, model, fraction):
    """Velocity of the surface along the wall after the impact over that before, backwards positive (-)."""
    radius = RADII[0]
    step = fraction * rayleigh_time(radius, DENSITY, SHEAR_MODULUS, POISSONS_RATIO)
    steps = round(SECONDS / step)
    deck = HEAD.format(model=model, step=step, friction=FRICTION, ranks=1)
    deck += placed([[0.0, 0.1, radius]], [radius], np.zeros((1, 3))) + f"velocity all set {ALONG} 0.0 -{FALL}\n"
    deck += WALLS["plane"].format(model=model) + f"fix motion all nve/sphere\n{DUMP.format(every=steps)}run {steps}\n"
    found = simulated(folder, deck)
    return -(found["vx"][-1, 0] - radius * found["spin"][-1, 0, 1]) / ALONG


def test_the_time_step_moves_what_cdt_lets_rebound(tmp_path):
    """Models that stop a spin within the step let it rebound at any; cdt, whose torque changes sides from step to step
    where the sphere sticks, does not.
    """
    fine, coarse = (
        {m: rebound(tmp_path / f"{m}_{step}", m, step) for m in (*OWN_ROLLING_MODELS, "cdt")} for step in (FINE, COARSE)
    )
    for model in OWN_ROLLING_MODELS:
        assert fine[model] == pytest.approx(fine["cdt"], abs=ALIKE)
        assert coarse[model] == pytest.approx(fine[model], abs=STEADY)
    assert coarse["cdt"] < fine["cdt"] - LOST
