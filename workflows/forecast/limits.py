"""What exceeds this machine is refused before it starts: memory, disk, a year, ranks; unless the study asks for it.

Forecasts are good to a factor of two or so (docs/forecast.md); what is refused here is far beyond any doubt, or would
take the machine down with it.
"""

from __future__ import annotations

import os
from collections.abc import Collection

from bulkwear.postproc.readers.cycle_folders import cycle_folders
from bulkwear.workflows.config.design import Study
from bulkwear.workflows.engine.disk import folder_bytes, free_bytes
from bulkwear.workflows.engine.machine import machine_facts
from bulkwear.workflows.engine.project import current_project
from bulkwear.workflows.engine.work import Work
from bulkwear.workflows.forecast.forecast import (
    GIGABYTE,
    WORN_TRIANGLE_MEMORY,
    forecast_table,
    hours_text,
    number_text,
    wall_hours,
    work_of,
)
from bulkwear.workflows.forecast.rates import Rates, RatesError, rates_file, read_rates

ALLOWED = "beyond_machine"  # key of the settings
HOURS_PER_YEAR = 8766.0
RANKS_PER_CORE = 32  # more are a slip; fewer are a study for another machine, of which this one starts as many as cores


def fault_here(study: Study, jobs: Collection[str], meshed: Collection[str]) -> str | None:
    """Return what `fault_of_machine` does, of this machine; None where its rates cannot be read, which is told."""
    try:
        rates = read_rates(rates_file()).rates
    except RatesError:
        return None
    cores, memory_gb = os.cpu_count() or 1, machine_facts()["memory_gb"]
    free_gb = free_bytes(current_project().folder) / GIGABYTE + held_gb(study, jobs)
    return fault_of_machine(study, jobs, meshed, rates, cores, memory_gb, free_gb)


def held_gb(study: Study, jobs: Collection[str]) -> float:
    """Return what an interrupted start has left of those jobs already, GB, of each at most what it will have."""
    results = current_project().folder / "results" / study.name
    folders = {f"settled_bed_{bed}": [results / "beds" / bed] for bed in study.beds}
    folders |= {f"worn_run_{run.name}": cycle_folders(results / run.name) for run in study.runs}
    foreseen = {job.name: job.disk_bytes for job in work_of(study) if job.name in jobs}
    held = {name: sum(map(folder_bytes, folders.get(name, ()))) for name in foreseen}
    return sum(min(held[name], foreseen[name]) for name in foreseen) / GIGABYTE


def fault_of_machine(
    study: Study,
    jobs: Collection[str],
    meshed: Collection[str],
    rates: Rates,
    cores: int,
    memory_gb: float,
    free_gb: float,
) -> str | None:
    """Return why those jobs of a study cannot be done on a machine, a sentence; None where they can, or the study says
    that they are to be begun.

    jobs: names of jobs that call the solver; meshed: runs whose surface is still to be made; cores, memory_gb, free_gb:
    of the machine, the last one of the disk
    """
    if study.settings.get(ALLOWED):
        return None
    work = {job.name: job for job in work_of(study)}
    found = [work[name] for name in jobs if name in work]
    fault = (
        _too_many_ranks(study, found, cores)
        or _too_large_a_mesh(meshed, work, memory_gb)
        or _too_much(found, rates, cores, memory_gb, free_gb)
    )
    return fault and (
        f"{study.name}: {fault}; allowed is what this machine can do, or {ALLOWED}: true in the study, which begins it"
        " nevertheless."
    )


def _too_many_ranks(study: Study, jobs: list[Work], cores: int) -> str | None:
    ranks = study.settings["solver"]["ranks"]
    if not jobs or ranks <= RANKS_PER_CORE * cores:
        return None
    return f"solver.ranks is {ranks}, this machine has {cores} cores"


def _too_large_a_mesh(meshed: Collection[str], work: dict[str, Work], memory_gb: float) -> str | None:
    for run in meshed:
        job = work.get(f"worn_run_{run}")
        triangles = job.surface_triangles if job else 0.0
        if (needed := WORN_TRIANGLE_MEMORY * triangles / GIGABYTE) > memory_gb:
            return (
                f"the surface of {run} has about {number_text(triangles)} triangles and needs about"
                f" {number_text(needed)} GB of memory, this machine has {number_text(memory_gb)} GB; larger elements"
                " need less"
            )
    return None


def _too_much(jobs: list[Work], rates: Rates, cores: int, memory_gb: float, free_gb: float) -> str | None:
    if not jobs:
        return None
    table = forecast_table(jobs, rates)
    largest = table.loc[table["memory_gb"].idxmax()]
    if largest["memory_gb"] > memory_gb:
        needed = number_text(largest["memory_gb"])
        return (
            f"{largest['job']} needs about {needed} GB of memory, this machine has {number_text(memory_gb)} GB; larger"
            " elements or a larger particle_scale need less"
        )
    if (disk := float(table["disk_gb"].sum())) > free_gb:
        return f"its jobs leave about {number_text(disk)} GB on the disk, {number_text(free_gb)} GB are free"
    if (hours := wall_hours(table, cores)) > HOURS_PER_YEAR:
        return f"its jobs take about {hours_text(hours)} on {cores} cores, which is more than a year"
    return None


def fault_of_budget(study: Study) -> str | None:
    """Return why the budget of a study's search does not hold its first rows, one round and what confirms the best, a
    sentence; None where it does, or rates cannot be read, which is told.
    """
    try:
        rates = read_rates(rates_file()).rates
    except RatesError:
        return None
    search = study.optimise
    written = [name for name in study.first_packings if name not in search.rows]
    least = study.with_packings(search.foreseen(written, search.first_rows + search.rows_of_round + 1))
    hours = float(forecast_table(work_of(least), rates)["core_h"].sum())
    if hours <= search.most_core_h:
        return None
    return (
        f"{study.name}: optimise.most_core_h is {search.most_core_h:g}, allowed are about {number_text(hours)} or more:"
        f" the forecast of {search.first_rows} first rows, a round of {search.rows_of_round}, and what confirms the"
        " best."
    )
