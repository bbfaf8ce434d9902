"""What finished studies cost, from what their jobs left: share outside the solver, measured over forecast."""

import json

import pandas as pd
import pytest

from benchmarks import study_share
from benchmarks.study_share import UNTOLD, measures, study_row, study_rows
from bulkwear.workflows.engine.job import TOOK
from bulkwear.workflows.engine.records import write_record

HOUR = 3600.0


def write(path, **columns):
    path.parent.mkdir(parents=True, exist_ok=True)
    pd.DataFrame(columns).to_csv(path, index=False)


def sliding(results, fidelity=None):
    """A run of two cycles of half an hour and a bed of a quarter, tables of a quarter; forecast: 1.5 and 0.5 hours."""
    folder = results / "demo"
    sizes = {"particles": [10, 10], "steps": [5, 5]}
    write(
        folder / "R9_plain" / "cost.csv",
        solver_s=[0.5 * HOUR] * 2,
        processor_s=[0.3 * HOUR] * 2,
        other_s=[0.0] * 2,
        **sizes,
    )
    write(
        folder / "beds" / "bed_1" / "cost.csv",
        solver_s=[0.25 * HOUR],
        processor_s=[0.2 * HOUR],
        steps=[5],
        particles=[10],
    )
    (folder / "logs").mkdir()
    for job, seconds in (("worn_run_R9_plain", HOUR), ("settled_bed_bed_1", 0.25 * HOUR), ("summary", 0.25 * HOUR)):
        (folder / "logs" / f"{job}.benchmark.tsv").write_text(f"s\th:m:s\n{seconds}\t-\n")
    told = {"fidelity": [fidelity] * 3} if fidelity else {}
    write(
        folder / "forecast.csv",
        job=["worn_run_R9_plain", "settled_bed_bed_1", "worn_run_R9_convex"],
        solver_s=[1.5 * HOUR, 0.5 * HOUR, 7.0 * HOUR],
        by=["rates"] * 3,
        **told,
    )
    return folder


def test_packings_count_as_the_solvers(tmp_path):
    """A job of packings with containers of 0.3 and 0.1 hours of processor time, forecast as 0.5: 1.2 of 2.5 hours."""
    folder = sliding(tmp_path)
    sizes = {"particles": [10, 10], "steps": [5, 5]}
    hours = {"solver_s": [0.4 * HOUR, 0.2 * HOUR], "processor_s": [0.3 * HOUR, 0.1 * HOUR]}
    write(folder / "packings" / "solver_cost.csv", **hours, **sizes)
    forecast = pd.read_csv(folder / "forecast.csv")
    more = pd.DataFrame({"job": ["packing_profiles"], "solver_s": [0.5 * HOUR], "by": ["rates"]})
    pd.concat([more, forecast]).to_csv(folder / "forecast.csv", index=False)
    row = study_row(folder)
    assert row["solver_jobs"] == 3
    assert row["solver_core_hours"] == pytest.approx(1.2) and row["forecast_core_hours"] == pytest.approx(2.5)


def test_a_study_against_its_forecast(tmp_path):
    """1.25 of 1.5 hours of wall time are the solver's: a sixth is not. 0.8 core hours were forecast as 2; what was
    forecast and never ran counts on neither side.
    """
    row = study_row(sliding(tmp_path, "standard"))
    assert (row["study"], row["fidelity"], row["jobs"], row["solver_jobs"]) == ("demo", "standard", 3, 2)
    assert row["outside_solver_percent"] == pytest.approx(100.0 / 6.0) and row["by"] == "the clock"
    assert row["solver_core_hours"] == pytest.approx(0.8)
    assert row["forecast_core_hours"] == pytest.approx(2.0)
    assert row["measured_over_forecast"] == pytest.approx(0.4)


def took(folder, **jobs):
    """Logs of jobs that took so many s of processor time themselves, and their programs so many."""
    for job, times in jobs.items():
        (folder / "logs" / f"{job}.log").write_text(f"--- started\n{TOOK % times}\n")


def test_processor_times_of_jobs_come_before_the_clock(tmp_path):
    """Programs of what simulates are the solver, 30 and 60 s; of others, 4 s, they are not, as 1, 2 and 3 s of their
    own: 10 of 100. Two starts of a job add up; where one job tells nothing the clock counts.
    """
    folder = sliding(tmp_path)
    took(folder, worn_run_R9_plain=(1.0, 60.0), settled_bed_bed_1=(2.0, 30.0))
    assert study_row(folder)["by"] == "the clock"
    took(folder, summary=(3.0, 4.0))
    row = study_row(folder)
    assert row["outside_solver_percent"] == pytest.approx(10.0) and row["by"] == "processor time"
    log = folder / "logs" / "worn_run_R9_plain.log"
    log.write_text(log.read_text() + f"--- started\n{TOOK % (90.0, 10.0)}\n")
    assert study_row(folder)["outside_solver_percent"] == pytest.approx(50.0)


def test_a_run_that_was_stopped_tells_the_share_of_its_cycles(tmp_path):
    """Of wear cycles: 1 and 2 s of 100. Cycle 0, and folders that are begun, do not count."""
    for name, own in (("cycle_000", 50.0), ("cycle_001", 1.0), ("cycle_002", 2.0), ("cycle_003.part", 50.0)):
        place = tmp_path / "demo" / "R9_plain" / name
        place.mkdir(parents=True)
        number = int(name[6:9])
        cost = {"cycle": number, "solver_s": 99.0, "processor_s": 48.5, "other_processor_s": own}
        write_record(place / "state.json", {"cost": cost})
    (row,) = study_rows(tmp_path).to_dict("records")
    assert row["outside_cycles_percent"] == pytest.approx(3.0) and row["cycles"] == 2


def test_a_calibration_counts_all_its_simulations(tmp_path):
    """Wall time of the solver, 1 and 2 hours, over the forecast of its jobs together."""
    folder = tmp_path / "calibration"
    for number, hours in enumerate((1.0, 2.0)):
        place = folder / "simulations" / f"shear_box_{number}" / "cycle_000"
        place.mkdir(parents=True)
        cost = {"solver_s": hours * HOUR, "steps": 100, "particles": 50}
        (place / "state.json").write_text(json.dumps({"cost": cost}))
    write(folder / "forecast.csv", job=["calibrated_parameters", "box_sizes"], solver_s=[HOUR, HOUR], by=["rates"] * 2)
    row = study_row(folder)
    assert row["measured_over_forecast"] == pytest.approx(1.5) and row["fidelity"] == UNTOLD
    assert row["solver_core_hours"] == pytest.approx(3.0) and pd.isna(row["outside_solver_percent"])


def test_what_left_no_record_is_no_study(tmp_path):
    """Folders of other things, and studies whose solver has not run, have no line; without a forecast no ratio."""
    (tmp_path / "benchmarks").mkdir()
    assert study_rows(tmp_path).empty
    (sliding(tmp_path) / "forecast.csv").unlink()
    (row,) = study_rows(tmp_path).to_dict("records")
    assert pd.isna(row["measured_over_forecast"]) and row["fidelity"] == UNTOLD
    assert row["outside_solver_percent"] == pytest.approx(100.0 / 6.0)


def test_both_become_lines_of_the_table(tmp_path, monkeypatch):
    """A line for the share and one whose ratio is measured over forecast; no second one without a forecast."""
    monkeypatch.setattr(study_share, "RESULTS", tmp_path)
    folder = sliding(tmp_path, "quick")
    share, hours = measures(tmp_path, quick=True)
    assert share.name == "demo (quick), outside the solver" and share.value == pytest.approx(100.0 / 6.0)
    assert (hours.unit, hours.against) == ("core h", "its forecast") and hours.ratio == pytest.approx(0.4)
    (folder / "forecast.csv").unlink()
    assert len(measures(tmp_path, quick=True)) == 1
