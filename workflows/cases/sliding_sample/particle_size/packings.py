"""Packings at every particle scale of a study (Yan 2022, sections 4.3.1 and 4.5.1.1): containers, with what they will
cost the solver, and beds before and behind a sample.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from bulkwear.postproc.flow.bed import read_snapshot
from bulkwear.postproc.flow.bulk_test import HEAP
from bulkwear.postproc.flow.packing import MEASURES, loose_and_dense, packing_profile, within
from bulkwear.postproc.readers.cycle_folders import cycle_files
from bulkwear.postproc.tables.display import in_display_units
from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.sliding_sample.decks import bed_contacts
from bulkwear.workflows.cases.sliding_sample.particle_size.study import by_scale
from bulkwear.workflows.engine import decks as deck
from bulkwear.workflows.engine.bulk_simulations import (
    FILLED,
    filled_particles,
    simulated,
    simulation_bytes,
    simulation_folder,
)
from bulkwear.workflows.engine.bulk_tests import Kind, fill_top, filled_box, margin_of, register, time_step
from bulkwear.workflows.engine.case import Parameters
from bulkwear.workflows.engine.chain import RESTART
from bulkwear.workflows.engine.derived import PERIODIC, WINDOW
from bulkwear.workflows.engine.job import Progress
from bulkwear.workflows.engine.solver import DECK, executable_of, run_deck
from bulkwear.workflows.engine.state import only_driver, read_state
from bulkwear.workflows.engine.templates import render, used_sections
from bulkwear.workflows.engine.work import Stage, Work

REST_KEYS = ("energy_fraction", "check_interval_s", "calm_checks", "longest_s")
END_DIAMETERS = 5.0  # -, of a bed next to its end walls, left out
LEAVING_DIAMETERS = 2.0  # -, of the wake next to where it leaves a window, left out: it may slide into the room there
AT_REST_BEHIND = 0.2  # m behind the sample's back edge the bed is at rest again; measured: 0.2 to 0.4
LOOKED_AT = 0.75  # -, of the bed's thickness, from the floor: what lies above is disturbed by the surface
AXES = {"x": "1. 0. 0.", "y": "0. 1. 0.", "z": "0. 0. 1."}
CONTAINER = "packed_container"  # kind of bulk test, and its template
JOB = "packing_profiles"  # rule that simulates all containers of a study, one after the other
# How long a container takes until rest is not known before it is simulated: scaled from three that were, at particle
# scales 8, 6 and 2.
FILLING_FREE_FALLS = 1.45  # -, until what is poured rests, in free falls through the filling; measured 1.35 to 1.64
RESTING_FREE_FALLS = 1.0  # -, from the end of the shaking until rest, in free falls of the filled height


def container(run: Parameters, packing: Mapping[str, Any]) -> dict[str, Any]:
    """Return the bulk test of a container with a run's particles; packing: the study's settings of it, SI."""
    diameter = run["particle"]["median_diameter_m"]
    width = packing["width_diameters"] * diameter
    height = min(packing["fill_height_m"], packing["most_fill_diameters"] * diameter)
    return {
        "kind": CONTAINER,
        "box": {"length_m": width, "width_m": width, "fill_height_m": height, "ends": PERIODIC},
        "shaking": {
            "amplitude_m": packing["amplitude_diameters"] * diameter,
            "frequency_rad_per_s": packing["frequency_rad_per_s"],
            "duration_s": packing["shaking_s"],
            "axis": packing["axis"],
        },
        "rest": {key: packing[f"rest_{key}"] for key in REST_KEYS},
        "particle": run["particle"],
        "wall_material": run["floor_material"],
        "floor_material": run["floor_material"],
        **used_sections(CONTAINER, run),
        "seed": run["bed"]["seed"],
    }


def packed_container(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of the deck of a container that is filled and shaken.

    test: see `workflows.engine.bulk_tests`, with shaking: amplitude_m, frequency_rad_per_s, duration_s, axis (x, y, z)
    """
    shaking, margin = test["shaking"], margin_of(test)
    return {
        **filled_box(test, ("particle", "floor", "floor")),
        "outflow": "none",
        "state_columns": f"{deck.STATE_COLUMNS} c_contacts",
        "domain_bottom_m": -margin,
        "domain_top_m": fill_top(test) + margin,
        "shaking_amplitude_m": shaking["amplitude_m"],
        "shaking_frequency_rad_per_s": shaking["frequency_rad_per_s"],
        "shaking_steps": deck.steps(shaking["duration_s"], time_step(test)),
        "shaking_direction": AXES[shaking["axis"]],
    }


register(CONTAINER, Kind(packed_container))


def packing_table(runs: Mapping[str, Parameters], packing: Mapping[str, Any], folder: Path) -> pd.DataFrame:
    """Simulate a container per particle scale; return its profiles loose and shaken, in display units."""
    tables = []
    with only_driver(folder, Progress("containers", 1).say):
        for scale, run in by_scale(runs).items():
            test = container(run, packing)
            there = simulated(test, folder, alone=True)
            loose, dense = (read_snapshot(there / name) for name in (FILLED, HEAP))
            table = loose_and_dense(loose, dense, run["particle"]["median_diameter_m"], test["box"]["length_m"] ** 2)
            tables.append(table.assign(particle_scale=scale))
    return in_display_units(pd.concat(tables, ignore_index=True))


def packing_costs(runs: Mapping[str, Parameters], packing: Mapping[str, Any], folder: Path) -> pd.DataFrame:
    """Return what the simulations of `packing_table` took, a row per particle scale: solver_s, processor_s, steps and
    particles. Without processor_s where one of them was recorded without it, by an earlier version.
    """
    tests = {scale: container(run, packing) for scale, run in by_scale(runs).items()}
    costs = [read_state(simulation_folder(test, folder), 0)["cost"] for test in tests.values()]
    return pd.DataFrame(costs, index=pd.Index(tests, name="particle_scale")).dropna(axis="columns").reset_index()


def packing_work(runs: Mapping[str, Parameters], packing: Mapping[str, Any]) -> Work:
    """Return the job of a container per particle scale; packing: the study's settings of it, SI."""
    found = (container_stages(container(run, packing)) for run in by_scale(runs).values())
    stages = tuple(stage for stages in found for stage in stages)
    return Work(JOB, (), stages, disk_bytes=simulation_bytes(stages))


def container_stages(test: Mapping[str, Any]) -> tuple[Stage, ...]:
    """Return the stages of a container: filling until rest, then shaking and what follows until rest."""
    step, filled = time_step(test), filled_particles(test)
    height = test["box"]["fill_height_m"]
    filling = FILLING_FREE_FALLS * free_fall(fill_top(test))
    shaking = test["shaking"]["duration_s"] + RESTING_FREE_FALLS * free_fall(height)
    return (
        Stage(1, deck.steps(filling, step), filled),
        Stage(0, deck.steps(shaking, step), filled, moving=True),
    )


def free_fall(height: float) -> float:
    """Return how long (s) a fall through a height (m) takes."""
    return math.sqrt(2.0 * height / GRAVITY)


def counted(run: Parameters, restart: Path, folder: Path) -> pd.DataFrame:
    """Return the particles of a restart file of a sliding sample with their contacts, as the solver counts them."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / DECK).write_text(render("bed_contacts", bed_contacts(run, str(restart.resolve()))))
    run_deck(folder, executable=executable_of(run))
    return read_snapshot(folder / "bed.dump")


def pieces(run: Parameters) -> dict[str, tuple[float, float, float]]:
    """Return {state: (start, end, width) m}: of the settled bed, and of the bed that the sample has passed.

    Behind the sample it is what lay ahead of its front when it started, as far as it is at rest again, over its width;
    in a window that travels it ends short of where the wake leaves.
    """
    derived, sample = run["derived"], run["sample"]
    start, end = derived["bed_start_m"], derived["bed_start_m"] + derived["bed_length_m"]
    margin = END_DIAMETERS * run["particle"]["median_diameter_m"]
    passed = run["sliding"]["run_in_m"] + run["sliding"]["travel_m"] - sample["length_m"] / 2.0
    if run["bed"]["ends"] == WINDOW:
        room = LEAVING_DIAMETERS * run["particle"]["median_diameter_m"]
        passed = min(passed, sample["length_m"] / 2.0 + run["bed"]["behind_m"] - room)
    return {
        "before": (start + margin, end - margin, run["bed"]["width_m"]),
        "after": (sample["length_m"] / 2.0 + AT_REST_BEHIND, passed, sample["width_m"]),
    }


def bed_packing_table(
    runs: Mapping[str, Parameters],
    run_folders: Mapping[str, Path],
    beds: Mapping[str, tuple[Path, float]],
    folder: Path,
) -> pd.DataFrame:
    """Return contacts and porosity of the beds of plain runs before and after the sample passed, by particle scale.

    run_folders: of finished runs; beds: by run, the settled bed's restart file and the height (m) of its floor
    Columns run, particle_scale, state (before, after), particles, and MEASURES, over three quarters of the thickness.
    """
    rows = []
    for name, run in runs.items():
        restarts = {"before": beds[name], "after": (cycle_files(run_folders[name], RESTART)[-1], 0.0)}
        for state, (start, end, width) in pieces(run).items():
            if end <= start:  # too short a travel for a bed at rest behind the sample
                continue
            restart, floor = restarts[state]
            bed = within(counted(run, restart, folder / f"{name}_{state}"), start, end)
            bed = bed[bed["x_m"].abs() < width / 2.0]
            edges = floor + LOOKED_AT * run["bed"]["thickness_m"] * pd.Series([0.0, 1.0]).to_numpy()
            found = packing_profile(bed, edges, width * (end - start)).iloc[0]
            names = {"run": name, "particle_scale": run["particle"]["scale"], "state": state}
            rows.append(names | {measure: found[measure] for measure in ("particles", *MEASURES)})
    return pd.DataFrame(rows)
