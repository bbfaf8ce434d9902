"""Pairs that a calibration found, simulated in tests that it did not use."""

import shutil

import pandas as pd
import pytest

from bulkwear.workflows.cases.calibration import checked_pairs
from bulkwear.workflows.cases.calibration.checked_pairs import asked_run, check_pair, checked_means
from bulkwear.workflows.cases.calibration.responses import RECOMMENDED
from bulkwear.workflows.config.layers import ConfigError
from tests.support.calibration_study import ROLLING, SLIDING, study


def test_a_found_pair_is_checked_in_another_test(done, formula, tmp_path):
    """A pair is simulated in a test that the calibration left out; asked again, no row stands twice."""
    run = study(calibration={"tests": ["draw_down"], "repeats": 2}, fidelity="standard").runs[0].parameters
    shutil.copy(done.folder / "repeats.csv", tmp_path)
    check_pair(run, RECOMMENDED, tmp_path, 1)
    table = check_pair(run, RECOMMENDED, tmp_path, 1)
    assert len(table) == 2 and (table["particle_scale"] == 4.0).all()
    assert table[SLIDING].iloc[0] == pytest.approx(done.pairs[RECOMMENDED][SLIDING])
    with pytest.raises(ValueError, match="no pair 'nobody', there are found_first, calibrated, recommended"):
        check_pair(run, "nobody", tmp_path, 1)


def test_a_test_without_a_measured_response_has_rows_and_no_means(done, formula, tmp_path):
    """Nothing stands beside its wall friction angle, so that later pages have rows and no band."""
    run = study().runs[0].parameters
    run = {**run, "calibration": {**run["calibration"], "tests": ["wall_shear"]}}
    shutil.copy(done.folder / "repeats.csv", tmp_path)
    table = check_pair(run, RECOMMENDED, tmp_path, 1)
    assert table["wall_friction_angle_deg"].notna().all() and checked_means(table, done.problem).empty


def test_a_test_that_the_study_does_not_have_is_checked_too():
    """At quick the study has a shear box alone: the slot of its draw-down test is too narrow for these particles."""
    with pytest.raises(ConfigError, match=r"draw_down\.opening_mm is 45.*five particle diameters"):
        asked_run("calibration", "quick", "draw_down", 2)
    with pytest.raises(ConfigError, match=r"calibration\.repeats is 0"):
        asked_run("calibration", "standard", "draw_down", 0)
    for test in ("draw_down", "wall_shear"):  # nothing was measured in the second one
        found = asked_run("calibration", "standard", test, 3)["calibration"]
        assert (found["tests"], found["repeats"]) == ([test], 3)


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (["--study", "nobody"], "study is 'nobody', allowed is one of"),
        (["--study", "demo"], "study demo: its case is sliding_sample, allowed is one of case calibration."),
        (["--seeds", "0"], "calibration.repeats is 0, allowed is a whole number from 1 to 100"),
        ([], "results/calibration/repeats.csv is missing, allowed is a study whose calibration is finished"),
    ],
)
def test_a_fault_ends_in_one_sentence(asked, words, tmp_path, monkeypatch):
    """Of the command line, the study, or a calibration that is not there: before, a traceback."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(checked_pairs, "work_here", lambda: None)
    monkeypatch.setattr("sys.argv", ["checked_pairs", *asked])
    with pytest.raises(SystemExit) as ended:
        checked_pairs.main()
    assert words in ended.value.code


def test_no_workers_are_refused(monkeypatch, capsys):
    """As an argument that is no number is."""
    monkeypatch.setattr("sys.argv", ["checked_pairs", "--workers", "0"])
    with pytest.raises(SystemExit):
        checked_pairs.main()
    assert "argument --workers: 0, allowed is a whole number from 1" in capsys.readouterr().err


def test_a_calibration_of_other_parameters_is_told(done, tmp_path):
    """Parameters that were added after the calibration stand in no column of its repeats."""
    run = study().runs[0].parameters
    asked = [*run["calibration"]["parameters"], {"name": "particle.contact.restitution", "low": 0.1, "high": 0.9}]
    shutil.copy(done.folder / "repeats.csv", tmp_path)
    with pytest.raises(
        ValueError, match=r"no column particle\.contact\.restitution, which calibration\.parameters has"
    ):
        check_pair({**run, "calibration": {**run["calibration"], "parameters": asked}}, RECOMMENDED, tmp_path, 1)


def test_only_packings_of_one_pair_and_test_are_averaged(done):
    """Rows of another value of the pair, or of another width, have means of their own: 35, 37 and 39."""
    marks = {"pair": RECOMMENDED, "test": "draw_down", "particle_scale": 4.0}
    rows = [(1, 43.0, 0.38, 35.0), (1, 60.0, 0.38, 37.0), (1, 60.0, 0.42, 39.0), (2, 60.0, 0.42, 39.0)]
    table = pd.DataFrame(rows, columns=["seed", "width_mm", SLIDING, "shear_angle_deg"]).assign(**marks)
    means = checked_means(table.assign(**{ROLLING: 0.2, "shear_angle_deg_uncertainty": 1.0}), done.problem)
    assert means[["seeds", "mean"]].to_numpy().tolist() == [[1, 35.0], [1, 37.0], [2, 39.0]]
    assert means["width_mm"].tolist() == [43.0, 60.0, 60.0]
