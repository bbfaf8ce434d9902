"""Simulations of bulk tests, kept by what they were made from: the same question is never simulated twice, and another
question never gets an old answer.

A simulation lives in `<folder>/<kind>_<digest of its inputs>/cycle_000`, written and checked as a wear cycle is
(state.py): a folder under that name is whole, and a damaged one is set aside and done again. It is measured anew
whenever it is asked for.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from postproc.analysis.bulk_test import HEAP, MEASUREMENTS, RESPONSES, Boxes, Measurement
from postproc.analysis.free_surface import FreeSurfaceError
from postproc.analysis.outflow import OutflowError
from postproc.readers.solver_log import failure, last_step, solver_version, thermo_table, warnings
from workflows import state
from workflows.bulk_tests import deck_text, slot_length, time_step, write_test
from workflows.solver import LOG, SCREEN, SolverError, run_deck

FILLED = "filled.dump"


def simulation_folder(test: Mapping[str, Any], root: Path) -> Path:
    """Return where the simulation of a test is kept."""
    return root / f"{test['kind']}_{inputs_digest(test)[: state.DIGEST_LETTERS]}"


def inputs_digest(test: Mapping[str, Any]) -> str:
    """Return the hash of all that a test's result depends on: its parameters and its deck."""
    return state.digest(test, deck_text(test))


def simulated(test: Mapping[str, Any], root: Path) -> Path:
    """Return the folder with a test's dumps and log; it is simulated unless it was before. Raises SolverError."""
    kept, inputs = simulation_folder(test, root), inputs_digest(test)
    if state.finished_cycles(kept, inputs) == 0:
        with state.working_folder(kept, 0) as folder:
            write_test(test, folder)
            seconds = _run(folder, test)
            check_rest(folder, test)
            state.write_state(folder, inputs, (HEAP, FILLED, LOG), _record(test, folder, seconds))
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


def _record(test: Mapping[str, Any], folder: Path, seconds: float) -> dict[str, Any]:
    thermo = thermo_table(folder / LOG)
    return {
        "test": test,
        "cost": {
            "solver_s": round(seconds, 3),
            "steps": last_step(folder / LOG),
            "particles": int(thermo["Atoms"].max()),
        },
        "solver": solver_version(folder / SCREEN),
        "solver_warnings": warnings(folder / SCREEN),
    }


def boxes_of(test: Mapping[str, Any]) -> Boxes:
    """Return what the measurement of a test needs to know of its geometry."""
    slot = slot_length(test) if test["kind"] == "draw_down" else 0.0
    return Boxes(test["box"]["length_m"], test["box"]["width_m"], test["particle"]["median_diameter_m"], slot)


def measured(test: Mapping[str, Any], folder: Path) -> Measurement:
    """Return the measurement on a finished simulation. Raises SolverError naming the folder where there is no slope."""
    try:
        return MEASUREMENTS[test["kind"]](folder, boxes_of(test), time_step(test))
    except (FreeSurfaceError, OutflowError) as fault:
        raise SolverError(f"{folder}: {fault}") from fault


def simulate_all(
    tests: Sequence[Mapping[str, Any]], root: Path, parallel: int, say: Callable[[str], None]
) -> list[Measurement]:
    """Return the measurements of tests, up to `parallel` of them simulated at the same time."""
    root.mkdir(parents=True, exist_ok=True)
    started, done, lock = time.monotonic(), [], threading.Lock()
    missing = [test for test in tests if state.finished_cycles(simulation_folder(test, root), inputs_digest(test)) == 0]

    def one(test: Mapping[str, Any]) -> None:
        simulated(test, root)
        with lock:
            done.append(test)
            passed = time.monotonic() - started
            say(f"{test['kind']} {len(done)} of {len(missing)} simulated, {passed:.0f} s so far")

    with ThreadPoolExecutor(max_workers=parallel) as pool:
        list(pool.map(one, missing))
    return [measured(test, state.cycle_folder(simulation_folder(test, root), 0)) for test in tests]


def answer(measurement: Measurement) -> dict[str, float]:
    """Return the responses of a measurement as a row: value and uncertainty of each."""
    return dict(measurement.responses) | {
        f"{name}_uncertainty": value for name, value in measurement.uncertainties.items()
    }


def responses_of(kinds: Sequence[str]) -> list[str]:
    """Return the responses that kinds of tests give."""
    return [name for kind in kinds for name in RESPONSES[kind]]
