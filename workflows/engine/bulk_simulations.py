"""Simulations of bulk tests, kept by what they were made from: the same question is never simulated twice, and another
question never gets an old answer.

A simulation lives in `<folder>/<kind>_<digest of its inputs>/cycle_000`, written and checked as a wear cycle is
(state.py): a folder under that name is whole, and a damaged one is set aside and done again. It is measured anew
whenever it is asked for. A packing in which an arch blocks the slot is kept too, and another one takes its place.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

from postproc.flow.bulk_test import HEAP, MEASUREMENTS, RESPONSES, Boxes, Measurement
from postproc.flow.free_surface import FreeSurfaceError
from postproc.flow.outflow import BlockedError, OutflowError
from postproc.inference.loop import packing_seed
from postproc.readers.solver_log import failure, last_step, solver_version, thermo_table, warnings
from workflows.engine import state
from workflows.engine.bulk_tests import deck_text, slot_length, time_step, write_test
from workflows.engine.solver import LOG, SCREEN, SolverError, processor_seconds, run_deck
from workflows.engine.work import CYCLE_BYTES, PICTURE_PARTICLE, Stage

POURED = 1.04  # -, poured particles over those that fill the box, as counted

FILLED = "filled.dump"
PACKINGS = 3  # of a test, before it is given up because arches block all of them
NEXT_PACKING = 1000  # numbers on, where no calibration has a packing of its own
BLOCKED = "blocked_packings"  # column of a table of simulations


def simulation_folder(test: Mapping[str, Any], root: Path) -> Path:
    """Return where the simulation of a test is kept."""
    return root / f"{test['kind']}_{inputs_digest(test)[: state.DIGEST_LETTERS]}"


def inputs_digest(test: Mapping[str, Any]) -> str:
    """Return the hash of all that a test's result depends on: its parameters and its deck."""
    return state.digest(test, deck_text(test))


def simulated(test: Mapping[str, Any], root: Path, alone: bool = False) -> Path:
    """Return the folder with a test's dumps and log; it is simulated unless it was before. Raises SolverError.

    alone: this process simulates nothing else meanwhile, so that the processor time can be told and is recorded
    """
    kept, inputs = simulation_folder(test, root), inputs_digest(test)
    if state.finished_cycles(kept, inputs) == 0:
        with state.working_folder(kept, 0) as folder:
            write_test(test, folder)
            before = processor_seconds()
            spent = {"solver_s": round(_run(folder, test), 3)}
            if alone:
                spent["processor_s"] = round(processor_seconds() - before, 3)
            check_rest(folder, test)
            state.write_state(folder, inputs, (HEAP, FILLED, LOG), _record(test, folder, spent))
    return state.cycle_folder(kept, 0)


def _run(folder: Path, test: Mapping[str, Any]) -> float:
    """Run the deck and return its wall time in s; a deck that gives up without an error found no rest."""
    try:
        return run_deck(folder)
    except SolverError:
        if (folder / SCREEN).is_file() and failure(folder / SCREEN) is None:
            check_rest(folder, test)
        raise


def check_rest(folder: Path, test: Mapping[str, Any]) -> None:
    """Raise SolverError when the solver found no rest: the dump of the heap is only written at rest."""
    longest, share = test["rest"]["longest_s"], test["rest"]["energy_fraction"]
    for dump, what in ((FILLED, "the filled box"), (HEAP, "the heap")):
        if not (folder / dump).is_file():
            raise SolverError(
                f"{folder / LOG}: {what} did not come to rest in {longest:g} s (rest.longest_s); rest is a mean kinetic"
                f" energy below rest.energy_fraction = {share:g} of m g d."
            )


def _record(test: Mapping[str, Any], folder: Path, spent: Mapping[str, float]) -> dict[str, Any]:
    thermo = thermo_table(folder / LOG)
    return {
        "test": test,
        "cost": {**spent, "steps": last_step(folder / LOG), "particles": int(thermo["Atoms"].max())},
        "solver": solver_version(folder / SCREEN),
        "solver_warnings": warnings(folder / SCREEN),
    }


def boxes_of(test: Mapping[str, Any]) -> Boxes:
    """Return what the measurement of a test needs to know of its geometry."""
    slot = slot_length(test) if test["kind"] == "draw_down" else 0.0
    return Boxes(test["box"]["length_m"], test["box"]["width_m"], test["particle"]["median_diameter_m"], slot)


def measured(test: Mapping[str, Any], folder: Path) -> Measurement:
    """Return the measurement on a finished simulation.

    Raises BlockedError where an arch stands over the slot, SolverError naming the folder where there is no slope.
    """
    try:
        return MEASUREMENTS[test["kind"]](folder, boxes_of(test), time_step(test))
    except BlockedError:
        raise
    except (FreeSurfaceError, OutflowError) as fault:
        raise SolverError(f"{folder}: {fault}") from fault


def flowing(test: Mapping[str, Any], root: Path, say: Callable[[str], None]) -> tuple[Measurement, Path]:
    """Return the measurement of a test, simulated unless it was before, and its folder.

    Where an arch blocks the slot those of the next packing, as in a laboratory, where the test is done again. Raises
    SolverError when arches block PACKINGS of them.
    """
    for number in range(PACKINGS):
        packing = {**test, "seed": packing_seed(test["seed"], number * NEXT_PACKING)}
        folder = simulated(packing, root)
        try:
            return replace(measured(packing, folder), blocked=number), folder
        except BlockedError as blocked:
            fault = blocked
            say(f"{test['kind']}: an arch blocks the slot in the packing of seed {packing['seed']}, it is kept as such")
    raise SolverError(f"{PACKINGS} packings of one test are blocked, the last one: {fault}")


def simulate_all(
    tests: Sequence[Mapping[str, Any]], root: Path, parallel: int, say: Callable[[str], None]
) -> list[Measurement]:
    """Return the measurements of tests, up to `parallel` of them simulated at the same time. Raises SolverError."""
    root.mkdir(parents=True, exist_ok=True)
    started, done, lock = time.monotonic(), [], threading.Lock()
    known = [state.finished_cycles(simulation_folder(test, root), inputs_digest(test)) > 0 for test in tests]

    def one(test: Mapping[str, Any], was_known: bool) -> Measurement:
        found, _ = flowing(test, root, say)
        with lock:
            if not was_known:
                done.append(test)
                passed = time.monotonic() - started
                say(f"{test['kind']} {len(done)} of {known.count(False)} simulated, {passed:.0f} s so far")
        return found

    with ThreadPoolExecutor(max_workers=parallel) as pool:
        return list(pool.map(one, tests, known))


def answer(measurement: Measurement) -> dict[str, float]:
    """Return a measurement as a row: value and uncertainty of each response, and the packings that were blocked."""
    uncertainties = {f"{name}_uncertainty": value for name, value in measurement.uncertainties.items()}
    return dict(measurement.responses) | uncertainties | {BLOCKED: measurement.blocked}


def responses_of(kinds: Sequence[str]) -> list[str]:
    """Return the responses that kinds of tests give."""
    return [name for kind in kinds for name in RESPONSES[kind]]


def filled_particles(test: Mapping[str, Any]) -> float:
    """Return about how many particles fill the box of a test."""
    particle, box = test["particle"], test["box"]
    solid = box["length_m"] * box["width_m"] * box["fill_height_m"] * particle["bulk_solid_fraction"]
    pairs = zip(particle["mass_fractions"], particle["diameters_m"], strict=True)
    return solid * math.fsum(fraction / (math.pi / 6.0 * diameter**3) for fraction, diameter in pairs)


def simulation_bytes(stages: tuple[Stage, ...]) -> float:
    """Return what simulations leave on disk: two dumps of all particles and the log each."""
    return sum(stage.decks * (2.0 * PICTURE_PARTICLE * stage.particles + CYCLE_BYTES) for stage in stages)
