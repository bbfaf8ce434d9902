"""What the simulations of a calibration will cost the solver, see `workflows.engine.work`.

How long a test takes until rest is not known before it is simulated. Times are scaled from fourteen shear boxes
that were: 0.2 m long and high, particles five times as large, sliding friction 0.15 to 0.66, rolling 0.16 to 0.63.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from postproc.wear.caps import GRAVITY
from workflows.cases.calibration.driver import SHEAR_BOX, test_of
from workflows.engine import bulk_tests
from workflows.engine import decks as deck
from workflows.engine.bulk_simulations import POURED, filled_particles
from workflows.engine.case import Parameters
from workflows.engine.work import Stage

FILLING_FREE_FALLS = 1.3  # -, until the poured box rests, in free falls through its filling; measured 1.2 to 1.4
FLOWING_FREE_FALLS = 11.8  # -, until the heap rests, in free falls of the box's height; measured 9.3 to 14.7
SLOT_FLOW = 0.73  # -, of the flow from a slot, (D - k d)^1.5 sqrt(g); gives the 5.6 s that the slot was chosen for
OUTFLOW_SHARE = 0.75  # -, of the content that a draw-down test's slot lets out: two slopes of some 30 degrees stay
STAYING = {SHEAR_BOX: 0.54, "draw_down": 1.0}  # -, particles that the solver has while it flows, mean over those filled


def stages_of(test: Mapping[str, Any], number: int) -> tuple[Stage, ...]:
    """Return the stages of that many simulations of a bulk test: filling, then flowing until rest."""
    step, particles = bulk_tests.time_step(test), filled_particles(test)
    poured = bulk_tests.DECKS[test["kind"]](test)["fill_top_m"]
    filling = FILLING_FREE_FALLS * math.sqrt(2.0 * poured / GRAVITY)
    flowing = FLOWING_FREE_FALLS * math.sqrt(2.0 * test["box"]["fill_height_m"] / GRAVITY) + discharge_time(test)
    triangles = sum(len(faces) for _, faces in bulk_tests.surfaces(test).values())
    left = STAYING[test["kind"]] * particles
    return (
        Stage(number, number * deck.steps(filling, step), POURED * particles, triangles),
        Stage(0, number * deck.steps(flowing, step), left, triangles, moving=True),
    )


def discharge_time(test: Mapping[str, Any]) -> float:
    """Return about how long (s) the slot of a draw-down test flows; 0 for a shear box (Beverloo et al. 1961)."""
    if test["kind"] == SHEAR_BOX:
        return 0.0
    diameter = test["particle"]["median_diameter_m"]
    free = bulk_tests.slot_length(test) - bulk_tests.EMPTY_ANNULUS * diameter
    content = OUTFLOW_SHARE * test["box"]["length_m"] * test["box"]["fill_height_m"]
    return content / (SLOT_FLOW * math.sqrt(GRAVITY) * free**1.5)


def calibration_stages(parameters: Parameters) -> tuple[Stage, ...]:
    """Return the stages of a calibration: of each test the most simulations, and the repeats of two pairs."""
    asked = parameters["calibration"]
    numbers = {kind: asked["most"][kind] + 2 * asked["repeats"] for kind in asked["tests"]}
    found = (stages_of(test_of(parameters, kind, {}, 0), number) for kind, number in numbers.items())
    return tuple(stage for stages in found for stage in stages)


def sizes_stages(runs: Sequence[Parameters]) -> tuple[Stage, ...]:
    """Return the stages of the shear boxes of all sizes with all their packings."""
    found = (stages_of(test_of(run, SHEAR_BOX, {}, 0), run["calibration"]["repeats"]) for run in runs)
    return tuple(stage for stages in found for stage in stages)
