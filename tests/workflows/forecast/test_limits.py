"""What exceeds a machine is refused before it starts, unless the study asks for it."""

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.project import Project
from bulkwear.workflows.forecast.forecast import GIGABYTE, work_of
from bulkwear.workflows.forecast.limits import ALLOWED, fault_here, fault_of_machine, held_gb
from bulkwear.workflows.forecast.rates import rates_file, read_rates

ROUNDING = 1e-12  # relative
PLAIN = {"fidelity": "quick"}
HUGE = {  # settings -> what is said of them on a small machine
    "fine elements": (
        {"sample": {"width_mm": 1500, "length_mm": 1500, "element_size_mm": 0.05}, "bed": {"width_mm": 2000}},
        "triangles and needs about",
    ),
    "many ranks": ({"solver": {"ranks": 4096}}, "solver.ranks is 4096, this machine has 2 cores"),
}


def fault(study, cores=2, memory_gb=16.0, free_gb=100.0):
    """What is wrong with all jobs of a study on a small machine."""
    jobs = [job.name for job in work_of(study)]
    meshed = [run.name for run in study.runs]
    return fault_of_machine(study, jobs, meshed, read_rates(rates_file()).rates, cores, memory_gb, free_gb)


def test_the_demo_is_within_every_machine():
    """What is shipped as quick is begun on two cores."""
    study = load_study("demo", overrides=PLAIN)
    assert fault(study) is None
    assert fault_here(study, [], []) is None


@pytest.mark.parametrize("what", ["fine elements", "many ranks"])
def test_what_exceeds_the_machine_is_refused(what):
    """One sentence says what is needed and what is there; a study may ask for it nevertheless."""
    settings, said = HUGE[what]
    found = fault(load_study("demo", overrides=PLAIN | settings))
    assert said in found and found.startswith("demo: ") and f"{ALLOWED}: true" in found
    assert fault(load_study("demo", overrides=PLAIN | settings | {ALLOWED: True})) is None


@pytest.mark.parametrize(
    "machine, said",
    [
        ({"memory_gb": 0.1}, "GB of memory, this machine has 0.1 GB"),
        ({"free_gb": 1e-6}, "GB on the disk"),
    ],
)
def test_a_small_machine_refuses_a_small_study(machine, said):
    """Memory and disk are those of the machine and its forecast."""
    assert said in fault(load_study("demo", overrides=PLAIN), **machine)


def test_what_an_interrupted_start_left_needs_no_room_again(tmp_path, monkeypatch):
    """Finished cycles and a filled bed of jobs that go on count, of each no more than it is to have."""
    monkeypatch.setattr("bulkwear.workflows.forecast.limits.current_project", lambda: Project(tmp_path))
    study = load_study("demo", overrides=PLAIN)
    run, work = study.runs[0].name, {job.name: job for job in work_of(study)}
    bed, worn = f"settled_bed_{study.bed_of(run)}", f"worn_run_{run}"
    assert held_gb(study, work) == 0.0
    results = tmp_path / "results" / "demo"
    for folder, count in ((results / run / "cycle_000", 1000), (results / "beds" / study.bed_of(run), 10**7)):
        folder.mkdir(parents=True)
        (folder / "a").write_bytes(bytes(count))
    (results / run / "superseded").mkdir()
    (results / run / "superseded" / "a").write_bytes(bytes(5000))
    assert work[bed].disk_bytes < 10**7
    assert held_gb(study, [bed, worn]) * GIGABYTE == pytest.approx(1000 + work[bed].disk_bytes, rel=ROUNDING)
    assert held_gb(study, [worn]) * GIGABYTE == pytest.approx(1000, rel=ROUNDING)


def test_more_than_a_year_is_refused(monkeypatch):
    """Wall time on the machine's cores counts."""
    monkeypatch.setattr("bulkwear.workflows.forecast.limits.HOURS_PER_YEAR", 1e-6)
    assert "which is more than a year" in fault(load_study("demo", overrides=PLAIN))
