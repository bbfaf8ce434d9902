"""What a calibration found, and that other studies can use it."""

import numpy as np
import pandas as pd
import pytest
import yaml

from bulkwear.workflows.cases.calibration import figures
from bulkwear.workflows.cases.calibration.outcome import calibrated_materials
from bulkwear.workflows.cases.calibration.responses import RECOMMENDED, response_name
from bulkwear.workflows.config.design import ConfigError, load_study
from tests import REPOSITORY
from tests.support.calibration_study import ROLLING, SLIDING, study
from tests.support.charts import drawn_chart, values

AXES = {"first": SLIDING, "second": ROLLING}
OF_BINS = 0.03  # -, of the posterior: bins and points of the statements are apart by less


def test_statements_and_materials_of_a_calibration(done):
    """The materials file holds the recommended values and their provenance, and is a valid one for another study."""
    text = calibrated_materials(done, study().materials, "calibration")
    found = yaml.safe_load(text)["particles"]["river_gravel"]
    assert found["contact"]["sliding_friction"] == pytest.approx(done.pairs[RECOMMENDED][SLIDING], abs=1e-4)
    assert found["calibrated"]["rolling_radius"] == "full" and found["calibrated"]["shape"] == "sphere"
    assert "A wall shear test is: wall_friction_angle_deg" in found["calibrated"]["not_told"]
    statements = done.statements
    assert set(statements["inside"]) <= {"inside", "within its uncertainty", "outside"}
    at_published = statements.set_index("pair").loc["calibrated"]
    assert at_published["simulated"] == pytest.approx(24.0 + 30.0 * 0.21 + 12.0 * 0.4)


def test_the_family_that_is_drawn_is_the_one_that_statements_speak_of(done):
    """The pair that was compared lies as deep in the drawn regions, repeats among them, as the statements say."""
    said = done.statements.set_index("pair").loc[[done.compared], "denser_share"].iloc[0]
    away = np.hypot(*(done.family[f"{axis}_value"] - done.pairs[done.compared][name] for axis, name in AXES.items()))
    assert done.family["denser_share"][away.idxmin()] == pytest.approx(said, abs=OF_BINS)
    assert len(done.everything) > len(done.simulations)


def test_charts_show_pairs_beside_the_measured_band(done):
    """Each response in its unit: simulated and predicted values with their uncertainty, the measured one as a field."""
    said = done.statements
    found = drawn_chart(figures.pairs_against_bands.product, said)
    response = said["response"].iloc[0]
    rows = said[said["response"] == response]
    assert found["panels"][0]["layout"]["yaxis"]["title"]["text"] == response_name(response)
    assert values(found, "surrogate") == [pytest.approx(rows["predicted"], rel=1e-5)]
    band = [trace for trace in found["panels"][0]["data"] if trace.get("hoverinfo") == "skip"]
    ends = rows["measured"].iloc[0] + rows["measured_deviation"].iloc[0] * np.array([-1.0, -1.0, 1.0, 1.0])
    assert [each["y"] for each in band] == [pytest.approx(ends, rel=1e-5)]


def test_charts_of_boxes_and_looks():
    """Angles against both sizes beside the source's; the share at every look, and bars of information that lie."""
    sizes = pd.DataFrame({"row": ["a", "b"], "varied": ["length", "width"], "length_mm": [200.0, 100.0]})
    sizes = sizes.assign(width_mm=[50.0, 80.0], mean=[31.0, 32.0], deviation=[0.7, np.nan])
    before = pd.read_csv(REPOSITORY / figures.SIZES_BEFORE)
    found = drawn_chart(figures.box_sizes.product, sizes, before=before)
    assert values(found, "Yan 2022, Table 3.3") == [before["shear_angle_deg"].tolist()]
    assert [values(found, "width", panel, "x") for panel in range(2)] == [[[100.0]], [[80.0]]]
    looks = pd.DataFrame({"test": ["shear_box"] * 2, "simulations": [8, 10], "surrogate_share": [0.8, 0.4]})
    information = pd.DataFrame({"response": ["shear_angle_deg"], "information_bits": [0.5]})
    found = drawn_chart(figures.calibration_progress.product, pd.concat([looks, information]))
    assert values(found, "shear box") == [[0.8, 0.4]]
    assert values(found, "information", 1, "x") == [[0.5]]


def test_another_study_uses_the_calibrated_materials(done, tmp_path):
    """With the rolling model of the calibration another study takes the calibrated values; otherwise it is refused."""
    path = tmp_path / "materials.yaml"
    path.write_text(calibrated_materials(done, study().materials, "calibration"))
    with pytest.raises(ConfigError, match=r"solver\.rolling_friction is 'cdt', allowed is own_spin, in which"):
        load_study("demo", overrides={"materials": str(path), "solver": {"rolling_friction": "cdt"}})
    demo = load_study("demo", overrides={"materials": str(path)})
    contact = yaml.safe_load(path.read_text())["particles"]["river_gravel"]["contact"]
    assert demo.runs[0].parameters["particle"]["contact"] == contact
    assert "calibrated" not in demo.runs[0].parameters["particle"]
