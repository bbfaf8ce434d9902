"""What a study will cost before it runs: seconds, memory and disk of its jobs from their work and the machine's rates.

A core hour is an hour of one core's processor time. Sizes are those of `Case.work`; nothing is meshed or simulated.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Collection, Mapping, Sequence

import pandas as pd

from bulkwear.workflows.config.design import Study
from bulkwear.workflows.engine.job import duration_text
from bulkwear.workflows.engine.work import Jobs, Work
from bulkwear.workflows.forecast.rates import (
    OUTSIDE_TERMS,
    SOLVER_TERMS,
    TERMS,
    Rates,
    RatesError,
    rates_file,
    read_rates,
    seconds,
)

WORN_TRIANGLE_MEMORY, DRIVER_MEMORY = 3.1e3, 2.25e8
MORE_CORES = (16, 64, 256)  # numbers of cores for which the wall time of a study is told besides the present one
SECONDS_PER_MINUTE, SECONDS_PER_HOUR, GIGABYTE = 60.0, 3600.0, 1e9
REPORTS_PER_DECK = 10  # -, steps at least that a solver reports of a deck of hours; those of this package have 15 to 60
TIME_MARGIN = 2.0  # -, over the forecast: ranks do not share all work evenly, and nodes differ
LEAST_MINUTES = 10  # Python, its libraries and a slow file system
MEMORY_MARGIN = 1.5  # -, over the forecast
LEAST_MEMORY_MB = 1000
# Memory of a job, measured as the largest resident sets of solver and driver. B per particle, per triangle, B alone.
PARTICLE_MEMORY, SOLVER_TRIANGLE_MEMORY, SOLVER_MEMORY = 1.3e3, 3.4e3, 3.5e7  # per rank at most
SHOWN = {  # column of the table -> heading of the printed one
    "job": "job",
    "particles": "particles",
    "triangles": "triangles",
    "steps": "steps",
    "cycles": "cycles",
    "core_h": "core hours",
    "wall_h": "wall hours",
    "memory_gb": "memory GB",
    "disk_gb": "disk GB",
}


def work_of(study: Study) -> Jobs:
    """Return the jobs of a study that call the solver: what its case has besides, then beds, then runs."""
    bed_of = {run.name: bed for run in study.runs if (bed := study.bed_of(run.name))}
    work = study.case.work(study.runs, study.beds, bed_of, study.settings["solver"]["ranks"])
    return Jobs((*study.case.further_work(study), *work))


def forecast_table(work: Sequence[Work], rates: Rates) -> pd.DataFrame:
    """Return a row per job: sizes, processor seconds in the solver and outside, core and wall hours, memory, disk.

    particles, triangles: most that the solver has at once; steps, cycles: in all. Wall time is that of the job alone;
    ranks and simulations side by side are taken to share the solver's work evenly.
    """
    amounts = [_amounts(job) for job in work]
    terms = pd.DataFrame(amounts, columns=list(TERMS))
    solver, outside = (seconds(terms, rates, of).tolist() for of in (SOLVER_TERMS, OUTSIDE_TERMS))
    return pd.DataFrame([_row(*of_job) for of_job in zip(work, amounts, solver, outside, strict=True)])


def _amounts(job: Work) -> dict[str, float]:
    """Return how much of each of `TERMS` a job has."""
    meshed = job.surface_triangles
    around = {"jobs": 2 if meshed else 1, "meshed_triangles": meshed}  # the job itself, and that of its mesh
    found = [*(stage.terms() for stage in job.stages), around]
    return {term: float(sum(each.get(term, 0.0) for each in found)) for term in TERMS}


def _row(job: Work, amounts: Mapping[str, float], solver: float, outside: float) -> dict[str, float | str]:
    """Return a row of `forecast_table`; solver, outside: s."""
    return {
        "job": job.name,
        "particles": round(max((stage.particles for stage in job.stages), default=0)),
        "triangles": round(max((stage.triangles for stage in job.stages), default=0)),
        "steps": round(amounts["steps"]),
        "cycles": round(amounts["cycles"]),
        "solver_s": solver,
        "outside_s": outside,
        "core_h": (solver + outside) / SECONDS_PER_HOUR,
        "wall_h": (solver / (job.ranks * job.parallel) + outside) / SECONDS_PER_HOUR,
        "cores": job.ranks * job.parallel,
        "needs": job.needs,
        "memory_gb": memory(job) / GIGABYTE,
        "disk_gb": job.disk_bytes / GIGABYTE,
    }


def memory(job: Work) -> float:
    """Return about how much memory (B) a job needs at most: its simulations, and the driver with the whole surface."""
    sizes = [PARTICLE_MEMORY * stage.particles + SOLVER_TRIANGLE_MEMORY * stage.triangles for stage in job.stages]
    solvers = job.parallel * (max(sizes) + job.ranks * SOLVER_MEMORY) if sizes else 0.0
    return solvers + DRIVER_MEMORY + WORN_TRIANGLE_MEMORY * job.surface_triangles


def wall_hours(table: pd.DataFrame, cores: int) -> float:
    """Return the wall time (h) of jobs on that many cores: each starts, in their order, as soon as what it needs is
    done and its cores are free.

    A job that wants more cores than there are gets all of them and takes as much longer. What a job needs that is not
    in the table counts as done.
    """
    waiting, running, done = table.to_dict("records"), [], set()
    free, now, names = cores, 0.0, set(table["job"])
    while waiting or running:
        for job in list(waiting):
            taken = min(job["cores"], cores)
            if taken <= free and (job["needs"] not in names or job["needs"] in done):
                heapq.heappush(running, (now + job["wall_h"] * job["cores"] / taken, job["job"], taken))
                free -= taken
                waiting.remove(job)
        now, name, taken = heapq.heappop(running)
        free += taken
        done.add(name)
    return now


def totals(table: pd.DataFrame, cores: int) -> dict[str, float]:
    """Return core hours, wall hours on that many cores, most memory (GB) of a job and disk (GB) of all jobs."""
    return {
        "jobs": len(table),
        "core_h": float(table["core_h"].sum()),
        "wall_h": wall_hours(table, cores),
        "memory_gb": float(table["memory_gb"].max()),
        "disk_gb": float(table["disk_gb"].sum()),
    }


def forecast_text(heading: str, study: str, table: pd.DataFrame, cores: int, said: str) -> str:
    """Return the forecast as people read it: a line per job, totals, wall time on more cores, what it rests on."""
    rows = [[number_text(row[column]) for column in SHOWN] for row in table.to_dict("records")]
    more = ", ".join(f"{n}: {hours_text(wall_hours(table, n))}" for n in MORE_CORES if n > cores)
    return "\n".join(
        [
            f"Forecast of {heading}",
            "",
            *aligned([list(SHOWN.values()), *rows]),
            "",
            summary_line(study, totals(table, cores), cores) + ".",
            f"Wall time on more cores: {more}.",
            "Ranks of a run (solver.ranks) are taken to share its work evenly.",
            f"By {said}.",
            "Meshes, particles and steps are estimated, not made; tables, figures and pages are not counted.",
            "",
        ]
    )


def announcement(study: Study, jobs: Collection[str], cores: int) -> str:
    """Return in one line what those jobs of a study will cost, or what is wrong with the rates."""
    try:
        found = read_rates(rates_file())
    except RatesError as fault:
        return f"No forecast: {fault}"
    table = table_of_jobs(study, jobs, found.rates)
    return f"Forecast of {summary_line(study.name, totals(table, cores), cores)}; by {found.said()}."


def table_of_jobs(study: Study, jobs: Collection[str], rates: Rates) -> pd.DataFrame:
    """Return the `forecast_table` of some jobs of a study, by their names."""
    return forecast_table([job for job in work_of(study) if job.name in jobs], rates)


def summary_line(name: str, found: Mapping[str, float], cores: int) -> str:
    """Return what a study costs in one line."""
    hours, memory_gb, disk_gb = (number_text(found[key]) for key in ("core_h", "memory_gb", "disk_gb"))
    return (
        f"{name}: {found['jobs']} job{'s' * (found['jobs'] > 1)} of the solver, about {hours} core hours,"
        f" {hours_text(found['wall_h'])} on {cores} core{'s' * (cores > 1)}, up to {memory_gb} GB of memory per job,"
        f" {disk_gb} GB on disk"
    )


def hours_text(hours: float) -> str:
    """Return hours as people say them; days from two on."""
    return f"{hours / 24.0:.1f} days" if hours >= 48.0 else duration_text(SECONDS_PER_HOUR * hours)


def number_text(value: float | str) -> str:
    """Return a number with three digits at least and no exponent, small ones to the third decimal; words unchanged."""
    if isinstance(value, str):
        return value
    return (
        f"{value:,.0f}" if value >= 100 or value == round(value) else f"{value:.3g}" if value >= 0.1 else f"{value:.3f}"
    )


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return rows of text as lines with aligned columns, the first one to the left."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if k == 0 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]


def demands(study: Study) -> dict[str, tuple[int, int, int]]:
    """Return the minutes and MB that the jobs of a study which call the solver ask for at first, by their names, and
    the core minutes between two steps that a solver reports, see `step_core_minutes`.

    Raises RatesError.
    """
    work, rates = work_of(study), read_rates(rates_file()).rates
    return {
        row["job"]: (minutes(row["wall_h"]), megabytes(row["memory_gb"]), step_core_minutes(job, rates))
        for job, row in zip(work, forecast_table(work, rates).to_dict("records"), strict=True)
    }


def step_core_minutes(job: Work, rates: Rates) -> int:
    """Return about the most core minutes that pass between two steps that a job's solver reports, rounded up."""
    decks: list[tuple[float, float]] = []  # how many of a kind, and the core seconds of all of them
    for stage in job.stages:
        terms = stage.terms()
        spent = sum(terms[term] * rates[term] for term in SOLVER_TERMS)
        if stage.decks or not decks:
            decks.append((max(stage.decks, 1), spent))
        else:  # it goes on with the deck before
            decks[-1] = decks[-1][0], decks[-1][1] + spent
    longest = max((spent / count for count, spent in decks), default=0.0)
    return math.ceil(longest / REPORTS_PER_DECK / SECONDS_PER_MINUTE)


def minutes(wall_hours: float) -> int:
    """Return the minutes to ask for, for work that is expected to take so long (h)."""
    return LEAST_MINUTES + math.ceil(SECONDS_PER_HOUR / SECONDS_PER_MINUTE * TIME_MARGIN * wall_hours)


def megabytes(gigabytes: float) -> int:
    """Return the MB to ask for, for work that is expected to need so many GB, of all ranks together."""
    return LEAST_MEMORY_MB + math.ceil(1e3 * MEMORY_MARGIN * gigabytes)
