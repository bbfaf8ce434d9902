"""What a calibration found, and that other studies can use it."""

import pytest
import yaml

from bulkwear.workflows.cases.calibration.outcome import calibrated_materials
from bulkwear.workflows.cases.calibration.responses import RECOMMENDED
from bulkwear.workflows.config.design import ConfigError, load_study
from tests.support.calibration_study import SLIDING, study


def test_statements_and_materials_of_a_calibration(done):
    """The materials file holds the recommended values and their provenance, and is a valid one for another study."""
    text = calibrated_materials(done, study().materials, "calibration")
    found = yaml.safe_load(text)["particles"]["river_gravel"]
    assert found["contact"]["sliding_friction"] == pytest.approx(done.pairs[RECOMMENDED][SLIDING], abs=1e-4)
    assert found["calibrated"]["rolling_radius"] == "full"
    assert "A wall shear test is: wall_friction_angle_deg" in found["calibrated"]["not_told"]
    statements = done.statements
    assert set(statements["inside"]) <= {"inside", "within its uncertainty", "outside"}
    at_published = statements.set_index("pair").loc["calibrated"]
    assert at_published["simulated"] == pytest.approx(24.0 + 30.0 * 0.21 + 12.0 * 0.4)


def test_another_study_uses_the_calibrated_materials(done, tmp_path):
    """With its rolling model set alike another study takes the calibrated values; otherwise it is refused."""
    path = tmp_path / "materials.yaml"
    path.write_text(calibrated_materials(done, study().materials, "calibration"))
    with pytest.raises(ConfigError, match=r"solver\.rolling_friction is 'cdt', allowed is epsd2, in which"):
        load_study("demo", overrides={"materials": str(path)})
    demo = load_study("demo", overrides={"materials": str(path), "solver": {"rolling_friction": "epsd2"}})
    contact = yaml.safe_load(path.read_text())["particles"]["river_gravel"]["contact"]
    assert demo.runs[0].parameters["particle"]["contact"] == contact
    assert "calibrated" not in demo.runs[0].parameters["particle"]
