"""A calibration by a formula, as its tables are left."""

import pytest

from bulkwear.workflows.cases.calibration import driver
from bulkwear.workflows.cases.calibration.outcome import read_calibrated
from tests.support.calibration_study import MEASURED, PAIRS, answers, study


@pytest.fixture
def formula(monkeypatch):
    """Lets a formula stand in for LIGGGHTS."""
    monkeypatch.setattr(driver, "simulate_all", answers)


@pytest.fixture(scope="package")
def done(tmp_path_factory):
    """A study's calibration by the formula, as read back from the tables that it wrote."""
    folder, run = tmp_path_factory.mktemp("calibration"), study().runs[0].parameters
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(driver, "simulate_all", answers)
        tables = driver.run_calibration(run, MEASURED, PAIRS, folder, 1)
        sizes = driver.run_box_sizes({run.name: run.parameters for run in study().runs}, PAIRS, folder, 1)
    for name, table in zip(("simulations", "looks", "repeats", "box_sizes"), (*tables, sizes), strict=True):
        table.to_csv(folder / f"{name}.csv", index=False)
    return read_calibrated(run, MEASURED, PAIRS, folder)
