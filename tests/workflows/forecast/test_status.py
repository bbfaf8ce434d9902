"""What is told of a study that runs: states of its jobs by the files they leave, time left of each and of all."""

import os
import time

import pandas as pd
import pytest

from bulkwear.__main__ import main
from bulkwear.workflows.cases.calibration.boxes import SIMULATIONS
from bulkwear.workflows.cases.calibration.case import Calibration
from bulkwear.workflows.cases.sliding_sample.particle_size.packings import JOB as PACKING_PROFILES
from bulkwear.workflows.engine.job import Progress, duration_text, project_job, seconds_of
from bulkwear.workflows.engine.records import write_record
from bulkwear.workflows.engine.solver import SolverError
from bulkwear.workflows.engine.state import only_driver
from bulkwear.workflows.forecast import status as module
from bulkwear.workflows.forecast.job_states import DONE, FAILED, RUNNING, STOPPED, WAITING, job_state, locked_files
from bulkwear.workflows.forecast.status import MOST_IDLE, last_line, read_status, status_text, watch

HOURS = {"settled_bed_bed_1": 0.5, "worn_run_a": 1.0, "worn_run_b": 2.0, "worn_run_c": 1.0, "worn_run_d": 1.0}
SLOWER = 3.0  # -, than forecast
CYCLES = 4
VOLUME = 2e-9  # m3, of each cycle
LATER = 7200.0  # s after all was written: no log is recent then
TOLERANCE = 2.0  # s, rounding of what is said and the time that the test takes


def finish_cycles(folder, count):
    """Leave cycle 0 and so many wear cycles of a run."""
    for cycle in range(count + 1):
        (folder / f"cycle_{cycle:03d}").mkdir(parents=True)
        wear = {"wear": {"total_worn_volume_m3": VOLUME * cycle}} if cycle else {}
        write_record(folder / f"cycle_{cycle:03d}" / "state.json", wear)


@pytest.fixture
def results(tmp_path):
    """results/ with a study: a bed that is done, a run whose cycles end, one that waits, a failed and a stopped one."""
    folder = tmp_path / "results" / "demo"
    (folder / "logs").mkdir(parents=True)
    table = {"job": HOURS.keys(), "wall_h": HOURS.values(), "cores": 1, "cycles": [0, *[CYCLES] * 4]}
    needs = ["", *["settled_bed_bed_1"] * 4]
    pd.DataFrame(table).assign(needs=needs, fidelity="quick").to_csv(folder / "forecast.csv", index=False)
    bed = folder / "beds" / "bed_1"
    bed.mkdir(parents=True)
    (bed / "bed.restart").touch()
    (bed / "cost.csv").write_text(f"solver_s,steps\n{SLOWER * 3600.0 * HOURS['settled_bed_bed_1']},1\n")
    finish_cycles(folder / "a", 2)
    finish_cycles(folder / "d", 1)
    now = [0.0]
    with project_job(folder / "logs" / "worn_run_a.log"):
        progress = Progress("a", 100, clock=lambda: now[0])
        now[0] = 3000.0
        progress.update(50, "cycle 3 of 4")
    with pytest.raises(SystemExit), project_job(folder / "logs" / "worn_run_c.log"):
        raise SolverError("LIGGGHTS stopped: lost atoms.")
    with pytest.raises(SystemExit), project_job(folder / "logs" / "worn_run_d.log"):
        raise KeyboardInterrupt
    return tmp_path / "results"


@pytest.fixture
def running(results):
    """The same, while the lock of run a is held."""
    with only_driver(results / "demo" / "a", print):
        yield results


def test_files_tell_the_state_of_a_job(running):
    """Done by what it made, running by its lock, failed and stopped by its log; nothing is touched."""
    found = {job.name: job for job in read_status("demo", results=running).jobs}
    assert {name: job.state for name, job in found.items()} == {
        "bed_1": DONE,
        "a": RUNNING,
        "b": WAITING,
        "c": FAILED,
        "d": STOPPED,
    }
    assert (found["a"].cycles, found["b"].cycles, found["d"].cycles) == (2, None, 1)
    assert found["a"].worn_m3 == pytest.approx(2 * VOLUME)
    assert found["a"].left_s == pytest.approx(3000.0, abs=TOLERANCE)
    assert found["c"].said == "LIGGGHTS stopped: lost atoms."


def test_a_job_without_its_process_is_stopped(results):
    """Its lock is free: on another machine it may run as long as its log changes."""
    folder = results / "demo"
    assert job_state(folder, "worn_run_a", locked_files()).state == RUNNING
    assert job_state(folder, "worn_run_a", locked_files(), time.time() + LATER).state == STOPPED


@pytest.mark.parametrize(
    ("job", "within"),
    [*((rule, SIMULATIONS) for rule in Calibration.solver_rules), (PACKING_PROFILES, "packings")],
)
def test_a_job_of_bulk_tests_runs_as_long_as_one_of_them_does(results, job, within):
    """Its own log says nothing until a test ends, a quarter of an hour later; their solvers' logs do."""
    folder, later = results / "demo", time.time() + LATER
    with project_job(folder / "logs" / f"{job}.log"):
        pass
    assert job_state(folder, job, set(), later).state == STOPPED
    log = folder / within / "draw_down_0" / "cycle_000.part" / "log.liggghts"
    log.parent.mkdir(parents=True)
    log.touch()
    os.utime(log, (later, later))
    assert job_state(folder, job, set(), later).state == RUNNING
    assert job_state(folder, job, set(), later + LATER).state == STOPPED


def test_the_last_start_counts(results):
    """A run that failed and was started again has not failed."""
    with project_job(results / "demo" / "logs" / "worn_run_c.log"):
        pass
    assert job_state(results / "demo", "worn_run_c", set(), time.time() + LATER).state == STOPPED


def test_time_left_of_the_whole_study(running):
    """A bed took three times its forecast, so will what waits, less its finished cycles; what runs goes by its word."""
    found = read_status("demo", results=running)
    waiting = SLOWER * (HOURS["worn_run_b"] + HOURS["worn_run_c"] + HOURS["worn_run_d"] * (1.0 - 1.0 / CYCLES))
    pace_of_a = 3000.0 / 3600.0  # what it has to go, and so far it has taken no time
    pace = (SLOWER * HOURS["settled_bed_bed_1"] + pace_of_a) / (HOURS["settled_bed_bed_1"] + HOURS["worn_run_a"])
    expected = pace_of_a + pace / SLOWER * waiting
    assert found.cores == 1
    assert found.whole_h == pytest.approx(expected, abs=5 * TOLERANCE / 3600.0)
    two = read_status("demo", 2, running)
    assert two.whole_h < found.whole_h


def test_the_table_and_the_last_line(running):
    """A row per job; then why one failed, with its log; then the whole, and where the page will be."""
    text = status_text(read_status("demo", results=running))
    rows = {line.split()[0]: line.split() for line in text.splitlines() if line.startswith(("bed", "a ", "b ", "d "))}
    assert rows["bed_1"] == ["bed_1", "done"]
    assert rows["a"][:8] == ["a", "running", "3", "of", "4", "4", "mm³", "about"]
    assert rows["b"][:3] == ["b", "waiting", "about"]
    assert rows["d"][:5] == ["d", "stopped", "1", "of", "4"]
    *_, fault, last = text.splitlines()
    assert fault == f"c failed: LIGGGHTS stopped: lost atoms. ({running / 'demo/logs/worn_run_c.log'})"
    assert last.startswith("demo: 1 of 5 jobs of the solver done, about ")
    assert last.endswith(f" left on 1 core, then tables, figures and the page {running / 'demo/report.html'}")


def test_the_last_line_at_the_end(results):
    """Jobs that are done leave the page, which is there once it is newer than they are."""
    folder = results / "demo"
    for run in "abcd":
        (folder / run).mkdir(exist_ok=True)
        (folder / run / "wear.csv").touch()
        (folder / run / "cost.csv").write_text("solver_s,other_s\n1.0,1.0\n")
    found = read_status("demo", results=results)
    assert last_line(found).endswith(f"done; tables, figures and the page {folder / 'report.html'} follow")
    (folder / "report.html").touch()
    assert last_line(found).endswith(f"done; its page is {folder / 'report.html'}")
    os.utime(folder / "report.html", (1.0, 1.0))
    assert last_line(found).endswith("follow")


def test_a_watch_ends(results, monkeypatch):
    """After some looks at which nothing runs, the last of which knows that it is; it waits between them."""
    monkeypatch.chdir(results.parent)
    monkeypatch.setattr(module, "locked_files", set)
    old = time.time() - LATER
    for path in (results / "demo" / "logs").iterdir():
        os.utime(path, (old, old))
    looks, waits = [], []
    said = watch("demo", None, lambda status, goes_on: looks.append(goes_on), lambda: waits.append(1))
    assert looks == [True] * (MOST_IDLE - 1) + [False]
    assert len(waits) == MOST_IDLE - 1
    assert "none runs now; `snakemake demo` goes on" in said


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nonsense"], "status: study is 'nonsense', allowed is one of "),
        (
            ["demo"],
            "results/demo/forecast.csv: there is no such file, nothing of it was started here; `snak",
        ),
        ([], "results: no study was started here; `snakemake <study>` starts one."),
    ],
)
def test_nothing_to_tell_is_one_sentence(tmp_path, monkeypatch, capsys, words, said):
    """Of a study that is none, or was not started; exit code 1."""
    monkeypatch.chdir(tmp_path)
    assert main(["status", *words]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(said)


def test_a_damaged_forecast_is_one_sentence(running, monkeypatch, capsys):
    """With its file and what to do."""
    monkeypatch.chdir(running.parent)
    for text in ("garbage\n", "", "job\nA\n"):
        (running / "demo" / "forecast.csv").write_text(text)
        assert main(["status", "demo"]) == 1
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith("results/demo/forecast.csv: there is no column ") and "once it is deleted" in line


def test_the_command_tells_of_the_latest_study(running, monkeypatch, capsys):
    """Where none is named; on as many cores as are said."""
    monkeypatch.chdir(running.parent)
    assert main(["status", "--cores", "2"]) == 0
    assert "left on 2 cores" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main(["status", "--cores", "0"])
    assert "argument --cores: it is '0', allowed is a whole number above 0" in capsys.readouterr().err


@pytest.mark.parametrize("seconds", [0.0, 59.0, 60.0, 224.0, 7500.0])
def test_durations_are_read_as_they_are_said(seconds):
    """To the last unit that is said."""
    assert seconds_of(duration_text(seconds)) == seconds
