"""Measure the rates of the cost model on this machine, in a minute or two: small runs of real decks.

A bed of some 15,000 particles is filled, and slides over a sample of two mesh sizes; a pin goes round on a disc of two
mesh sizes. As many copies of that run side by side as a study has cores: they share the machine's memory and caches,
as the runs of a study do. Times are processor times, so that other work on the machine disturbs them little: what a
`run` command of a deck took by the solver's clock, times the share of a processor that its program had; the median of
the copies.
"""

from __future__ import annotations

import io
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import pandas as pd

import bulkwear
from bulkwear.postproc.mesh import read_surface, write_surface
from bulkwear.postproc.readers.solver_log import run_times
from bulkwear.workflows.config.design import Study, load_study
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.chain import Chain, span_of
from bulkwear.workflows.engine.cycles import fill_bed, run_cycle
from bulkwear.workflows.engine.inputs import inputs_digest
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.schedule import Span
from bulkwear.workflows.engine.solver import LOG, die_with, processor_seconds
from bulkwear.workflows.engine.work import Stage
from bulkwear.workflows.forecast.rates import MachineRates, fitted_rates, machine_facts, seconds

BED_STUDY, BED_RUN = "demo", "R5_plain"
PIN_STUDY, PIN_RUN = "pin_on_disc", "c17-conserving"
SHRUNK = {
    "fidelity": "quick",
    "packings": 1,
    "particle_scale": 1.75,  # fewer particles fit into a processor's cache, and each costs less
    "sliding": {"run_in_mm": 4, "travel_mm": 8, "cycles": 2},
    "solver": {"ranks": 1, "rayleigh_fraction": 0.4},
    "ledger": "solver",
}
SAMPLES = {  # both start from the same bed: it is as long and lies as far ahead of the middle of either
    "small sample": {
        "sample": {"width_mm": 40, "length_mm": 40, "element_size_mm": 2.0},
        "bed": {"width_mm": 100, "ahead_mm": 180, "behind_mm": 80},
    },
    "large sample": {
        "sample": {"width_mm": 80, "length_mm": 80, "element_size_mm": 1.2},
        "bed": {"width_mm": 100, "ahead_mm": 160, "behind_mm": 60},
    },
}
DISCS = {
    "coarse disc": {"disc": {"element_size_mm": 0.25}},
    "fine disc": {"disc": {"element_size_mm": 0.1}},
}
JOB = (
    "import bulkwear.workflows.engine.cycles, bulkwear.postproc.wear.remesh"  # what a job that runs wear cycles imports
)
GROUPS = {  # kind of measurement -> the rates that those of its kind tell, given the ones above
    "neighbour lists": ("particle_builds",),
    "steps": (
        *("steps", "particle_steps", "moving_particle_steps"),
        *("particle_builds", "triangle_steps", "loaded_triangle_steps"),
    ),
    "start": ("decks", "triangles_read"),
    "wear update": ("cycles", "worn_triangles"),
    "mesh": ("meshed_triangles",),
    "job": ("jobs",),
}
MOST_COPIES = 8  # side by side: more processors share no more of a cache, and each copy needs its memory
LEAST_SECONDS = 0.1  # processor time of a `run` command; shorter ones tell more about the clock
Say = Callable[[str], None]


@dataclass(frozen=True)
class Measurement:
    """Processor time (s) of a piece of work; kind: of `GROUPS`; terms: amounts of work of the cost model."""

    kind: str
    what: str
    terms: Mapping[str, float]
    seconds: float


def measured_rates(folder: Path, say: Say, cores: int = 1) -> MachineRates:
    """Return the rates of this machine for runs that share so many cores; simulates in an empty folder.

    There are as many copies side by side as cores, `MOST_COPIES` at most, and each part of the work is begun by all of
    them together. Raises SolverError and what runs raise.
    """
    copies = [folder / f"copy_{number}" for number in range(min(cores, MOST_COPIES))]
    found: list[list[Measurement]] = [[] for _ in copies]
    parts = [(_sliding, *sample) for sample in SAMPLES.items()] + [(_pin, *disc) for disc in DISCS.items()]
    # processes, because a process knows the processor time of all that it has started, and of nothing else
    with ProcessPoolExecutor(len(copies), initializer=die_with(os.getpid())) as pool:
        for number, (part, title, settings) in enumerate(parts, start=1):
            say(f"part {number} of {len(parts)}, {title}, {len(copies)} side by side")
            for of_copy, more in zip(found, pool.map(partial(part, title, settings), copies), strict=True):
                of_copy += more
        jobs = pool.map(_job, copies)
        found = [[*of_copy, job] for of_copy, job in zip(found, jobs, strict=True)]
    return rates_from(typical(found), len(copies))


def typical(copies: Sequence[Sequence[Measurement]]) -> list[Measurement]:
    """Return the measurements of one copy, each with the median of the seconds that all copies took for it."""
    same: dict[tuple[str, str], list[Measurement]] = {}
    for each in (each for found in copies for each in found):
        same.setdefault((each.kind, each.what), []).append(each)
    return [replace(found[0], seconds=statistics.median(each.seconds for each in found)) for found in same.values()]


def rates_from(measured: Sequence[Measurement], side_by_side: int = 1) -> MachineRates:
    """Return the rates that measurements tell, group by group, and how well each is met; side_by_side: copies."""
    rates: dict[str, float] = {}
    for kind, terms in GROUPS.items():
        told = [each for each in measured if each.kind == kind]
        work = pd.DataFrame([{term: each.terms.get(term, 0.0) for term in terms} for each in told])
        known = {term: rates[term] for term in terms if term in rates}
        rates |= fitted_rates(work, [each.seconds for each in told], known)
    fit = {
        f"{each.kind}, {each.what}": round(
            float(seconds(pd.DataFrame([each.terms]), rates, list(each.terms))[0]) / each.seconds, 3
        )
        for each in measured
    }
    return MachineRates(rates, machine_facts(), time.strftime("%Y-%m-%d"), fit, side_by_side)


# ---------------------------------------------------------------- what is simulated


def _sliding(title: str, settings: Mapping[str, Mapping[str, float]], folder: Path) -> list[Measurement]:
    """Return what a bed on a plain sample tells: filled once, lowered, run in, two wear cycles."""
    study = load_study(BED_STUDY, overrides=SHRUNK | dict(settings))
    name, bed_folder = study.bed_of(BED_RUN), folder / "bed"
    found = []
    if not bed_folder.exists():
        fill_bed(study.case, name, study.beds[name], bed_folder)
        cost = pd.read_csv(bed_folder / "cost.csv").iloc[0].to_dict()
        found += _loops(f"bed for the {title}", bed_folder, cost, 0, slides=False)
    chain, meshed = _chain(study, BED_RUN, title, folder)
    found += [meshed, *_cycle(chain, title, None, slides=True)]
    return found + [each for cycle in (1, 2) for each in _cycle(chain, title, span_of(chain, cycle), slides=True)]


def _pin(title: str, settings: Mapping[str, Mapping[str, float]], folder: Path) -> list[Measurement]:
    """Return what the first wear cycle of a pin on a disc tells."""
    study = load_study(PIN_STUDY, overrides={"fidelity": "quick", **settings})
    chain, meshed = _chain(study, PIN_RUN, title, folder)
    set_down = _cycle(chain, title, None, slides=False)
    return [meshed, *set_down, *_cycle(chain, title, span_of(chain, 1), slides=False)]


def _chain(study: Study, run: str, title: str, folder: Path) -> tuple[Chain, Measurement]:
    """Return a run as the driver sees it, its surface made, and what that took."""
    parameters, bed = study.run(run).parameters, study.bed_of(run)
    surface = folder / title.replace(" ", "_") / "surface.vtu"
    surface.parent.mkdir(parents=True)
    started = time.process_time()
    mesh = study.case.surface_mesh(parameters)
    meshed = Measurement("mesh", title, {"meshed_triangles": len(mesh.triangles)}, time.process_time() - started)
    write_surface(surface, mesh)
    beds = (study.beds[bed], folder / "bed" / "bed.restart") if bed else (None, None)
    return Chain(title, surface.parent, study.case, parameters, surface, *beds), meshed


def _cycle(chain: Chain, title: str, span: Span | None, slides: bool) -> list[Measurement]:
    """Run a cycle and return what it tells; slides: whether the bulk does so in the last of its `run` commands."""
    cycle, started = span.cycle if span else 0, time.process_time()
    run_cycle(chain, span, inputs_digest(chain), Progress(title, 1, stream=io.StringIO()))  # of a part of a run: untold
    outside = time.process_time() - started
    what, done = f"{title}, cycle {cycle}", state.read_state(chain.folder, cycle)["cost"]
    found = _loops(what, state.cycle_folder(chain.folder, cycle), done, done["triangles"], slides)
    in_steps = sum(each.seconds for each in found if each.kind == "steps")
    start = {"decks": 1, "triangles_read": done["triangles"]}
    found.append(Measurement("start", what, start, done["processor_s"] - in_steps))
    if span:
        whole = len(read_surface(chain.surface).triangles)
        found.append(Measurement("wear update", what, {"cycles": 1, "worn_triangles": whole}, outside))
    return found


def _loops(what: str, folder: Path, cost: Mapping[str, float], triangles: int, slides: bool) -> list[Measurement]:
    """Return what the `run` commands of a finished deck tell, set-up steps left out; slides: see `_cycle`."""
    times = pd.DataFrame(run_times(folder / LOG))
    times, share = times[times["steps"] > 1], cost["processor_s"] / cost["solver_s"]
    found = []
    for number, run in enumerate(times.itertuples(), start=1):
        if share * run.loop_s < LEAST_SECONDS:
            continue
        moving = slides and number == len(times)
        stage = Stage(0, run.steps, run.particles, triangles, run.builds, moving)
        terms = {term: stage.terms()[term] for term in GROUPS["steps"]}
        found.append(Measurement("steps", f"{what}, run {number}", terms, share * run.loop_s))
        if moving:
            lists = {"particle_builds": run.particles * run.builds}
            found.append(Measurement("neighbour lists", f"{what}, run {number}", lists, share * run.neighbour_s))
    return found


def _job(folder: Path) -> Measurement:
    """Return what starting a job of the workflow and importing what it needs takes; it needs no folder."""
    before = processor_seconds()
    subprocess.run([sys.executable, "-c", JOB], cwd=Path(bulkwear.__file__).parents[1], check=True)
    return Measurement("job", "imports", {"jobs": 1}, processor_seconds() - before)
