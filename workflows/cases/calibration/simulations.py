"""Simulations of a calibration and what is measured on them: answers to tests, blocked packings done again, their cost.

A simulation is kept by what it was made from (`workflows.engine.bulk_simulations`) and measured anew whenever it is
asked for. A packing in which an arch blocks the opening is kept too, and another one takes its place.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd

from bulkwear.postproc.flow.bulk_test import MEASUREMENTS, Boxes, Measurement
from bulkwear.postproc.flow.free_surface import FreeSurfaceError
from bulkwear.postproc.flow.outflow import BlockedError, OutflowError
from bulkwear.postproc.flow.wall_shear import WallShearError
from bulkwear.postproc.inference.loop import packing_seed
from bulkwear.workflows.cases.calibration.boxes import DRAW_DOWN, SIMULATIONS, opening_length
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.bulk_simulations import inputs_digest, simulated, simulation_folder
from bulkwear.workflows.engine.bulk_tests import time_step
from bulkwear.workflows.engine.grains import spheres_per_grain
from bulkwear.workflows.engine.records import read_record
from bulkwear.workflows.engine.solver import SolverError

PACKINGS = 3  # of a test, before it is given up because arches block all of them
NEXT_PACKING = 1000  # numbers on, where no calibration has a packing of its own
BLOCKED = "blocked_packings"  # column of a table of simulations
FOLDERS = "folders"  # column of one: names of the folders of a row's simulations, with blanks between
USED_BY = ("simulations.csv", "repeats.csv", "box_sizes.csv", "checked_pairs.csv")  # tables with that column


def boxes_of(test: Mapping[str, Any]) -> Boxes:
    """Return what the measurement of a test needs to know of its geometry."""
    opening = opening_length(test) if test["kind"] == DRAW_DOWN else 0.0
    box, particle = test["box"], test["particle"]
    spheres = spheres_per_grain(particle)
    return Boxes(box["length_m"], box["width_m"], particle["median_diameter_m"], opening, spheres)


def measured(test: Mapping[str, Any], folder: Path) -> Measurement:
    """Return the measurement on a finished simulation.

    Raises BlockedError where an arch stands over the opening, SolverError with its folder where nothing can be
    measured.
    """
    try:
        return MEASUREMENTS[test["kind"]](folder, boxes_of(test), time_step(test))
    except BlockedError:
        raise
    except (FreeSurfaceError, OutflowError, WallShearError) as fault:
        raise SolverError(f"{folder}: {fault}") from fault


def flowing(test: Mapping[str, Any], root: Path, say: Callable[[str], None]) -> tuple[Measurement, Path]:
    """Return the measurement of a test, simulated unless it was before, and its folder.

    Where an arch blocks the opening those of the next packing, as in a laboratory, where the test is done again. Raises
    SolverError when arches block PACKINGS of them.
    """
    for number, packing in enumerate(packings_of(test)):
        folder = simulated(packing, root)
        try:
            return replace(measured(packing, folder), blocked=number), folder
        except BlockedError as blocked:
            fault = blocked
            said = f"an arch blocks the opening in the packing of seed {packing['seed']}, it is kept as such"
            say(f"{test['kind']}: {said}")
    raise SolverError(f"{PACKINGS} packings of one test are blocked, the last one: {fault}")


def packings_of(test: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return a test and those of the packings that take its place one after the other, where arches block it."""
    return [{**test, "seed": packing_seed(test["seed"], number * NEXT_PACKING)} for number in range(PACKINGS)]


def is_answered(test: Mapping[str, Any], root: Path) -> bool:
    """Return whether `flowing` has nothing to simulate: all packings up to the first that no arch blocks are there."""
    for packing in packings_of(test):
        kept = simulation_folder(packing, root)
        if state.finished_cycles(kept, inputs_digest(packing)) == 0:
            return False
        try:
            measured(packing, state.cycle_folder(kept, 0))
        except BlockedError:
            continue
        except SolverError:  # it is told when it is asked for
            return True
        return True
    return True


def simulate_all(
    tests: Sequence[Mapping[str, Any]], root: Path, parallel: int, say: Callable[[str], None]
) -> list[Measurement]:
    """Return the measurements of tests, up to `parallel` of them simulated at the same time. Raises SolverError.

    Equal tests, as of boxes that are widened to the same slice, are one simulation.
    """
    root.mkdir(parents=True, exist_ok=True)
    started, done, lock = time.monotonic(), [], threading.Lock()
    asked = [inputs_digest(test) for test in tests]
    each = dict(zip(asked, tests, strict=True))
    known = [state.finished_cycles(simulation_folder(test, root), inputs) > 0 for inputs, test in each.items()]

    def one(test: Mapping[str, Any], was_known: bool) -> Measurement:
        found, _ = flowing(test, root, say)
        with lock:
            if not was_known:
                done.append(test)
                passed = time.monotonic() - started
                say(f"{test['kind']} {len(done)} of {known.count(False)} simulated, {passed:.0f} s so far")
        return found

    with ThreadPoolExecutor(max_workers=parallel) as pool:
        answers = dict(zip(each, pool.map(one, each.values(), known), strict=True))
    return [answers[inputs] for inputs in asked]


def answer(measurement: Measurement) -> dict[str, float]:
    """Return a measurement as a row: value and uncertainty of each response, and the packings that were blocked."""
    uncertainties = {f"{name}_uncertainty": value for name, value in measurement.uncertainties.items()}
    return dict(measurement.responses) | uncertainties | {BLOCKED: measurement.blocked}


def used_folders(folder: Path) -> list[Path]:
    """Return the folders of the simulations that a calibration's tables are made of; beside them lie those of other
    fidelities and settings, which do not count. All of them where a table, of an earlier version, does not tell.

    folder: results/<study>
    """
    tables = [pd.read_csv(folder / name) for name in USED_BY if (folder / name).is_file()]
    there = sorted(path for path in (folder / SIMULATIONS).iterdir() if path.is_dir())
    if any(FOLDERS not in table for table in tables):
        return there
    names = {name for table in tables for each in table[FOLDERS] for name in each.split()}
    return [path for path in there if path.name in names]


def cost_table(folders: Sequence[Path]) -> pd.DataFrame:
    """Return number, solver seconds, particles and mean steps of the simulations of each kind in their folders."""
    states = [read_record(state.cycle_folder(folder, 0) / state.STATE) for folder in folders]
    table = pd.DataFrame([{"test": found["test"]["kind"].replace("_", " "), **found["cost"]} for found in states])
    return table.groupby("test", as_index=False).agg(
        simulations=("steps", "size"),
        solver_s=("solver_s", "sum"),
        most_particles=("particles", "max"),
        mean_steps=("steps", "mean"),
    )
