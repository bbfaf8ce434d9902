"""The solver's share of the wall time, against closed forms."""

import pandas as pd
import pytest

from bulkwear.workflows.report.cost import (
    against_forecast,
    benchmark_seconds,
    job_costs,
    outside_solver_share,
    run_cost,
)

RUN = pd.DataFrame({"solver_s": [30.0, 50.0], "other_s": [1.0, 3.0], "particles": [100, 200], "steps": [10, 20]})
RELATIVE = 1e-12  # rounding of one quotient


def test_particle_steps_per_second():
    """Sum over cycles of particles times steps, over the solver's seconds."""
    assert run_cost(RUN)["particle_steps_per_s"] == pytest.approx((100 * 10 + 200 * 20) / 80.0, rel=RELATIVE)


def test_share_outside_the_solver():
    """(wall - solver) / wall over all jobs: a run of 90 s with 80 s of solver beside 10 s of tables gives 20 %."""
    jobs = job_costs({"worn_run": 90.0, "summary": 4.0, "figure": 6.0}, {"worn_run": RUN})
    assert outside_solver_share(jobs) == pytest.approx(0.2, rel=RELATIVE)
    assert jobs["outside_s"].tolist() == [10.0, 4.0, 6.0]


def test_a_resumed_run_counts_all_its_cycles():
    """A benchmark knows the last start only; the cycles know them all, so the share is never negative."""
    jobs = job_costs({"worn_run": 12.0}, {"worn_run": RUN})
    assert jobs["wall_s"].tolist() == [84.0]
    assert outside_solver_share(jobs) == pytest.approx(4.0 / 84.0, rel=RELATIVE)


def test_a_bed_needs_no_other_seconds():
    """The cost table of a bed has no `other_s`; its wall time is the benchmark's."""
    bed = pd.DataFrame({"solver_s": [8.0], "steps": [5], "particles": [10]})
    assert job_costs({"settled_bed": 10.0}, {"settled_bed": bed})["outside_s"].tolist() == [2.0]


def test_benchmark_files_are_named_after_their_jobs(tmp_path):
    """The job is the file's name without its ending; repeats add up."""
    path = tmp_path / "worn_run_R9_convex.benchmark.tsv"
    path.write_text("s\th:m:s\n1.5\t0:00:01\n2.5\t0:00:02\n")
    assert benchmark_seconds([path]) == {"worn_run_R9_convex": 4.0}


def test_measured_over_forecast():
    """Processor time where it was measured, else wall time, over what was forecast; nothing for other jobs."""
    costs = {"old": RUN, "new": RUN.assign(processor_s=[25.0, 35.0])}
    jobs = job_costs({"figure": 6.0}, costs)
    forecast = pd.DataFrame({"job": ["new", "old", "never run"], "solver_s": [50.0, 40.0, 7.0]})
    found = against_forecast(jobs, forecast).set_index("job")["measured_over_forecast"]
    assert found[["old", "new"]].tolist() == [80.0 / 40.0, 60.0 / 50.0]
    assert pd.isna(found["figure"])
