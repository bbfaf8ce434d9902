"""How much of a study is not the solver: from what the jobs of finished studies recorded, wall times of whole jobs."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from benchmarks.measure import Measure, measured
from postproc.analysis.cost import BENCHMARK_SUFFIX, benchmark_seconds, job_costs, outside_solver_share
from workflows.design import list_studies

ROOT = Path(__file__).resolve().parents[1]
RESULTS = Path("results")
PERCENT = 100.0


def study_jobs(folder: Path) -> pd.DataFrame:
    """Return the cost of every job that left a record in a study's folder, see `analysis.cost.job_costs`."""
    costs = {f"worn_run_{path.parent.name}": pd.read_csv(path) for path in sorted(folder.glob("*/cost.csv"))}
    costs |= {f"settled_bed_{path.parent.name}": pd.read_csv(path) for path in sorted(folder.glob("beds/*/cost.csv"))}
    return (
        job_costs(benchmark_seconds(sorted(folder.glob(f"logs/*{BENCHMARK_SUFFIX}"))), costs)
        if costs
        else pd.DataFrame()
    )


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the share (%) of each study with results, of all of its jobs together."""
    told = []
    for study in list_studies(ROOT):
        jobs = study_jobs(RESULTS / study)
        if len(jobs) and jobs["solver_s"].sum() > 0.0:
            hours = jobs["wall_s"].sum() / 3600.0
            share = PERCENT * outside_solver_share(jobs)
            told.append(measured(f"{study}, outside the solver", "%", [share], f"all {len(jobs)} jobs, {hours:.2f} h"))
    return told
