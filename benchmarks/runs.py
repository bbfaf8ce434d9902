"""Runs of benchmarks: those of a study, changed as no configuration allows, and simulated from where they stopped."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import pandas as pd

from benchmarks.command_line import read_table
from bulkwear.postproc.mesh import PLAIN, SurfaceMesh, read_surface, write_surface
from bulkwear.postproc.readers.solver_log import thermo_table
from bulkwear.workflows.cases.sliding_sample.parameters import derived_parameters
from bulkwear.workflows.config.design import Run, Study, load_study
from bulkwear.workflows.config.layers import merge
from bulkwear.workflows.config.patterns import sample_surface
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.cases import Case
from bulkwear.workflows.engine.chain import RESTART, Chain, run_in_steps, write_cycle, write_shared_files
from bulkwear.workflows.engine.cycles import fill_bed, run_chain, run_cycle
from bulkwear.workflows.engine.inputs import bed_digest, inputs_digest, run_digest, surface_from
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.schedule import first_span
from bulkwear.workflows.engine.solver import LOG, SolverError, SolverStoppedError
from bulkwear.workflows.report.simulated import versions_of

STUDY, RUN, TESTER = "demo", "R5_convex", "circular_tester"
SMALL_BUMPS = {"rows": ["R9"]}  # a pattern for samples smaller than the demo's
STRAIGHT_RAMP = {"height_above_floor_mm": 0.1, "skirt_radius_mm": 0}  # of a sample that is no faster than 1 m/s
PUBLISHED_PAIR = "river_gravel_published"  # of all rolling models alike; the recommended one is of own_spin alone
DIGITS = 12  # of a hash, in the name of a folder
BY = "simulated_by"  # column of a table of simulations: version of the code
Asked, Answer = TypeVar("Asked"), TypeVar("Answer")
FIRST_SEED = 20220317  # of sliding samples in the studies; further packings are SEED_SPACING apart, as theirs


def changed(run: Run, change: Mapping[str, Any]) -> Run:
    """Return the run with other parameters and what follows from them.

    change: nested, SI, as the parameters; a section that the run does not have, such as a plain sample's pattern, is
    left out
    """
    given: dict[str, Any] = {key: value for key, value in run.parameters.items() if key != "derived"}
    given = merge(given, {key: value for key, value in change.items() if given[key] is not None})
    return replace(run, parameters={**given, "derived": derived_parameters(given)})


def side_by_side(
    name: str,
    asked: Sequence[Asked],
    is_there: Callable[[Asked], bool],
    answer: Callable[[Asked], Answer],
    cores: int,
) -> list[Answer]:
    """Return the answer to each that is asked, up to `cores` of them simulated at the same time.

    name: of the benchmark, begins each line of progress, which counts those whose simulation is not there
    """
    missing = [not is_there(each) for each in asked]
    progress, lock, done = Progress(name, sum(missing)), threading.Lock(), 0

    def one(each: Asked, is_missing: bool) -> Answer:
        nonlocal done
        found = answer(each)
        with lock:
            done += is_missing
            if is_missing:
                progress.update(done, f"{done} of {progress.total} simulated")
        return found

    with ThreadPoolExecutor(cores) as pool:
        return list(pool.map(one, asked, missing))


def attempted(task: Callable[[], object], failed: Path, faults: tuple[type[Exception], ...] = ()) -> None:
    """Do a task, or leave in a file why its simulation failed: it fails again, so it is not tried another time.

    failed: the file; where it is there nothing is done
    faults: further errors that are answers, besides those of the solver

    Raises SolverStoppedError: the machine ended that simulation, which may go on.
    """
    if failed.exists():
        return
    try:
        task()
    except SolverStoppedError:
        raise
    except (SolverError, *faults) as fault:
        failed.write_text(str(fault), encoding="utf-8")


def simulated_by(folder: Path) -> str:
    """Return the version of the code that simulated what is in a folder of cycles."""
    return " and ".join(sorted(version.name for version in versions_of([folder])))


def with_earlier(file: Path, found: pd.DataFrame, keys: Sequence[str]) -> pd.DataFrame:
    """Return a table of simulations, and behind it the rows of an earlier one that it does not have, by their keys.

    Simulations outlive no machine, so their table does not end with the folder that holds them; BY tells who made each.
    """
    if not file.is_file():
        return found
    both = pd.concat([found, read_table(file, keys)], ignore_index=True)
    return both.drop_duplicates(list(keys), keep="first", ignore_index=True)


def with_bed(chain: Chain, bed_name: str) -> Chain:
    """Return the chain, its bed filled unless it is there."""
    if not chain.bed_restart.with_name("cost.csv").exists():
        fill_bed(chain.case, bed_name, chain.bed, chain.bed_restart.parent, ranks=chain.ranks)
    return chain


def simulated_run(chain: Chain, bed_name: str) -> Chain:
    """Return the chain, simulated from where it stopped; sample and bed made unless they are there.

    What lies in its folder and was simulated from anything else is moved aside and simulated anew.
    """
    with_bed(chain, bed_name)
    if not chain.surface.exists():
        write_surface(chain.surface, chain.case.surface_mesh(chain.parameters))
    if not is_simulated(chain):
        run_chain(chain)
    return chain


def is_simulated(chain: Chain) -> bool:
    """Return whether a run is finished, from the settings and by the version of the wear code that the chain has."""
    needed = (chain.folder / "wear.csv", chain.surface, chain.bed_restart)
    return all(file.exists() for file in needed) and state.finished_cycles(chain.folder, inputs_digest(chain)) > 0


def failure_file(chain: Chain) -> Path:
    """Return the file that says why a run failed; other settings, or another version of the wear code, have another."""
    return chain.folder / f"failed_{run_digest(chain.case, chain.parameters, chain.bed)[:DIGITS]}.txt"


def shared_chain(name: str, folder: Path, case: Case, run: Run, bed: Mapping[str, Any]) -> Chain:
    """Return the chain of a run in a folder of many, nothing made but its own folder, which has its name.

    Runs that stand beside one another share the bed, all of them the surface, in places of other names wherever they
    are made from anything else.
    """
    place = folder / name
    place.mkdir(parents=True, exist_ok=True)
    surface, restart = surface_file(folder, run.surface, case, run.parameters), bed_file(place.parent, bed)
    return Chain(name, place, case, run.parameters, surface, bed, restart)


def surface_file(folder: Path, name: str, case: Case, parameters: Mapping[str, Any]) -> Path:
    """Return where in a folder a surface lies; made from anything else it has another name."""
    return folder / f"{name}_{state.digest(surface_from(case, parameters))[:DIGITS]}.vtu"


def bed_file(folder: Path, bed: Mapping[str, Any]) -> Path:
    """Return where in a folder the restart of a bed lies; a bed of other parameters has another place."""
    return folder / f"bed_{state.digest(bed)[:DIGITS]}" / "bed.restart"


def prepared_chain(folder: Path, particle_scale: float, wider: int = 1) -> Chain:
    """Return the chain of the case; fills its bed and runs it in unless that was done in this folder before.

    wider: as many times as wide are bed and sample, and so many ranks prepare them
    """
    study = case_study(particle_scale, wider)
    parameters, bed_name = study.run(RUN).parameters, study.bed_of(RUN)
    place, bed_folder = own_folders(folder, study, RUN)
    surface = place / RUN / "surface.vtu"
    chain = Chain(
        RUN, surface.parent, study.case, parameters, surface, study.beds[bed_name], bed_folder / "bed.restart", wider
    )
    with_bed(chain, bed_name)
    if not surface.exists():
        surface.parent.mkdir(parents=True, exist_ok=True)
        write_surface(surface, sample_surface(parameters["sample"], parameters["pattern"]))
    if not (state.cycle_folder(chain.folder, 0) / RESTART).exists():
        run_cycle(chain, None, inputs_digest(chain), Progress(RUN, run_in_steps(chain)))
    return chain


def prepared_tester(folder: Path, particle_scale: float, surface: str = PLAIN) -> Chain:
    """Return the chain of a plain or convex sample in the circular tester's channel, filled and run in."""
    study = load_study(TESTER, overrides={"fidelity": "quick", "particle_scale": particle_scale})
    run = study.run(surface)
    place, bed_folder = own_folders(folder, study, run.name)
    file, bed = place / run.name / "surface.vtu", study.bed_of(run.name)
    if not file.exists():
        file.parent.mkdir(parents=True, exist_ok=True)
        write_surface(file, study.case.surface_mesh(run.parameters))
    restart = bed_folder / "bed.restart"
    chain = Chain(run.name, file.parent, study.case, run.parameters, file, study.beds[bed], restart)
    with_bed(chain, bed)
    if not (state.cycle_folder(chain.folder, 0) / RESTART).exists():
        run_cycle(chain, None, inputs_digest(chain), Progress(run.name, run_in_steps(chain)))
    return chain


def own_folders(folder: Path, study: Study, run: str) -> tuple[Path, Path]:
    """Return the folders of a run that is prepared and of its bed, others wherever anything else would be simulated."""
    parameters, bed = study.run(run).parameters, study.beds[study.bed_of(run)]
    found = {
        "bed": bed_digest(study.case, bed),
        "surface": surface_from(study.case, parameters),
        "run": run_digest(study.case, parameters, bed),
    }
    return folder / state.digest(found)[:DIGITS], folder / found["bed"][:DIGITS]


def case_study(particle_scale: float, wider: int = 1) -> Study:
    """Return the study of the case, bed and sample so many times as wide."""
    size = {"particle_scale": particle_scale, "fidelity": "quick"}
    settings = load_study(STUDY, overrides=size).settings
    widths = {name: {"width_mm": wider * settings[name]["width_mm"]} for name in ("sample", "bed")}
    return load_study(STUDY, overrides=size | widths)


def cycle_deck(chain: Chain, name: str) -> tuple[Path, SurfaceMesh, str]:
    """Return a new folder beside the run's cycles with what its first wear cycle reads, its surface, and the deck."""
    folder, surface = chain.folder / name, read_surface(chain.surface)
    folder.mkdir(exist_ok=True)
    write_shared_files(chain)
    write_cycle(chain, first_span(chain.parameters), folder, surface)
    return folder, surface, (folder / "deck.in").read_text()


def particles_of(chain: Chain) -> int:
    """Return the number of particles of a prepared chain."""
    return int(thermo_table(state.cycle_folder(chain.folder, 0) / LOG)["Atoms"][-1])
