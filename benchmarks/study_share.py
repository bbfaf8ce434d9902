"""What finished studies cost: how much of each is not the solver, by the processor time of whole jobs, and what the
solver took over its forecast, by the rates of results/<study>/forecast.csv.

Each job ends its log with its processor time and that of the programs it ran; of jobs that simulate these are the
solver. Wall times tell the share of studies that earlier versions ran, and mean little where a machine is shared. Of
wear cycles the share is told by themselves too, also of a run that was stopped after some: in its folder each cycle
keeps what solver and driver took. Where a study is told by its cycles alone, one run of it was simulated as far; its
first cycle holds what a run does once, as loading what is compiled. `python -m benchmarks.study_share FOLDER` prints a
line per study of another folder of results.
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.command_line import command
from benchmarks.measure import Measure, measured
from bulkwear.workflows.cases.calibration.boxes import SIMULATIONS
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.cycles import OWN_TIME
from bulkwear.workflows.engine.job import processor_seconds_of
from bulkwear.workflows.report.cost import (
    BENCHMARK_SUFFIX,
    FORECAST,
    against_forecast,
    benchmark_seconds,
    cost_totals,
    job_costs,
)
from bulkwear.workflows.report.markdown_text import markdown

RESULTS = Path("results")
SECONDS_PER_HOUR = 3600.0
UNTOLD = "fidelity not told"  # by forecasts of earlier versions
FURTHER_COSTS = {"packing_profiles": "packings/solver_cost.csv"}  # job that calls the solver, besides beds and runs
SIMULATED = "simulations"  # stands for all solver jobs of a calibration
SIMULATING = ("worn_run_", "settled_bed_", "calibrated_parameters", "box_sizes", "packing_profiles")  # jobs begin so
PERCENT = 100.0


def study_jobs(folder: Path) -> pd.DataFrame:
    """Return the cost of every job that left a record in a study's folder, with its forecast where there is one.

    Columns as from `report.cost.job_costs` and `against_forecast`; empty where the solver left no record.
    """
    costs = {f"worn_run_{path.parent.name}": pd.read_csv(path) for path in sorted(folder.glob("*/cost.csv"))}
    costs |= {f"settled_bed_{path.parent.name}": pd.read_csv(path) for path in sorted(folder.glob("beds/*/cost.csv"))}
    costs |= {job: pd.read_csv(folder / path) for job, path in FURTHER_COSTS.items() if (folder / path).is_file()}
    simulations = [
        json.loads((path / state.STATE).read_text())["cost"] for path in folder.glob(f"{SIMULATIONS}/*/cycle_000")
    ]
    if simulations:
        costs[SIMULATED] = pd.DataFrame(simulations)
    if not costs:
        return pd.DataFrame()
    jobs = job_costs(benchmark_seconds(sorted(folder.glob(f"logs/*{BENCHMARK_SUFFIX}"))), costs)
    return against_forecast(jobs, forecast_of(folder, bool(simulations)))


def forecast_of(folder: Path, calibration: bool) -> pd.DataFrame:
    """Return job, solver_s and fidelity of a study's forecast, empty without one; of a calibration a single line."""
    if not (folder / FORECAST).is_file():
        return pd.DataFrame({"job": [], "solver_s": [], "fidelity": []})
    table = pd.read_csv(folder / FORECAST)
    table = table.assign(fidelity=table.get("fidelity", UNTOLD))
    if calibration:
        table = pd.DataFrame(
            {"job": [SIMULATED], "solver_s": [table["solver_s"].sum()], "fidelity": table["fidelity"].iloc[:1]}
        )
    return table[["job", "solver_s", "fidelity"]]


def outside_of_jobs(folder: Path) -> float:
    """Return the share (%) outside the solver of the processor time of a study's jobs; NaN where a job that left a
    benchmark does not tell its own.
    """
    outside = solver = 0.0
    for benchmark in sorted(folder.glob(f"logs/*{BENCHMARK_SUFFIX}")):
        log = benchmark.with_name(benchmark.name.removesuffix(BENCHMARK_SUFFIX) + ".log")
        if not log.is_file() or (spent := processor_seconds_of(log)) is None:
            return math.nan
        own, programs = spent
        simulates = log.name.startswith(SIMULATING)
        outside, solver = outside + own + (0.0 if simulates else programs), solver + simulates * programs
    return PERCENT * outside / (outside + solver) if solver else math.nan


def cycle_costs(folder: Path) -> pd.DataFrame:
    """Return processor_s and `OWN_TIME` of the finished wear cycles of all runs, whether these are done or not; NaN
    where a cycle does not tell them.
    """
    costs = [state.read_record(path / state.STATE)["cost"] for path in sorted(folder.glob("*/cycle_[0-9][0-9][0-9]"))]
    return pd.DataFrame([each for each in costs if each["cycle"]], columns=["processor_s", OWN_TIME])


def study_row(folder: Path) -> dict[str, Any] | None:
    """Return what a study cost, None where no solver left a record: study, fidelity; outside_solver_percent of the
    processor time of all jobs or, where one does not tell it, of their wall time (by: which of them; NaN of a
    calibration by the clock, whose simulations run side by side within a job); outside_cycles_percent of the processor
    time of the wear cycles that are finished, whose number cycles is; solver_jobs that left a record, solver_core_hours
    of those that were forecast, their forecast_core_hours and measured_over_forecast (NaN without a forecast).
    """
    jobs, cycles, of_jobs = study_jobs(folder), cycle_costs(folder), outside_of_jobs(folder)
    solved = not jobs.empty and jobs["solver_s"].sum() > 0.0
    if not solved and cycles.empty:
        return None
    fidelity = forecast_of(folder, calibration=False)["fidelity"]
    own, solver = (cycles[name].sum(skipna=False) for name in (OWN_TIME, "processor_s"))
    row = {
        "study": folder.name,
        "fidelity": fidelity.iloc[0] if len(fidelity) else UNTOLD,
        "outside_cycles_percent": PERCENT * own / (own + solver) if len(cycles) else math.nan,
        "cycles": len(cycles),
    }
    if not solved:
        return row
    totals = cost_totals(jobs)
    by_clock = math.nan if SIMULATED in set(jobs["job"]) else totals["outside_percent"]
    return row | {
        "outside_solver_percent": by_clock if math.isnan(of_jobs) else of_jobs,
        "by": "the clock" if math.isnan(of_jobs) else "processor time",
        "jobs": totals["jobs"],
        "solver_jobs": int((jobs["solver_s"] > 0.0).sum()),
        "wall_hours": totals["wall_s"] / SECONDS_PER_HOUR,
        "solver_core_hours": totals["measured_over_forecast"] * totals["forecast_s"] / SECONDS_PER_HOUR,
        "forecast_core_hours": totals["forecast_s"] / SECONDS_PER_HOUR,
        "measured_over_forecast": totals["measured_over_forecast"],
    }


def study_rows(results: Path) -> pd.DataFrame:
    """Return `study_row` of every study in a folder of results, by name."""
    rows = [study_row(folder) for folder in sorted(results.glob("*")) if folder.is_dir()]
    return pd.DataFrame([row for row in rows if row])


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return of each study with results the shares (%) outside the solver, and the solver's hours over the forecast."""
    told = []
    for row in study_rows(RESULTS).to_dict("records"):
        name, share, of_cycles = f"{row['study']} ({row['fidelity']})", row.get("outside_solver_percent"), row["cycles"]
        if share is not None and not math.isnan(share):
            whole = f"{row['by']} of all {row['jobs']:.0f} jobs, {row['wall_hours']:.2f} h"
            told.append(measured(f"{name}, outside the solver", "%", [share], whole))
        if not math.isnan(row["outside_cycles_percent"]):
            whole = f"processor time of {of_cycles} wear cycle{'s' if of_cycles > 1 else ''}"
            told.append(measured(f"{name}, outside the solver in cycles", "%", [row["outside_cycles_percent"]], whole))
        if row.get("forecast_core_hours", 0.0) > 0.0:
            hours, forecast = [row["solver_core_hours"]], [row["forecast_core_hours"]]
            jobs = f"solver, {row['solver_jobs']:.0f} jobs"
            told.append(measured(f"{name}, {jobs}", "core h", hours, "its forecast", forecast))
    return told


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, nargs="?", default=RESULTS, help="of results, with a folder per study")
    given = parser.parse_args()
    if not given.folder.is_dir():
        parser.error(f"{given.folder} is no folder, allowed is one with one folder per study")
    if (given.folder / "design.csv").exists():
        parser.error(f"{given.folder} is one study, allowed is a folder with one folder per study")
    table = study_rows(given.folder)
    print(markdown(table) if len(table) else "No study with results.")


if __name__ == "__main__":
    command(main)
