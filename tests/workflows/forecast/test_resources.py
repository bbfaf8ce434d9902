"""What jobs ask of a cluster: more than their forecast, for every job that calls the solver."""

import pytest
import yaml

from workflows.config.design import REPOSITORY, list_studies, load_study
from workflows.forecast.forecast import forecast_table, work_of
from workflows.forecast.rates import rates_file, read_rates
from workflows.forecast.resources import LEAST_MEMORY_MB, LEAST_MINUTES, demands, megabytes, minutes

PROFILES = REPOSITORY / "profiles"


@pytest.mark.parametrize("name", list_studies(REPOSITORY))
def test_every_job_asks_for_more_than_its_forecast(name):
    """All beds, runs and calibrations of a study are there, each with more time and memory than it is forecast to need,
    and with half as much again and a start-up at most twice over."""
    study = load_study(name, overrides={"fidelity": "paper"})
    table = forecast_table(work_of(study), read_rates(rates_file(REPOSITORY)).rates).set_index("job")
    asked = demands(study, REPOSITORY)
    assert set(asked) == set(table.index)
    for job, (time, memory) in asked.items():
        needed, largest = 60.0 * table.loc[job, "wall_h"], 1e3 * table.loc[job, "memory_gb"]
        assert 1.5 * needed < time <= 2.0 * needed + LEAST_MINUTES + 1
        assert largest < memory <= 2.0 * largest + LEAST_MEMORY_MB + 1


def test_nothing_to_do_still_takes_a_start():
    """A job whose simulation another one has done asks for the time and memory of Python alone."""
    assert (minutes(0.0), megabytes(0.0)) == (LEAST_MINUTES, LEAST_MEMORY_MB)


def test_the_profile_lets_jobs_come_back():
    """No job may ask for more than a longest one, so an interrupted one must be submitted again and be taken up."""
    there, here = (yaml.safe_load((PROFILES / name / "config.yaml").read_text()) for name in ("slurm", "default"))
    assert there["executor"] == "slurm"
    assert there["retries"] > 1 and there["rerun-incomplete"]
    assert {"runtime", "mem_mb"} <= set(there["resources"])
    assert {key: there[key] for key in here if key != "cores"} == {key: here[key] for key in here if key != "cores"}
