"""What packings of a study of particle size will cost the solver, see `workflows.engine.work`.

How long a container takes until rest is not known before it is simulated: times are scaled from three that were, at
particle scales 8, 6 and 2.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from postproc.wear.caps import GRAVITY
from workflows.cases.sliding_sample.particle_size.packings import by_scale, container
from workflows.engine import bulk_tests
from workflows.engine import decks as deck
from workflows.engine.bulk_simulations import POURED, filled_particles, simulation_bytes
from workflows.engine.case import Parameters
from workflows.engine.work import EMPTY_DIAMETERS, Stage, Work

JOB = "packing_profiles"  # rule that simulates all containers of a study, one after the other
FILLING_FREE_FALLS = 1.45  # -, until what is poured rests, in free falls through the filling; measured 1.35 to 1.64
RESTING_FREE_FALLS = 1.0  # -, from the end of the shaking until rest, in free falls of the filled height


def packing_work(runs: Mapping[str, Parameters], packing: Mapping[str, Any]) -> Work:
    """Return the job of a container per particle scale; packing: the study's settings of it, SI."""
    found = (container_stages(container(run, packing)) for run in by_scale(runs).values())
    stages = tuple(stage for stages in found for stage in stages)
    return Work(JOB, (), stages, disk_bytes=simulation_bytes(stages))


def container_stages(test: Mapping[str, Any]) -> tuple[Stage, ...]:
    """Return the stages of a container: filling until rest, then shaking and what follows until rest."""
    step, filled = bulk_tests.time_step(test), filled_particles(test)
    height = test["box"]["fill_height_m"]
    levelled = filled * (1.0 - EMPTY_DIAMETERS * test["particle"]["median_diameter_m"] / height)
    filling = FILLING_FREE_FALLS * free_fall(bulk_tests.packed_container(test)["fill_top_m"])
    shaking = test["shaking"]["duration_s"] + RESTING_FREE_FALLS * free_fall(height)
    return (
        Stage(1, deck.steps(filling, step), POURED * filled),
        Stage(0, deck.steps(shaking, step), levelled, moving=True),
    )


def free_fall(height: float) -> float:
    """Return how long (s) a fall through a height (m) takes."""
    return math.sqrt(2.0 * height / GRAVITY)
