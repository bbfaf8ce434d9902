"""The wall shear test tells the friction of particles and plate: LIGGGHTS against the friction that it was given."""

import math

import pytest

from bulkwear.workflows.cases.calibration.boxes import test_of as bulk_test_of
from bulkwear.workflows.cases.calibration.simulations import simulate_all
from bulkwear.workflows.config.design import load_study

pytestmark = [pytest.mark.solver, pytest.mark.verify]

SEED = 20_000
SMALL = {"length_mm": 140, "fill_height_mm": 135}  # mm, ten particles of scale 5 long and high
BLOCKED = 0.3  # -, rolling friction of the wall with which its particles slide
SLIDING_ERROR = 1e-3  # relative: where all contacts slide along the drag the ratio of forces is the coefficient
LEAST_ROLLING = 0.6  # -, of the coefficient, where particles may roll: between neighbours that do not, most still slide


def measured(folder, friction, rolling, model="own_spin"):
    """Wall friction (-) of a bed on a plate with these coefficients, from the forces on the plate."""
    asked = {"fidelity": "quick", "wall_shear": SMALL, "solver": {"rolling_friction": model}}
    run = load_study("calibration", overrides=asked).all_runs[0].parameters
    wall = "wall_material.contact"
    values = {f"{wall}.sliding_friction": friction, f"{wall}.rolling_friction": rolling}
    (found,) = simulate_all([bulk_test_of(run, "wall_shear", values, SEED)], folder, 1, print)
    return math.tan(math.radians(found.responses["wall_friction_angle_deg"]))


@pytest.mark.parametrize("friction", [0.2, 0.38])
def test_particles_that_slide_show_the_friction_of_the_plate(tmp_path, friction):
    """Where rolling is resisted every contact slides, and shear over normal force is the coefficient."""
    assert measured(tmp_path, friction, BLOCKED) == pytest.approx(friction, rel=SLIDING_ERROR)


def test_particles_that_may_roll_show_less(tmp_path):
    """Without rolling friction on the plate some particles roll under epsd2: less than the coefficient, and yet most of
    it. Under own_spin the neighbours hold each particle's own spin, and all slide.
    """
    found = {model: measured(tmp_path / model, 0.38, 0.0, model) for model in ("epsd2", "own_spin")}
    assert LEAST_ROLLING * 0.38 < found["epsd2"] < (1.0 - SLIDING_ERROR) * 0.38
    assert found["own_spin"] == pytest.approx(0.38, rel=SLIDING_ERROR)
