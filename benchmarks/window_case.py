"""The runs that compare a travelling window with a bed of 2 m: a sample, plain or convex, in several beds, each of them
filled several times.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.runs import (
    FIRST_SEED,
    SMALL_BUMPS,
    STRAIGHT_RAMP,
    bed_file,
    changed,
    simulated_run,
    surface_file,
)
from bulkwear.workflows.config.design import Run, load_study
from bulkwear.workflows.config.packings import SEED_SPACING
from bulkwear.workflows.engine.chain import Chain, total_steps
from bulkwear.workflows.engine.derived import WALLS, WINDOW
from bulkwear.workflows.engine.solver import SEARCHES

STUDY, ROW, SURFACES = "demo", "R9", ("plain", "convex")
# -, of the Rayleigh time: the source's 5e-6 s, between, and what the screening takes
SOURCE_FRACTION, MIDDLE_FRACTION, FRACTION = 0.23, 0.3, 0.4
FULL, OWN_SEARCH = "bed of 2 m, stock search", "bed of 2 m"
WHOLE = {"ends": WALLS, "ahead_mm": 300, "behind_mm": 100}
BEDS: dict[str, dict[str, Any]] = {  # the first, as the source ran it, is what others are compared with
    FULL: {"bed": WHOLE, "fraction": SOURCE_FRACTION, "search": SEARCHES[1]},
    OWN_SEARCH: {"bed": WHOLE, "fraction": SOURCE_FRACTION},
    "window 100 + 50": {
        "bed": {"ends": WINDOW, "ahead_mm": 100, "behind_mm": 50},
        "fraction": SOURCE_FRACTION,
    },
    f"window 100 + 50, time step {MIDDLE_FRACTION:g}": {
        "bed": {"ends": WINDOW, "ahead_mm": 100, "behind_mm": 50},
        "fraction": MIDDLE_FRACTION,
    },
    f"window 100 + 50, time step {FRACTION:g}": {
        "bed": {"ends": WINDOW, "ahead_mm": 100, "behind_mm": 50},
        "fraction": FRACTION,
    },
    f"window 150 + 200, time step {FRACTION:g}": {
        "bed": {"ends": WINDOW, "ahead_mm": 150, "behind_mm": 200},
        "fraction": FRACTION,
    },
}
SETTINGS: dict[str, Any] = {
    **SMALL_BUMPS,
    "fidelity": "standard",
    "particle_scale": 4.5,
    "sample": {"width_mm": 100, "length_mm": 100, "element_size_mm": 2, **STRAIGHT_RAMP},
    "bed": {"width_mm": 150, "exchange_mm": 35},
    "sliding": {"run_in_mm": 300, "travel_mm": 1200, "cycles": 4},
    "wear": {"deform": False},
    "solver": {"picture_interval_mm": 100, "wear_interval_mm": 50},
}
# The small case has few particles per triangle. Elements of half a particle follow bumps of the radius of one.
ELEMENT_SIZE = 0.005  # m
BUMPS = {"major_radius_m": 0.008, "minor_radius_m": 0.008, "column_spacing_m": 0.06}
QUICK: dict[str, Any] = {
    **SETTINGS,
    "particle_scale": 8.0,
    "sample": {"width_mm": 40, "length_mm": 40, "element_size_mm": 2, **STRAIGHT_RAMP},
    "bed": {"width_mm": 60, "exchange_mm": 55, "allow_thin_bed": True},
    "sliding": {"run_in_mm": 50, "travel_mm": 200, "cycles": 2},
}
PARTICLE_STEPS_PER_SECOND = 2.5e6  # of a core, all else included: for the estimate beforehand


@dataclass(frozen=True)
class Case:
    """A run: surface of the sample, name of the bed in `BEDS`, seed of its packing."""

    surface: str
    bed: str
    seed: int

    @property
    def folder(self) -> str:
        """Path of its folder within that of all."""
        return f"{self.surface}/{self.bed.replace(' ', '_').replace(',', '')}/{self.seed}"


def packing(surfaces: Iterable[str], number: int) -> list[Case]:
    """Return the runs of a packing (0, 1, ...): every surface in every bed, in turn."""
    return [Case(surface, bed, FIRST_SEED + number * SEED_SPACING) for surface in surfaces for bed in BEDS]


def simulated(case: Case, folder: Path, settings: Mapping[str, Any]) -> Chain:
    """Return a run, simulated from where it stopped; its sample is meshed and its bed filled unless they are there."""
    return simulated_run(chain_of(case, folder, settings), case.bed)


def chain_of(case: Case, folder: Path, settings: Mapping[str, Any]) -> Chain:
    """Return a run as the driver sees it, its folder made. Both samples start from beds that settle equally high."""
    given = BEDS[case.bed]
    bed = {**settings["bed"], **given["bed"], "seed": case.seed}
    search = given.get("search", SEARCHES[0])
    solver = {**settings["solver"], "rayleigh_fraction": given["fraction"], "search": search}
    study = load_study(STUDY, overrides={**settings, "bed": bed, "solver": solver})
    runs = [coarser(run) for run in study.runs]
    beds, bed_of = study.case.beds(runs)
    place = folder / case.folder
    place.mkdir(parents=True, exist_ok=True)
    (run,) = (run for run in runs if (run.row, run.surface) == (ROW, case.surface))
    bed = beds[bed_of[run.name]]
    return Chain(
        f"{run.name}, {case.bed}, {case.seed}",
        place / "run",
        study.case,
        run.parameters,
        surface_file(place, "surface", study.case, run.parameters),
        bed,
        bed_file(place, bed),
    )


def coarser(run: Run) -> Run:
    """Return the run with the elements and the bumps of this comparison."""
    return changed(run, {"sample": {"element_size_m": ELEMENT_SIZE}, "pattern": BUMPS})


def particle_steps(chain: Chain) -> float:
    """Return about how many particle-steps a run has, known before it starts."""
    return chain.parameters["derived"]["bed_particles"] * total_steps(chain)


def said_beforehand(surfaces: Sequence[str], packings: int, settings: Mapping[str, Any]) -> str:
    """Return in a phrase how much there is to simulate, and about how long a core takes for it."""
    with tempfile.TemporaryDirectory() as folder:
        chains = [chain_of(case, Path(folder), settings) for case in packing(surfaces, 0)]
        steps = packings * sum(map(particle_steps, chains))
    minutes = steps / PARTICLE_STEPS_PER_SECOND / 60.0
    return (
        f"{packings} packings of each bed, {packings * len(chains)} runs: {steps:.2g} particle-steps, estimated"
        f" beforehand as {minutes:.0f} minutes of a core at {PARTICLE_STEPS_PER_SECOND:.2g} of them per second"
    )
