"""What runs that are done leave for the pages of results, made up."""

from pathlib import Path

import pandas as pd

from bulkwear.workflows.config.design import Study


def leave_runs(study: Study, folder: Path, *further: str) -> None:
    """Write forecast, state, log and cost of every run: 50 s forecast, 120 s in the solver, 60 s of its processor.

    further: jobs that are forecast besides
    """
    jobs = [*further, *(f"worn_run_{run.name}" for run in study.runs)]
    pd.DataFrame({"job": jobs, "solver_s": 50.0}).to_csv(folder / "forecast.csv", index=False)
    for run in study.runs:
        cycle = folder / run.name / "cycle_000"
        cycle.mkdir(parents=True)
        (cycle / "state.json").write_text("{}")
        (cycle / "log.liggghts").write_text("LIGGGHTS (Version LIGGGHTS-PUBLIC 3.8.0, compiled)\n")
        cost = {"cycle": [0], "particles": [1000], "steps": [6000], "solver_s": [120.0], "processor_s": [60.0]}
        pd.DataFrame(cost | {"other_s": [30.0]}).to_csv(folder / run.name / "cost.csv", index=False)
