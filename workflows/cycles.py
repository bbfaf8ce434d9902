"""The driver of a run: solver restart -> load ledger -> wear -> displaced mesh, cycle by cycle, resumable.

Every step is a plain function of the files of a cycle's folder (chain.py, accounting.py); here they are strung
together.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from postproc.mesh import read_surface, write_surface
from postproc.readers.load_ledger import announcement
from postproc.readers.solver_log import solver_version, thermo_table, warnings
from workflows import deck, state
from workflows.accounting import LEDGER, account_and_wear, worn_surface
from workflows.chain import (
    RESTART,
    SURFACE,
    Chain,
    cycle_steps,
    cycle_title,
    surface_before,
    total_steps,
    write_bed,
    write_cycle,
    write_end_wall,
)
from workflows.ledgers import producer
from workflows.progress import Progress
from workflows.solver import CYCLE_EXECUTABLES, EXECUTABLE, LOG, SCREEN, SolverError, missing_program, run_deck
from workflows.tables import write_table

WORN_SURFACE = "worn_surface.vtu"


def run_chain(chain: Chain) -> None:
    """Run what is missing of a run, then write its wear.csv and cost.csv. Resumes after the last finished cycle.

    Raises SolverError, StateError, WearError or a reader's error; finished cycles stay and are not done again.
    """
    announce = Progress(chain.name, 1).say
    with state.only_driver(chain.folder, announce):
        inputs = inputs_digest(chain)
        if moved := state.set_aside_others(chain.folder, inputs):
            announce(moved)
        finished = state.finished_cycles(chain.folder, inputs)
        if finished <= chain.cycles and (missing := missing_program(cycle_executable(chain, 1))):
            raise SolverError(missing)  # before the run-in, which needs the plain solver only
        progress = Progress(chain.name, total_steps(chain), sum(cycle_steps(chain, k) for k in range(finished)))
        if 0 < finished <= chain.cycles:
            announce(f"resumes after {cycle_title(chain, finished - 1)}")
        for cycle in range(finished, chain.cycles + 1):
            run_cycle(chain, cycle, inputs, progress)
        write_products(chain)


def inputs_digest(chain: Chain) -> str:
    """Return the hash of all that a run's results depend on: parameters, decks, surface and bed."""
    parameters, bed = chain.parameters, chain.bed
    solver = {key: value for key, value in parameters["solver"].items() if key != "ranks"}
    return state.digest(
        {**parameters, "solver": solver},
        deck.render("lowered_bed", deck.lowered_bed(parameters, bed, bed_restart="")),
        deck.render("sliding_sample", deck.sliding_sample(parameters, bed, cycle=1, run_restart="")),
        state.file_digest(chain.surface),
        state.file_digest(chain.bed_restart),
    )


def run_cycle(chain: Chain, cycle: int, inputs: str, progress: Progress) -> None:
    """Simulate, account, wear and displace one cycle; cycle 0 lowers the bed on to the sample and runs it in."""
    started = time.monotonic()
    with state.working_folder(chain.folder, cycle) as folder:
        surface = read_surface(surface_before(chain, cycle))
        write_end_wall(chain)
        write_cycle(chain, cycle, folder, surface)
        solver_seconds = simulate(chain, cycle, folder, len(surface.triangles), progress)
        record = {"cost": {}} if cycle == 0 else account_and_wear(chain, cycle, folder, surface)
        record["cost"] = cost(chain, cycle, folder, solver_seconds, time.monotonic() - started) | record["cost"]
        record |= {
            "bed_travelled_m": deck.travelled(chain.parameters, cycle + 1),
            "seed": chain.bed["seed"],
            "solver": solver_version(folder / SCREEN),
            "solver_ledger": announcement(folder / SCREEN),
            "solver_warnings": warnings(folder / SCREEN),
        }
        if inputs_digest(chain) != inputs:
            raise state.StateError(
                f"{chain.name}: its inputs changed while {cycle_title(chain, cycle)} ran; start again."
            )
        files = (RESTART,) if cycle == 0 else (RESTART, SURFACE, LEDGER, *producer(chain.parameters).kept)
        state.write_state(folder, inputs, files, record)


def simulate(chain: Chain, cycle: int, folder: Path, triangles: int, progress: Progress) -> float:
    """Run the solver on a cycle's deck and return its wall time in s. Raises SolverError."""
    before = sum(cycle_steps(chain, earlier) for earlier in range(cycle))
    return run_deck(
        folder,
        chain.ranks,
        lambda step: progress.update(before + step, cycle_title(chain, cycle)),
        triangles={f"sample_{cycle}": triangles},
        executable=cycle_executable(chain, cycle),
    )


def cycle_executable(chain: Chain, cycle: int) -> str:
    """Return the program that simulates a cycle; only wear cycles have a ledger."""
    return CYCLE_EXECUTABLES[chain.parameters["ledger"]] if cycle else EXECUTABLE


def cost(chain: Chain, cycle: int, folder: Path, solver_seconds: float, all_seconds: float) -> dict[str, float]:
    """Return what a cycle cost: wall times in s and the sizes that they depend on."""
    thermo = thermo_table(folder / LOG)
    return {
        "cycle": cycle,
        "solver_s": round(solver_seconds, 3),
        "other_s": round(all_seconds - solver_seconds, 3),
        "steps": cycle_steps(chain, cycle),
        "particles": int(thermo["Atoms"][-1]),
        "triangles": int(read_surface(chain.surface).triangles.shape[0]),
        "ranks": chain.ranks,
        "ledger_bytes": 0,
    }


def write_products(chain: Chain) -> None:
    """Write wear.csv, cost.csv and worn_surface.vtu of a finished run from what its cycles left."""
    states = [state.read_state(chain.folder, cycle) for cycle in range(chain.cycles + 1)]
    write_table(chain.folder / "wear.csv", [found["wear"] for found in states[1:]])
    write_table(chain.folder / "cost.csv", [found["cost"] for found in states])
    write_surface(chain.folder / WORN_SURFACE, worn_surface(chain))


def fill_bed(name: str, bed: Mapping[str, Any], folder: Path, ranks: int = 1) -> None:
    """Fill and settle a bed; leaves bed.restart and cost.csv in the folder. Raises SolverError."""
    parameters = deck.settled_bed(bed)
    total = parameters["settling_steps"] + parameters["relaxing_steps"]
    progress = Progress(name, total)
    with state.only_driver(folder, progress.say):
        write_bed(bed, folder)
        seconds = run_deck(folder, ranks, lambda step: progress.update(step, "filling and settling"))
    particles = int(thermo_table(folder / LOG)["Atoms"][-1])
    write_table(folder / "cost.csv", [{"solver_s": round(seconds, 3), "steps": total, "particles": particles}])
