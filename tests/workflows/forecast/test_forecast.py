"""Forecasts: jobs and their sizes, seconds, memory and disk, and how jobs fill cores."""

import pickle
import subprocess
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import gmsh
import pandas as pd
import pytest
import yaml

from bulkwear.meshes.own import cad
from bulkwear.workflows.cases.sliding_sample.particle_size.packings import container
from bulkwear.workflows.cases.sliding_sample.particle_size.study import by_scale, packed_runs
from bulkwear.workflows.cases.sliding_sample.work import cycles
from bulkwear.workflows.config.design import list_studies, load_study
from bulkwear.workflows.config.units import to_si
from bulkwear.workflows.engine.bulk_tests import time_step
from bulkwear.workflows.engine.job import duration_text
from bulkwear.workflows.engine.patience import Patience
from bulkwear.workflows.engine.work import Stage, Work
from bulkwear.workflows.forecast import forecast
from bulkwear.workflows.forecast.forecast import (
    DRIVER_MEMORY,
    LEAST_MEMORY_MB,
    LEAST_MINUTES,
    REPORTS_PER_DECK,
    SOLVER_MEMORY,
    announcement,
    demands,
    forecast_table,
    forecast_text,
    megabytes,
    memory,
    minutes,
    step_core_minutes,
    totals,
    wall_hours,
    work_of,
)
from bulkwear.workflows.forecast.rates import DEFAULT, TERMS, rates_file, read_rates
from bulkwear.workflows.forecast.shipped import PAGE, page, shipped_forecasts
from tests import REPOSITORY

EXACT = 1e-12  # relative; rounding of a few sums
PARTICLES = 2e-3  # relative; numbers of each size are rounded
TRIANGLE = 2  # gmsh's number of the element
OF_BLOCK = 100  # triangles; the tester's block has 42, the smallest sample thousands
RATES = dict.fromkeys(TERMS, 0.0) | {"particle_steps": 1e-6, "triangle_steps": 1e-7, "cycles": 2.0, "jobs": 1.0}
OF_CAD = ("chute", "which_law", "screw", "mill")  # studies of several drawings
SHORT = 40  # letters, of what Snakemake shows of jobs
PROFILES = REPOSITORY / "profiles"
# Particles that LIGGGHTS 3.8.0 counted in beds at quick fidelity.
COUNTED = {
    "demo": {"bed_R5": 6964},
    "screening": {"bed_R1": 45520, "bed_R2": 11380, "bed_R6": 22760},
    "particle_size": {"bed_S4": 13619, "bed_S6": 4124, "bed_S8": 1777, "bed_S9": 1261, "bed_S10": 929, "bed_S12": 549},
}


def job(name="a", **changes):
    """A job of one stage: a thousand particles and steps, ten triangles, four wear cycles."""
    stage = Stage(4, 1000, 1000.0, 10.0, surface_triangles=20.0)
    return Work("worn_run", (name,), **{"stages": (stage,), **changes})


@pytest.fixture(scope="module")
def forecasts():
    """Tables of every study at every fidelity by the default rates, and what was done for them.

    That is the triangles of each mesh, what was read of each file of CAD, and the command of each program.
    """
    triangles, read, commands = [], [], []
    mesh, read_cad, start = gmsh.model.mesh.generate, cad._apart, subprocess.Popen.__init__

    def meshed(dimension):
        mesh(dimension)
        triangles.append(len(gmsh.model.mesh.getElementsByType(TRIANGLE)[0]))

    def cad_read(path, what, *given):
        read.append(what)
        return read_cad(path, what, *given)

    def started(self, command, *given, **named):
        commands.append(command)
        start(self, command, *given, **named)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(gmsh.model.mesh, "generate", meshed)
        patch.setattr(cad, "_apart", cad_read)
        patch.setattr(subprocess.Popen, "__init__", started)
        return shipped_forecasts(), triangles, read, commands


@pytest.mark.verify
def test_the_page_of_forecasts_is_up_to_date(forecasts):
    """docs/forecast_studies.md is what `python -m bulkwear.workflows.forecast.shipped` writes."""
    assert PAGE.read_text(encoding="utf-8") == page(forecasts[0])


@pytest.mark.verify
def test_every_study_at_every_fidelity(forecasts):
    """Each has jobs that cost something, with names that differ, and each starts after jobs that are there."""
    for table in forecasts[0].values():
        first = table[table["steps"] > 0]
        assert (first[["particles", "solver_s", "core_h", "wall_h", "memory_gb", "disk_gb"]] > 0.0).all().all()
        assert (table["core_h"] > 0.0).all()
        assert table["job"].is_unique
        assert set(table["needs"]) - {""} <= set(table["job"])


@pytest.mark.verify
def test_no_surface_is_meshed_and_nothing_simulated_for_it(forecasts):
    """But the tester's block, a few triangles; CAD is drawn and its areas are read, and no other program starts."""
    _, triangles, read, commands = forecasts
    assert max(triangles, default=0) <= OF_BLOCK  # none where the block is known already
    assert set(read) == {"areas"}
    others = [command for command in commands if cad.PROGRAM not in command]
    assert len(commands) - len(others) == len(read)
    assert {Path(command[1]).name for command in others} == {"draw.py"}


@pytest.mark.verify
def test_fidelities_cost_more_and_more(forecasts):
    """Of studies of samples and boxes; a pin's `paper` is its `standard`."""
    for name in {name for name, _ in forecasts[0]}:
        hours = [forecasts[0][name, fidelity]["core_h"].sum() for fidelity in ("quick", "standard", "paper")]
        assert all(before <= after for before, after in pairwise(hours)), name
        assert hours[0] < hours[2]


def test_jobs_are_those_of_the_workflow(repository):
    """Runs start after their bed, or after the run that simulates both, for nothing; a calibration has two jobs."""
    study = load_study("screening")
    work = {each.name: each for each in work_of(study)}
    assert len(work) == len(study.beds) + len(study.runs)
    for run in study.runs:
        found, same = work[f"worn_run_{run.name}"], study.same_as(run.name)
        assert found.needs == (f"worn_run_{same}" if same else f"settled_bed_{study.bed_of(run.name)}")
        assert bool(found.stages) is not bool(same)
    assert [each.name for each in work_of(load_study("calibration"))] == [
        "calibrated_parameters",
        "box_sizes",
    ]


def test_jobs_look_like_one_word(repository):
    """By which Snakemake compares them: the same for the same jobs, another one for others; a copy is as the first."""
    first, again, more = (work_of(load_study("demo", overrides={"packings": n})) for n in (1, 1, 2))
    assert repr(first) == repr(again) == repr(pickle.loads(pickle.dumps(first)))
    longer = replace(first[0], disk_bytes=first[0].disk_bytes + 1.0)
    assert len({repr(first), repr(more), repr(type(first)((longer, *first[1:])))}) == 3
    assert repr(first).startswith(f"{len(first)} jobs ") and len(repr(more)) < SHORT
    assert tuple(again) == tuple(first) != tuple(more)


@pytest.mark.parametrize("fidelity", ["quick", "standard", "paper"])
def test_packings_are_a_job_of_the_study_of_particle_size(repository, fidelity):
    """One job that waits for nothing, with a container per scale: filled, then shaken for as long as the study says."""
    study = load_study("particle_size", overrides={"fidelity": fidelity})
    first, *others = work_of(study)
    assert (first.name, first.needs) == ("packing_profiles", "")
    assert {each.rule for each in others} == {"settled_bed", "worn_run"}
    runs = by_scale(packed_runs(study))
    packing = to_si(study.settings)["packing"]
    filled, shaken = first.stages[::2], first.stages[1::2]
    assert len(filled) == len(shaken) == len(runs)
    for run, poured, moved in zip(runs.values(), filled, shaken, strict=True):
        assert poured.decks == 1 and moved.decks == 0 and moved.moving
        assert poured.particles == moved.particles > packing["width_diameters"] ** 2
        assert moved.steps * time_step(container(run, packing)) > packing["shaking_s"]


def test_packings_of_larger_and_of_fewer_particles_cost_less(repository):
    """Rows left out take their containers with them, and a container of smaller particles costs more."""
    rates = read_rates(repository / DEFAULT).rates
    seconds = {}
    for rows in (["S4"], ["S8"], ["S4", "S8"]):
        work = work_of(load_study("particle_size", overrides={"rows": rows}))[:1]
        seconds["".join(rows)] = forecast_table(work, rates)["solver_s"].iloc[0]
    assert seconds["S4S8"] == pytest.approx(seconds["S4"] + seconds["S8"], rel=EXACT)
    assert seconds["S4"] > 2.0 * seconds["S8"]


def test_other_studies_have_no_packings(repository):
    """A study whose rows are of one particle scale, or of another case, has none in its forecast."""
    for name in ("demo", "screening", "pin_on_disc", "calibration", "circular_tester"):
        assert "packing_profiles" not in {each.name for each in work_of(load_study(name))}


@pytest.mark.parametrize("name", COUNTED)
def test_particles_of_beds(name):
    """The poured mass over that of a particle."""
    study = load_study(name, overrides={"packings": 1, "fidelity": "quick"})
    for run in study.runs:
        counted = COUNTED[name][study.bed_of(run.name)]
        assert run.parameters["derived"]["bed_particles"] == pytest.approx(counted, rel=PARTICLES)


def test_adaptive_cycles_of_a_run_that_was_done(repository):
    """The worn bump took 191 at quick fidelity, from which the number is scaled; twice the acceleration doubles it."""
    run = load_study("worn_bump").runs[0].parameters
    twice = load_study("worn_bump", overrides={"wear": {"acceleration": 2.0e5}}).runs[0].parameters
    assert cycles(run) == pytest.approx(191, abs=1)
    assert cycles(twice) == pytest.approx(2 * 191, abs=1)


def test_seconds_of_a_job():
    """Particle steps, triangle steps, cycles and starts of jobs, the mesh's included; of a shared run its job alone."""
    found = forecast_table([job(), job("b", stages=())], RATES).set_index("job")
    assert found["solver_s"].tolist() == pytest.approx([1.0 + 0.001, 0.0], rel=EXACT)
    assert found["outside_s"].tolist() == pytest.approx([4 * 2.0 + 2.0, 1.0], rel=EXACT)
    assert found.loc["worn_run_a", "core_h"] == pytest.approx((1.001 + 10.0) / 3600.0, rel=EXACT)


def test_stages_add_up():
    """Two stages cost what both cost alone; sizes are the largest, steps and cycles the sum."""
    stages = (Stage(1, 500, 2000.0, 10.0), Stage(3, 1500, 1000.0, 30.0, 7.0, True, 40.0))
    both = forecast_table([job(stages=stages)], RATES).iloc[0]
    parts = forecast_table([job(stages=(stage,)) for stage in stages], RATES)
    assert both["solver_s"] == pytest.approx(parts["solver_s"].sum(), rel=EXACT)
    assert (both["particles"], both["triangles"], both["steps"], both["cycles"]) == (2000, 30, 2000, 3)


def test_ranks_and_simulations_side_by_side():
    """They share the solver's work, take as many cores, and need no other core hours."""
    one, two = (forecast_table([job(**more)], RATES).iloc[0] for more in ({}, {"ranks": 2, "parallel": 3}))
    assert two["core_h"] == one["core_h"] and two["cores"] == 6
    assert two["wall_h"] * 3600.0 == pytest.approx(one["solver_s"] / 6 + one["outside_s"], rel=EXACT)


def test_memory_grows_with_what_is_simulated():
    """An empty job needs driver and solver; three simulations side by side three solvers."""
    empty = job(stages=(Stage(1, 1, 0.0),))
    assert memory(empty) == DRIVER_MEMORY + SOLVER_MEMORY and memory(job(stages=())) == DRIVER_MEMORY
    assert memory(job(stages=empty.stages, parallel=3)) == DRIVER_MEMORY + 3 * SOLVER_MEMORY
    assert memory(job()) > memory(empty)


def jobs_table(*rows):
    """A table of jobs: name, wall hours, cores, need."""
    return pd.DataFrame(rows, columns=["job", "wall_h", "cores", "needs"])


@pytest.mark.parametrize(("cores", "hours"), [(1, 10.0), (2, 6.0), (3, 5.0), (64, 5.0)])
def test_wall_time_of_a_bed_and_its_runs(cores, hours):
    """A bed of 1 h, then runs of 4, 3 and 2 h: one after the other, two at a time, all at once."""
    table = jobs_table(("bed", 1.0, 1, ""), ("a", 4.0, 1, "bed"), ("b", 3.0, 1, "bed"), ("c", 2.0, 1, "bed"))
    assert wall_hours(table, cores) == pytest.approx(hours, rel=EXACT)


def test_a_job_wider_than_the_machine_takes_longer():
    """Four ranks on two cores take twice as long, and nothing runs beside them."""
    assert wall_hours(jobs_table(("a", 1.0, 4, ""), ("b", 1.0, 1, "")), 2) == pytest.approx(3.0, rel=EXACT)


def test_needs_that_are_done_already_are_not_waited_for():
    """Of a study of which the beds are there only the runs are forecast."""
    assert wall_hours(jobs_table(("a", 2.0, 1, "bed")), 1) == 2.0


def test_the_text_has_a_line_per_job_the_totals_and_where_rates_come_from(repository):
    """What a person reads: jobs, core hours, wall time on these and on more cores, whose rates they are."""
    study, found = load_study("screening", overrides={"fidelity": "paper"}), read_rates(repository / DEFAULT)
    table = forecast_table(work_of(study), found.rates)
    text = forecast_text("screening, fidelity paper", study.name, table, 2, found.said())
    assert all(f"\n{name} " in text for name in table["job"])
    assert f"screening: {len(table)} jobs of the solver, about {table['core_h'].sum():,.0f} core hours" in text
    assert "16: " in text and "256: " in text and "DEFAULT RATES OF ANOTHER MACHINE" in text


def test_the_announcement_counts_what_is_left(repository, tmp_path, monkeypatch):
    """Before a study runs its missing jobs are told in one line; the ones that are done do not count."""
    monkeypatch.chdir(tmp_path)
    study = load_study("demo")
    table = forecast_table(work_of(study), read_rates(repository / DEFAULT).rates)
    last = table[table["job"] == "worn_run_R5_plain"]
    said = announcement(study, {"worn_run_R5_plain"}, 2)
    assert said.startswith("Forecast of demo: 1 job of the solver") and "\n" not in said
    assert duration_text(3600.0 * totals(last, 2)["wall_h"]) in said


def test_damaged_rates_do_not_stop_a_study(repository, tmp_path, monkeypatch):
    """The line says what is wrong instead of a forecast."""
    study = load_study("demo")
    (tmp_path / "cost_rates.json").write_text("{")
    monkeypatch.setattr(forecast, "rates_file", lambda: tmp_path / "cost_rates.json")
    assert announcement(study, {"worn_run_R5_plain"}, 2).startswith(f"No forecast: {tmp_path}/cost_rates.json: no file")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.verify if name in OF_CAD else ()) for name in list_studies()]
)
def test_every_job_asks_for_more_than_its_forecast(name):
    """All beds, runs and calibrations of a study are there, each with more time and memory than it is forecast to need,
    and with half as much again and a start-up at most twice over."""
    study = load_study(name, overrides={"fidelity": "paper"})
    table = forecast_table(work_of(study), read_rates(rates_file()).rates).set_index("job")
    asked = demands(study)
    assert set(asked) == set(table.index)
    for job, (runtime, room, _) in asked.items():
        needed, largest = 60.0 * table.loc[job, "wall_h"], 1e3 * table.loc[job, "memory_gb"]
        assert 1.5 * needed < runtime <= 2.0 * needed + LEAST_MINUTES + 1
        assert largest < room <= 2.0 * largest + LEAST_MEMORY_MB + 1


def test_steps_of_a_large_bed_are_reported_seldom():
    """A share of the longest deck, of all stages that it has; what goes on with a deck belongs to it."""
    steps, rates = 1e6, dict.fromkeys(TERMS, 0.0) | {"steps": 60.0 * REPORTS_PER_DECK / 1e6}  # a minute each
    filled = (Stage(1, steps, 10.0), Stage(0, 2.0 * steps, 10.0), Stage(4, 4.0 * steps, 10.0))
    assert step_core_minutes(Work("settled_bed", ("bed_A",), filled), rates) == 3
    assert step_core_minutes(Work("worn_run", ("A",), ()), rates) == 0
    tester = load_study("circular_tester", overrides={"fidelity": "paper"})
    longest = max(minutes for name, (_, _, minutes) in demands(tester).items() if name.startswith("settled_bed"))
    assert longest > Patience().stopped_min


def test_nothing_to_do_still_takes_a_start():
    """A job whose simulation another one has done asks for the time and memory of Python alone."""
    assert (minutes(0.0), megabytes(0.0)) == (LEAST_MINUTES, LEAST_MEMORY_MB)


def test_the_profile_lets_jobs_come_back():
    """No job may ask for more than a longest one, so an interrupted one must be submitted again and be taken up."""
    there, here = (yaml.safe_load((PROFILES / name / "config.yaml").read_text()) for name in ("slurm", "default"))
    assert there["executor"] == "slurm"
    assert there["retries"] > 1 and there["rerun-incomplete"]
    assert {"runtime", "mem_mb"} <= set(there["resources"])
    patience = here.pop("default-resources")  # with how long a silent solver is waited for
    assert patience.items() <= there["default-resources"].items()
    assert {key: there[key] for key in here if key != "cores"} == {key: here[key] for key in here if key != "cores"}
