"""Simulations of bulk tests, kept by what they were made from: the same question is never simulated twice, and another
question never gets an old answer.

A simulation lives in `<folder>/<kind>_<digest of its inputs>/cycle_000`, written and checked as a wear cycle is
(state.py): a folder under that name is whole, and a damaged one is set aside and done again.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bulkwear.postproc.flow.bed import read_snapshot
from bulkwear.postproc.flow.bulk_test import HEAP
from bulkwear.postproc.readers.solver_log import failure, last_step, solver_version, thermo_table, warnings
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.beds import BedMeasure, bed_fault, level_measure, mass_measure
from bulkwear.workflows.engine.bulk_tests import deck_text, filled_mass, kind_of, write_test
from bulkwear.workflows.engine.case import CASES_PACKAGE
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.grains import equal_spheres, solid_share
from bulkwear.workflows.engine.pouring import particles_of_mass
from bulkwear.workflows.engine.provenance import PROVENANCE, provenance, simulating_code
from bulkwear.workflows.engine.records import read_record
from bulkwear.workflows.engine.solver import (
    LOG,
    SCREEN,
    SolverCrashedError,
    SolverError,
    SolverStoppedError,
    executable_of,
    processor_seconds,
    run_deck,
)
from bulkwear.workflows.engine.work import CYCLE_BYTES, PICTURE_PARTICLE, Stage

FILLED = "filled.dump"


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
        code = _simulating_code(test)
        with state.working_folder(kept, 0) as folder:
            write_test(test, folder)
            before = processor_seconds()
            spent = {"solver_s": round(_run(folder, test), 3)}
            if alone:
                spent["processor_s"] = round(processor_seconds() - before, 3)
            check_rest(folder, test)
            check_filling(folder, test)
            state.write_state(folder, inputs, (HEAP, FILLED, LOG), _record(test, folder, spent, code))
    return state.cycle_folder(kept, 0)


def _run(folder: Path, test: Mapping[str, Any]) -> float:
    """Run the deck and return its wall time in s; a deck that gives up without an error found no rest."""
    try:
        return run_deck(folder, executable=executable_of(test))
    except (SolverStoppedError, SolverCrashedError):
        raise
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


def check_filling(folder: Path, test: Mapping[str, Any]) -> None:
    """Raise SolverError when a box does not hold the mass that was to be poured, with its level beside.

    The level alone refuses none: how dense a filling settles is what its friction decides, which a calibration varies.
    """
    measures = filling_measures(folder, test)
    if bed_fault(measures[:1]):
        raise SolverError(f"{folder / FILLED}: {bed_fault(measures)}.")


def filling_measures(folder: Path, test: Mapping[str, Any]) -> list[BedMeasure]:
    """Return mass and level of a box that was filled and rests."""
    particle, filled = test["particle"], read_snapshot(folder / FILLED)
    volume = solid_share(particle) * math.pi / 6.0 * (2.0 * filled["radius_m"]) ** 3
    level = 2.0 * float((volume * filled["z_m"]).sum() / volume.sum())
    return _measures_of(test, particle["density_kg_per_m3"] * float(volume.sum()), level)


def kept_filling(kept: Path) -> tuple[dict[str, Any], list[BedMeasure]]:
    """Return the test of a simulation and mass and level of its filled box, from what it recorded of itself.

    kept: its folder, as from `simulation_folder`
    """
    record = read_record(state.cycle_folder(kept, 0) / state.STATE)
    return record["test"], _measures_of(record["test"], *(record["filling"][name] for name in ("mass", "level")))


def _measures_of(test: Mapping[str, Any], mass: float, level: float) -> list[BedMeasure]:
    particle = test["particle"]
    asked = filled_mass(test), test["box"]["fill_height_m"]
    return [mass_measure(particle, asked[0], mass), level_measure(particle, asked[1], level)]


def _simulating_code(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return which code simulates a test: that of the case in whose folder its kind is."""
    words = kind_of(test).deck.__module__.removeprefix(f"{CASES_PACKAGE}.").split(".")
    return simulating_code(find_case(words[0]))


def _record(
    test: Mapping[str, Any], folder: Path, spent: Mapping[str, float], code: Mapping[str, Any]
) -> dict[str, Any]:
    thermo = thermo_table(folder / LOG)
    cost = {**spent, "steps": last_step(folder / LOG), "particles": int(thermo["Atoms"].max())}
    return {
        "test": test,
        "cost": cost,
        "filling": {each.measure: each.found for each in filling_measures(folder, test)},
        PROVENANCE: provenance(code, executable_of(test), cost),
        "solver": solver_version(folder / SCREEN),
        "solver_warnings": warnings(folder / SCREEN),
    }


def filled_particles(test: Mapping[str, Any]) -> float:
    """Return about how many spheres cost the solver as much as the particles that fill the box of a test."""
    return equal_spheres(test["particle"], particles_of_mass(test["particle"], filled_mass(test)))


def simulation_bytes(stages: tuple[Stage, ...]) -> float:
    """Return what simulations leave on disk: two dumps of all particles and the log each."""
    return sum(stage.decks * (2.0 * PICTURE_PARTICLE * stage.particles + CYCLE_BYTES) for stage in stages)
