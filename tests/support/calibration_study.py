"""The study of a calibration with few simulations, and a formula in the solver's place."""

import math

from bulkwear.postproc.flow.bulk_test import RESPONSES, Measurement
from bulkwear.workflows.config.design import load_study
from tests import PUBLISHED

MEASURED, PAIRS = PUBLISHED / "gravel_tests.csv", PUBLISHED / "gravel_pairs.csv"
SLIDING, ROLLING = "particle.contact.sliding_friction", "particle.contact.rolling_friction"


def study(**overrides):
    """The calibration study with few simulations."""
    few = {"initial": {"shear_box": 5}, "most": {"shear_box": 7}, **overrides.pop("calibration", {})}
    return load_study("calibration", overrides={"fidelity": "quick", "calibration": few, **overrides})


def answers(tests, root, parallel, say):
    """Measurements of a formula in the solver's place: angles that grow with both frictions, a wall's with its own."""
    found = []
    for test in tests:
        contact = test["particle"]["contact"]
        angle = 24.0 + 30.0 * contact["sliding_friction"] + 12.0 * contact["rolling_friction"]
        if test["kind"] == "wall_shear":
            angle = math.degrees(math.atan(test["wall_material"]["contact"]["sliding_friction"]))
        names = RESPONSES[test["kind"]]
        found.append(Measurement(dict.fromkeys(names, angle), dict.fromkeys(names, 0.2), {name: [] for name in names}))
    return found
