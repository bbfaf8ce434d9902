"""What a study cost: wall time per job, the solver's share of it, the solver's speed, and what was forecast."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

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
