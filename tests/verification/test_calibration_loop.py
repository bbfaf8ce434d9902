"""A calibration with LIGGGHTS in the loop finds the friction that its responses were simulated with."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.inference.loop import packing_seed
from bulkwear.postproc.inference.posterior import densest, interval
from bulkwear.workflows.cases.calibration.boxes import test_of as bulk_test_of
from bulkwear.workflows.cases.calibration.driver import compared_pairs, read_posterior, run_calibration
from bulkwear.workflows.cases.calibration.responses import FOUND_FIRST
from bulkwear.workflows.cases.calibration.simulations import simulate_all
from bulkwear.workflows.config.design import load_study
from tests import PUBLISHED

pytestmark = [pytest.mark.solver, pytest.mark.verify]

HIDDEN = {"particle.contact.sliding_friction": 0.3, "particle.contact.rolling_friction": 0.35}
SEEDS = [packing_seed(31_000, number) for number in range(4)]  # of the packings that stand for the laboratory's
REPEATED_PAIRS = 3  # found first, compared and recommended
STATED_SHARE = 0.95  # of the posterior, in the region and in the intervals that must hold the hidden pair
WORKERS = 2


def test_hidden_friction_is_found_by_the_solver(tmp_path):
    """The mean shear angle of four packings with hidden friction leads back to it, within the simulations allowed."""
    run = load_study("calibration", overrides={"fidelity": "quick", "calibration": {"repeats": 2}}).runs[0].parameters
    laboratory = [bulk_test_of(run, "shear_box", HIDDEN, seed) for seed in SEEDS]
    found = simulate_all(laboratory, tmp_path / "laboratory", WORKERS, print)
    angles = [each.responses["shear_angle_deg"] for each in found]
    deviation = np.std(angles, ddof=1) / np.sqrt(len(angles))
    row = {
        "response": "shear_angle_deg",
        "value": np.mean(angles),
        "deviation": max(deviation, 0.4),
        "source": "hidden",
    }
    pd.DataFrame([row]).to_csv(tmp_path / "measured.csv", index=False)
    pairs = PUBLISHED / "gravel_pairs.csv"
    simulations, _, repeats = run_calibration(run, tmp_path / "measured.csv", pairs, tmp_path, WORKERS)
    asked = run["calibration"]
    assert len(simulations) <= asked["most"]["shear_box"] and len(repeats) <= asked["repeats"] * REPEATED_PAIRS
    for name, table in (("simulations", simulations), ("repeats", repeats)):
        table.to_csv(tmp_path / f"{name}.csv", index=False)
    files = (tmp_path / f"{name}.csv" for name in ("measured", "simulations", "repeats"))
    problem, _, known = read_posterior(run, *files)
    values = problem.from_unit(known.points)
    nearest = int(np.argmin(np.linalg.norm(values - np.array(list(HIDDEN.values())), axis=1)))
    assert densest(known.weights, STATED_SHARE)[nearest]
    for column, hidden in enumerate(HIDDEN.values()):
        low, high = interval(values[:, column], known.weights)
        assert low < hidden < high
    compared = compared_pairs(problem, known, run, pd.read_csv(pairs))
    assert set(repeats["pair"]) == {FOUND_FIRST, *compared} and len(set(repeats["pair"])) == REPEATED_PAIRS
