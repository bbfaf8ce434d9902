"""What a study cost: wall time per job, the solver's share of it, the solver's speed, and what was forecast."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from bulkwear.workflows.report.text import data_uri

FORECAST = "forecast.csv"
BENCHMARK_SUFFIX = ".benchmark.tsv"


def benchmark_seconds(paths: Sequence[str | Path]) -> dict[str, float]:
    """Return the wall time (s) of each job by its name, from the workflow's benchmark files."""
    return {
        Path(path).name.removesuffix(BENCHMARK_SUFFIX): float(pd.read_csv(path, sep="\t")["s"].sum()) for path in paths
    }


def run_cost(cost: pd.DataFrame) -> dict[str, float]:
    """Return solver_s, processor_s, other_s, particles, steps and particle steps per second of a cost table.

    cost: rows of cost.csv of a run (cycle by cycle) or of a bed (no `other_s`, `triangles` or `ranks`). Processor time
    is the solver's, of all ranks; NaN in tables of versions that did not measure it.
    Particle steps: particles at the end of a cycle times its steps, summed over the cycles.
    """
    particle_steps = float((cost["particles"] * cost["steps"]).sum())
    solver_seconds = float(cost["solver_s"].sum())
    return {
        "solver_s": solver_seconds,
        "processor_s": float(cost["processor_s"].sum()) if "processor_s" in cost else float("nan"),
        "other_s": float(cost["other_s"].sum()) if "other_s" in cost else 0.0,
        "particles": int(cost["particles"].max()),
        "steps": int(cost["steps"].sum()),
        "particle_steps_per_s": particle_steps / solver_seconds if solver_seconds else float("nan"),
    }


def job_costs(seconds: Mapping[str, float], costs: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Return one row per job: job, wall_s, solver_s, outside_s; solver columns are empty for other jobs.

    seconds: wall time by job. costs: cost.csv of the jobs that call the solver, by job. A run that was
    resumed has a benchmark of its last start only: its wall time is then the sum of its cycles, all starts
    together.
    """
    rows = []
    for job in dict.fromkeys([*seconds, *costs]):
        found = run_cost(costs[job]) if job in costs else {"solver_s": 0.0, "other_s": 0.0}
        wall = max(seconds.get(job, 0.0), found["solver_s"] + found["other_s"])
        rows.append({"job": job, "wall_s": wall, "outside_s": wall - found["solver_s"], **found})
    return pd.DataFrame(rows).drop(columns="other_s")


def against_forecast(jobs: pd.DataFrame, forecast: pd.DataFrame) -> pd.DataFrame:
    """Return the jobs with what the solver was forecast to take: forecast_s, and measured_over_forecast (-).

    forecast: forecast.csv of the study (`job`, `solver_s`). Measured is the processor time where it is known, else the
    wall time, which other work on the machine lengthens. NaN for jobs without the solver.
    """
    expected = jobs["job"].map(forecast.set_index("job")["solver_s"])
    measured = jobs["processor_s"].fillna(jobs["solver_s"])
    return jobs.assign(forecast_s=expected, measured_over_forecast=measured / expected)


def outside_solver_share(jobs: pd.DataFrame) -> float:
    """Return (sum of wall_s - sum of solver_s) / sum of wall_s over all jobs, -."""
    total = float(jobs["wall_s"].sum())
    return (total - float(jobs["solver_s"].sum())) / total


def cost_parts(study: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return what the page's template shows of the cost of a study's jobs."""
    jobs = jobs_of(study, folder)
    return {
        "jobs": solver_jobs(jobs),
        "jobs_csv": data_uri(jobs.to_csv(index=False).encode(), "text/csv"),
        "totals": cost_totals(jobs),
        "forecast_by": pd.read_csv(folder / FORECAST)["by"].iloc[0],
    }


def jobs_of(study: Mapping[str, Any], folder: Path) -> pd.DataFrame:
    """Return the cost of every job behind the page, see `job_costs`."""
    files = [folder / "logs" / f"{job}{BENCHMARK_SUFFIX}" for job in study["jobs"]]
    costs = {f"worn_run_{run}": folder / run / "cost.csv" for run in study["runs"]}
    costs |= {f"settled_bed_{bed}": folder / "beds" / bed / "cost.csv" for bed in study["beds"]}
    costs |= {job: folder / path for job, path in study["told"].get("costs", {}).items()}
    tables = {job: pd.read_csv(path) for job, path in costs.items() if path.is_file()}
    jobs = job_costs(benchmark_seconds([path for path in files if path.is_file()]), tables)
    return against_forecast(jobs, pd.read_csv(folder / FORECAST))


def solver_jobs(jobs: pd.DataFrame) -> list[dict[str, Any]]:
    """Return the jobs that call the solver, and all others in one row."""
    solving = jobs[jobs["solver_s"] > 0.0]
    rest = jobs[jobs["solver_s"] == 0.0]
    others = {"job": f"{len(rest)} other jobs (meshes, tables, figures)", "wall_s": rest["wall_s"].sum()}
    rows = [
        *solving.to_dict("records"),
        {**dict.fromkeys(jobs.columns), **others, "outside_s": others["wall_s"]},
    ]
    return [{**row, "solver_share": share_of(row["solver_s"], row["wall_s"])} for row in rows]


def share_of(part: float | None, whole: float) -> float:
    """Return a share in percent, 0 where nothing was taken."""
    return 100.0 * (part or 0.0) / whole if whole else 0.0


def cost_totals(jobs: pd.DataFrame) -> dict[str, float]:
    """Return the sums of all jobs: wall_s, solver_s, outside_s, outside_percent, particle steps per second, forecast_s,
    measured_over_forecast.
    """
    solver_seconds, expected = (float(jobs[name].sum()) for name in ("solver_s", "forecast_s"))
    measured = float((jobs["measured_over_forecast"] * jobs["forecast_s"]).sum())
    steps = float((jobs["particle_steps_per_s"] * jobs["solver_s"]).sum()) if solver_seconds else 0.0
    return {
        "jobs": len(jobs),
        "wall_s": float(jobs["wall_s"].sum()),
        "solver_s": solver_seconds,
        "outside_s": float(jobs["outside_s"].sum()),
        "outside_percent": 100.0 * outside_solver_share(jobs),
        "particle_steps_per_s": steps / solver_seconds if solver_seconds else float("nan"),
        "forecast_s": expected,
        "measured_over_forecast": measured / expected if expected else float("nan"),
    }
