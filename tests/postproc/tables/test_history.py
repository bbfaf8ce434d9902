"""Wear and forces along the travel."""

import numpy as np
import pandas as pd
import pytest

from bulkwear.postproc.tables.history import (
    ROWS_PER_RUN,
    force_history,
    force_summary,
    wear_history,
    wear_within_cycles,
)
from bulkwear.workflows.cases.sliding_sample.evaluation import gradient_history

RELATIVE = 1e-12  # rounding of means over a thousand rows


@pytest.fixture
def design(tmp_path):
    """A design of one row, whose name is a number, with its plain twin."""
    path = tmp_path / "design.csv"
    path.write_text("run,row,setting,packing,surface\n1_convex,1,1,1,convex\n1_plain,1,1,1,plain\n")
    return path


def write_forces(folder, cycle, travel, normal):
    """forces.csv of a cycle with a constant drag of 2 N."""
    where = folder / f"cycle_{cycle:03d}"
    where.mkdir(parents=True)
    table = {"time_s": travel, "travel_m": travel, "force_x_N": 0.0, "force_y_N": 2.0, "force_z_N": -normal}
    pd.DataFrame(table).to_csv(where / "forces.csv", index=False)


def test_wear_starts_from_zero_and_keeps_units(design, tmp_path):
    """Each run's curve begins at no travel and no wear; m and m3 become mm and mm3; names stay text."""
    wear = pd.DataFrame(
        {
            "cycle": [1, 2],
            "travel_m": [0.01, 0.02],
            "total_worn_volume_m3": [1e-9, 3e-9],
            "total_applied_volume_m3": [1e-9, 2e-9],
            "carried_volume_m3": [0.0, 1e-9],
        }
    )
    wear.to_csv(tmp_path / "wear.csv", index=False)
    history = wear_history(design, [tmp_path / "wear.csv"] * 2)
    run = history[history["run"] == "1_convex"]
    np.testing.assert_allclose(run["travel_mm"], [0.0, 10.0, 20.0])
    np.testing.assert_allclose(run["worn_volume_mm3"], [0.0, 1.0, 3.0])
    np.testing.assert_allclose(run["worn_volume_mm3"], run["applied_volume_mm3"] + run["carried_volume_mm3"])
    assert set(history["row"]) == {"1"}


def test_wear_within_cycles_goes_on_over_them(design, tmp_path):
    """Stretches of travel of all cycles add up from zero, and their gradients are volumes over lengths (Eq 3.9)."""
    for cycle, volume in ((1, [4e-9, 2e-9]), (2, [1e-9, 1e-9])):
        where = tmp_path / "run" / f"cycle_{cycle:03d}"
        where.mkdir(parents=True)
        travel = 0.02 * (cycle - 1) + np.array([0.01, 0.02])
        parts = {"base_worn_volume_m3": 0.75 * np.array(volume), "pattern_worn_volume_m3": 0.25 * np.array(volume)}
        table = pd.DataFrame({"cycle": cycle, "travel_m": travel, "worn_volume_m3": volume, **parts})
        table.to_csv(where / "wear_history.csv", index=False)
    history = wear_within_cycles(design, [tmp_path / "run"] * 2)
    run = history[history["run"] == "1_convex"]
    np.testing.assert_allclose(run["travel_mm"], [0.0, 10.0, 20.0, 30.0, 40.0])
    np.testing.assert_allclose(run["worn_volume_mm3"], [0.0, 4.0, 6.0, 7.0, 8.0])
    np.testing.assert_allclose(run["pattern_worn_volume_mm3"], 0.25 * run["worn_volume_mm3"])
    gradient = gradient_history(history)
    np.testing.assert_allclose(gradient["gradient_mm3_per_mm"], [0.4, 0.2, 0.1, 0.1] * 2)


def test_a_run_without_wear_within_cycles_is_named(design, tmp_path):
    """A run whose cycles are missing is named."""
    with pytest.raises(FileNotFoundError, match=r"run: no cycle_\*/wear_history.csv found"):
        wear_within_cycles(design, [tmp_path / "run"] * 2)


def test_forces_keep_their_mean_and_count_down_as_positive(design, tmp_path):
    """Bunching rows keeps the mean force; pressure on the sample (force_z < 0) is a positive vertical force."""
    rows = 4 * ROWS_PER_RUN
    normal = np.random.default_rng(3).normal(5.0, 1.0, rows)
    travel = np.linspace(0.0, 1.0, rows)
    for run in ("1_convex", "1_plain"):
        write_forces(tmp_path / run, 1, travel[: rows // 2], normal[: rows // 2])
        write_forces(tmp_path / run, 2, travel[rows // 2 :], normal[rows // 2 :])
    table = force_history(design, [tmp_path / "1_convex", tmp_path / "1_plain"])
    run = table[table["run"] == "1_convex"]
    assert len(run) == ROWS_PER_RUN
    assert run["vertical_force_N"].mean() == pytest.approx(normal.mean(), rel=RELATIVE)
    assert run["travel_mm"].is_monotonic_increasing
    assert (table["drag_force_N"] == 2.0).all()
    summary = force_summary(table).set_index(["direction", "surface"])["mean_force_N"]
    assert summary["vertical"].to_numpy() == pytest.approx(normal.mean(), rel=RELATIVE)
    assert summary["drag"].to_numpy() == pytest.approx(2.0, rel=RELATIVE)


def test_missing_forces_are_named(design, tmp_path):
    """A run without forces.csv is named in the message."""
    with pytest.raises(FileNotFoundError, match="nothing"):
        force_history(design, [tmp_path / "nothing"] * 2)
