"""What finished studies cost: how much of each is not the solver, by the wall times of whole jobs, and what the solver
took over its forecast, by the rates of results/<study>/forecast.csv. Processor time counts where it was recorded; of a
calibration only the solver's wall time is known, and no share. `python -m benchmarks.study_share FOLDER` prints a line
per study of another folder of results.
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.measure import Measure, measured
from bulkwear.workflows.cases.calibration.boxes import SIMULATIONS
from bulkwear.workflows.engine import state
from bulkwear.workflows.report.cost import BENCHMARK_SUFFIX, against_forecast, benchmark_seconds, job_costs
from bulkwear.workflows.report.markdown import markdown
from bulkwear.workflows.report.page import FORECAST, cost_totals

RESULTS = Path("results")
SECONDS_PER_HOUR = 3600.0
UNTOLD = "fidelity not told"  # by forecasts of earlier versions
FURTHER_COSTS = {"packing_profiles": "packings/solver_cost.csv"}  # job that calls the solver, besides beds and runs
SIMULATED = "simulations"  # stands for all solver jobs of a calibration


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


def study_row(folder: Path) -> dict[str, Any] | None:
    """Return what a study cost, None where no solver left a record: study, fidelity, outside_solver_percent of the wall
    time of all jobs (NaN of a calibration, whose simulations run side by side within a job), solver_jobs that left a
    record, solver_core_hours of those that were forecast, their forecast_core_hours and measured_over_forecast (NaN
    without a forecast).
    """
    jobs = study_jobs(folder)
    if jobs.empty or not jobs["solver_s"].sum() > 0.0:
        return None
    totals, fidelity = cost_totals(jobs), forecast_of(folder, calibration=False)["fidelity"]
    return {
        "study": folder.name,
        "fidelity": fidelity.iloc[0] if len(fidelity) else UNTOLD,
        "outside_solver_percent": float("nan") if SIMULATED in set(jobs["job"]) else totals["outside_percent"],
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
    """Return of each study with results the share (%) outside the solver, and the solver's hours over the forecast."""
    told = []
    for row in study_rows(RESULTS).itertuples():
        name, share = f"{row.study} ({row.fidelity})", row.outside_solver_percent
        if not math.isnan(share):
            whole = f"all {row.jobs} jobs, {row.wall_hours:.2f} h"
            told.append(measured(f"{name}, outside the solver", "%", [share], whole))
        if row.forecast_core_hours > 0.0:
            hours, forecast = [row.solver_core_hours], [row.forecast_core_hours]
            told.append(measured(f"{name}, solver, {row.solver_jobs} jobs", "core h", hours, "its forecast", forecast))
    return told


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, nargs="?", default=RESULTS, help="of results, with a folder per study")
    table = study_rows(parser.parse_args().folder)
    print(markdown(table) if len(table) else "No study with results.")


if __name__ == "__main__":
    main()
