"""The page of a screening's results, on tables of a study of two rows."""

import pandas as pd
import pytest
from workflows.report.figures import page_parameters

from tests.support.finished_runs import leave_runs
from workflows.cases.sliding_sample.screening.results import wear_text, write_results
from workflows.config.design import load_study
from workflows.report.markdown import durations

CONVEX, PLAIN = 1.5e-9, 2.0e-9  # m3 over 0.06 m of travel


@pytest.fixture
def study():
    return load_study("screening", overrides={"rows": ["R5", "R9"]})


@pytest.fixture
def folder(study, tmp_path):
    """A folder with what the page reads of two rows, all alike."""
    rows = [
        {
            "run": run.name,
            "row": run.row,
            "surface": run.surface,
            "travel_m": 0.06,
            "archard_volume_m3": CONVEX if run.surface == "convex" else PLAIN,
            "bump_archard_volume_m3": 0.5e-9 if run.surface == "convex" else 0.0,
            "mean_normal_force_N": 30.0 if run.surface == "convex" else 20.0,
            "archard_volume_per_metre_m3_per_m": (CONVEX if run.surface == "convex" else PLAIN) / 0.06,
            "wear_over_plain": CONVEX / PLAIN if run.surface == "convex" else 1.0,
        }
        for run in study.runs
    ]
    pd.DataFrame(rows).to_csv(tmp_path / "summary.csv", index=False)
    (tmp_path / "flow").mkdir()
    pd.DataFrame(
        [{"run": run.name, "regime": "continuous", "steady": True, "relative_velocity": 0.3} for run in study.runs]
    ).to_csv(tmp_path / "flow" / "regimes.csv", index=False)
    window = {
        "measure": "relative_gradient",
        "mean": 0.6,
        "steady": True,
        "published_mean": 0,
        "published_deviation": 0,
    }
    pd.DataFrame([{"run": r["run"], "row": r["row"], "surface": r["surface"], **window} for r in rows]).to_csv(
        tmp_path / "flow" / "steady.csv", index=False
    )
    (tmp_path / "findings").mkdir()
    finding = {
        "key": "k",
        "finding": "force up",
        "source": "S",
        "found": "2 of 2",
        "verdict": "confirmed",
        "reason": "",
    }
    pd.DataFrame([finding]).to_csv(tmp_path / "findings" / "findings.csv", index=False)
    beside = {"row": ["R5"], "published_regime": ["continuous"], "published_wear_over_plain": ["0.34"]}
    pd.DataFrame(beside).to_csv(tmp_path / "findings" / "runs.csv", index=False)
    leave_runs(study, tmp_path)
    return tmp_path


def test_a_row_stands_beside_its_plain_twin(study, folder):
    """Ratios of the two surfaces, wear in mm3 per metre, and the regime over the convex one."""
    lines = wear_text(folder, study).splitlines()
    assert lines[0].startswith("| row | particle scale | regime |")
    assert lines[2] == "| R5 | 1.25 | continuous | yes | 30 | 0.75 | 25 | 33.3 | 33.3 | 1.5 |"
    assert len(lines) == 4


def test_durations_stand_beside_their_forecast(study, folder):
    """Wall time is that of all starts, measured over forecast that of the processor."""
    said = durations(folder, page_parameters(study))
    assert "| worn run R5 convex | 1 000 | 6 000 | 2.5 | 1 | 0.833 | 1.2 |" in said.replace("\u202f", " ")
    assert "took 10 minutes of wall time, 20.0 % of it outside the solver" in said


def test_a_few_rows_make_a_page_without_a_regression(study, folder, tmp_path):
    """The page names its fidelity and its rows; what needs many rows is left out."""
    docs = tmp_path / "docs"
    docs.mkdir()
    write_results(folder, docs, study)
    text = (docs / "screening_results_quick.md").read_text(encoding="utf-8")
    assert text.startswith("# Screening at quick fidelity: results")
    assert "4 runs of 2 rows" in " ".join(text.split()) and "## Durations" in text
    assert "1 confirmed." in text and "force up" in text
    assert "## Regression" not in text and "![" not in text
