"""Bulk tests of a calibration: from a study's parameters to a test, its deck and meshes, and what it will cost.

Tests are as in `workflows.engine.bulk_tests`; the box of a draw-down test has opening, opening_m, lower_height_m and
front_and_back besides, and its floor_material is that of its front and back walls. That of a wall shear test has
drag_speed_m_per_s and drag_m, its wall_material is that of its plate, and its floor_material that of its side walls.

How long a test takes until rest is not known before it is simulated. Times are scaled from fourteen shear boxes
that were: 0.2 m long and high, particles five times as large, sliding friction 0.15 to 0.66, rolling 0.16 to 0.63.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.engine import decks as deck
from bulkwear.workflows.engine.bulk_simulations import filled_particles
from bulkwear.workflows.engine.bulk_tests import Kind, Meshes, fill_top, filled_box, margin_of, register, time_step
from bulkwear.workflows.engine.case import Parameters
from bulkwear.workflows.engine.derived import PERIODIC, WALLS
from bulkwear.workflows.engine.grains import SPHERE, grain_kind
from bulkwear.workflows.engine.templates import used_sections
from bulkwear.workflows.engine.work import Stage

SHEAR_BOX, DRAW_DOWN, WALL_SHEAR = "shear_box", "draw_down", "wall_shear"
SECOND_WALL = {SHEAR_BOX: "floor_material", DRAW_DOWN: "front_material", WALL_SHEAR: "side_material"}
SIMULATIONS = "simulations"  # folder of a study's
PIT_DIAMETERS = 10.0  # -, domain below the floor of a shear box, where what flows out is taken out
EMPTY_ANNULUS = 1.4  # -, of an opening no particle's centre passes, in particle diameters; Beverloo et al. 1961
LEAST_WIDTH_DIAMETERS = 4.0  # -, of a periodic slice
MESH_CLEARANCE = 1e-6  # m, between a mesh and the domain's faces
FILLING_FREE_FALLS = 1.3  # -, until the poured box rests, in free falls through its filling; measured 1.2 to 1.4
FLOWING_FREE_FALLS = 11.8  # -, until the heap rests, in free falls of the box's height; measured 9.3 to 14.7
SLOT, SQUARE = "slot", "square"  # values of draw_down.opening
SLOT_FLOW = 0.73  # -, of the flow from a slot, (D - k d)^1.5 sqrt(g); gives the 5.6 s that the slot was chosen for
SQUARE_FLOW = 0.74  # -, the same of a square, (D - k d)^2.5 sqrt(g): Beverloo's 0.58 of a circle, by area
OUTFLOW_SHARE = 0.75  # -, of the content that a draw-down test's opening lets out: two slopes of some 30 degrees stay
REPEATED_PAIRS = 3  # that found first, that it is compared with, and the recommended one
FIRST_REPEAT = 500  # number of the first packing that is repeated; a calibration has fewer, and shares none
FORCE_MEANS = 200  # means of a plate's forces over a drag
STAYING = {
    SHEAR_BOX: 0.54,
    DRAW_DOWN: 1.0,
    WALL_SHEAR: 1.0,
}  # -, particles that the solver has while it flows, mean over those filled


# ---------------------------------------------------------------- tests


def test_of(parameters: Parameters, kind: str, values: Mapping[str, float], seed: int) -> dict[str, Any]:
    """Return a bulk test with values of the calibrated parameters, by dotted name."""
    box, walls = dict(parameters[kind]), parameters["walls"]
    second = box.pop(SECOND_WALL[kind])
    test = {
        "kind": kind,
        "wall_material": walls[box.pop("wall_material")],
        "floor_material": walls[second],
        "box": {**box, "width_m": simulated_width(box, parameters["particle"])},
        "rest": dict(parameters["rest"]),
        "particle": parameters["particle"],
        **used_sections(kind, parameters, front_and_back=box.get("front_and_back")),
        "seed": seed,
    }
    return with_values(test, values)


def with_values(test: Mapping[str, Any], values: Mapping[str, float]) -> dict[str, Any]:
    """Return a test with other values at dotted names, e.g. particle.contact.sliding_friction."""
    changed = copy.deepcopy(dict(test))
    for name, value in values.items():
        *sections, key = name.split(".")
        target = changed
        for section in sections:
            target = target[section]
        target[key] = value
    return changed


def opening_length(test: Mapping[str, Any]) -> float:
    """Return the length (m) of the simulated opening: that of the real one, wider for coarse-grained particles.

    A slot of length D discharges as (D - k d)^(3/2), a square as (D - k d)^(5/2): no centre passes within k d / 2 of
    its edges (W. A. Beverloo, H. A. Leniger and J. van de Velde, Chemical Engineering Science 15 (1961) 260-269).
    D - k d is kept, k = 1.4.
    """
    particle = test["particle"]
    real = particle["median_diameter_m"] / particle["scale"]
    return test["box"]["opening_m"] + EMPTY_ANNULUS * (particle["median_diameter_m"] - real)


def simulated_width(box: Mapping[str, Any], particle: Mapping[str, Any]) -> float:
    """Return the width (m) of a box as simulated: a periodic slice holds at least four median diameters.

    Narrower ones hold a slope up (Yan 2022, section 3.3.2).
    """
    if box.get("front_and_back", PERIODIC) != PERIODIC:
        return box["width_m"]
    return max(box["width_m"], LEAST_WIDTH_DIAMETERS * particle["median_diameter_m"])


def walls_of(test: Mapping[str, Any]) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Return the walls of a test that stand when it is over, as lines ((y, z), (y, z)) in m."""
    length, height = test["box"]["length_m"], test["box"]["fill_height_m"]
    if test["kind"] == SHEAR_BOX:
        return [((0.0, 0.0), (0.0, height)), ((0.0, 0.0), (length, 0.0))]
    if test["kind"] == WALL_SHEAR:
        return [((0.0, 0.0), (0.0, height)), ((length, 0.0), (length, height)), ((0.0, 0.0), (length, 0.0))]
    low, opening = -test["box"]["lower_height_m"], opening_length(test)
    return [
        ((0.0, low), (0.0, height)),
        ((length, low), (length, height)),
        ((0.0, low), (length, low)),
        ((0.0, 0.0), ((length - opening) / 2.0, 0.0)),
        (((length + opening) / 2.0, 0.0), (length, 0.0)),
    ]


# ---------------------------------------------------------------- decks and meshes


def shear_box(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of the deck of a shear box."""
    return {**filled_box(test, ("particle", "side walls", "floor")), **_shear_box_domain(test), **_pit(test)}


def draw_down(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of the deck of a draw-down test."""
    return {
        **filled_box(test, ("particle", "side walls and floors", "front and back walls")),
        **_draw_down_domain(test),
        "half_domain_m": _half_domain(test),
        "lower_floor_m": -test["box"]["lower_height_m"],
        "front_and_back": test["box"]["front_and_back"],
        "opening": test["box"]["opening"],
    }


def wall_shear(test: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of the deck of a wall shear test."""
    box, margin = test["box"], margin_of(test)
    every = deck.steps(drag_time(test) / FORCE_MEANS, time_step(test))
    return {
        **filled_box(test, ("particle", "plate", "side walls")),
        "outflow": "none",
        "domain_back_m": -margin,
        "domain_front_m": box["length_m"] + margin,
        "domain_bottom_m": -margin,
        "domain_top_m": fill_top(test) + margin,
        "drag_speed_m_per_s": box["drag_speed_m_per_s"],
        "drag_steps": FORCE_MEANS * every,
        "force_interval_steps": every,
    }


def drag_time(test: Mapping[str, Any]) -> float:
    """Return how long (s) the plate of a wall shear test is drawn."""
    return test["box"]["drag_m"] / test["box"]["drag_speed_m_per_s"]


def _shear_box_domain(test: Mapping[str, Any]) -> dict[str, float]:
    """Return the domain of a shear box: what slides out over the edge flies no further than the box is high."""
    return {
        "domain_back_m": -margin_of(test),
        "domain_front_m": test["box"]["length_m"] + test["box"]["fill_height_m"],
        "domain_bottom_m": -PIT_DIAMETERS * max(test["particle"]["diameters_m"]),
        "domain_top_m": fill_top(test) + margin_of(test),
    }


def _pit(test: Mapping[str, Any]) -> dict[str, float]:
    """Return the pit below a shear box in which clumps come to rest, since the solver takes none out; nothing of
    spheres. It is as deep as the box was filled: what flows out fills less than its triangle.
    """
    if grain_kind(test["particle"]) == SPHERE:
        return {}
    domain, depth = _shear_box_domain(test), test["box"]["fill_height_m"] + margin_of(test)
    return {
        "pit_back_m": domain["domain_back_m"] + margin_of(test) / 2.0,
        "pit_front_m": domain["domain_front_m"] - margin_of(test) / 2.0,
        "pit_bottom_m": -depth,
        "domain_bottom_m": -depth - margin_of(test),
    }


def _draw_down_domain(test: Mapping[str, Any]) -> dict[str, float]:
    return {
        "domain_back_m": -margin_of(test),
        "domain_front_m": test["box"]["length_m"] + margin_of(test),
        "domain_bottom_m": -test["box"]["lower_height_m"] - margin_of(test),
        "domain_top_m": fill_top(test) + margin_of(test),
    }


def _half_domain(test: Mapping[str, Any]) -> float:
    """Return half the domain's width (m): that of the box, and room behind its front and back where they are walls."""
    return test["box"]["width_m"] / 2.0 + (margin_of(test) if test["box"].get("front_and_back") == WALLS else 0.0)


def shear_box_surfaces(test: Mapping[str, Any]) -> Meshes:
    """Return the flat meshes that the deck of a shear box reads."""
    half = _half_domain(test)
    return {
        "floor": _rectangle(-half, 0.0, test["box"]["length_m"], 0.0, half),
        "outflow": _outflow(test, _shear_box_domain(test)),
    }


def draw_down_surfaces(test: Mapping[str, Any]) -> Meshes:
    """Return the flat meshes that the deck of a draw-down test reads."""
    half, length, opening = _half_domain(test), test["box"]["length_m"], opening_length(test)
    back, front = (length - opening) / 2.0, (length + opening) / 2.0
    side = 0.5 * opening if test["box"]["opening"] == SQUARE else half
    beside = [_rectangle(side, back, front, 0.0, half), _rectangle(-half, back, front, 0.0, -side)]
    return {
        "upper_floor": _together(
            _rectangle(-half, 0.0, back, 0.0, half),
            _rectangle(-half, front, length, 0.0, half),
            *(beside if side < half else ()),
        ),
        "gate": _rectangle(-side, back, front, 0.0, side),
        "outflow": _outflow(test, _draw_down_domain(test)),
    }


def wall_shear_surfaces(test: Mapping[str, Any]) -> Meshes:
    """Return the flat mesh that the deck of a wall shear test reads."""
    half = _half_domain(test)
    return {"plate": _rectangle(-half, 0.0, test["box"]["length_m"], 0.0, half)}


def _outflow(test: Mapping[str, Any], domain: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return the mesh below the floor, over the whole domain, that what flows out passes."""
    start, end = domain["domain_back_m"] + MESH_CLEARANCE, domain["domain_front_m"] - MESH_CLEARANCE
    half = _half_domain(test)
    return _rectangle(-half, start, end, -margin_of(test), half)


def _rectangle(left: float, start: float, end: float, height: float, right: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a level rectangle from left to right along x, from start to end along y (m)."""
    points = [(left, start), (right, start), (right, end), (left, end)]
    return np.array([(x, y, height) for x, y in points]), np.array([[0, 1, 2], [0, 2, 3]])


def _together(*meshes: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return meshes as one."""
    before = np.cumsum([0, *(len(points) for points, _ in meshes)])
    faces = [triangles + first for (_, triangles), first in zip(meshes, before, strict=False)]
    return np.concatenate([points for points, _ in meshes]), np.concatenate(faces)


KINDS = {
    SHEAR_BOX: Kind(shear_box, shear_box_surfaces),
    DRAW_DOWN: Kind(draw_down, draw_down_surfaces),
    WALL_SHEAR: Kind(wall_shear, wall_shear_surfaces),
}
for NAME, KIND in KINDS.items():
    register(NAME, KIND)


# ---------------------------------------------------------------- what simulations will cost the solver


def stages_of(test: Mapping[str, Any], number: int) -> tuple[Stage, ...]:
    """Return the stages of that many simulations of a bulk test: filling, then flowing until rest, or the drag."""
    step, particles, kind = time_step(test), filled_particles(test), KINDS[test["kind"]]
    filling = FILLING_FREE_FALLS * math.sqrt(2.0 * fill_top(test) / GRAVITY)
    flowing = drag_time(test) if test["kind"] == WALL_SHEAR else _flowing_time(test)
    triangles = sum(len(faces) for _, faces in kind.surfaces(test).values())
    left = STAYING[test["kind"]] * particles
    return (
        Stage(number, number * deck.steps(filling, step), particles, triangles),
        Stage(0, number * deck.steps(flowing, step), left, triangles, moving=True),
    )


def _flowing_time(test: Mapping[str, Any]) -> float:
    """Return about how long (s) an opened box flows until all rests."""
    return FLOWING_FREE_FALLS * math.sqrt(2.0 * test["box"]["fill_height_m"] / GRAVITY) + discharge_time(test)


def discharge_time(test: Mapping[str, Any]) -> float:
    """Return about how long (s) the opening of a draw-down test flows; 0 for a shear box (Beverloo et al. 1961)."""
    if test["kind"] == SHEAR_BOX:
        return 0.0
    box, diameter = test["box"], test["particle"]["median_diameter_m"]
    free = opening_length(test) - EMPTY_ANNULUS * diameter
    flow = SQUARE_FLOW * free**2.5 if box["opening"] == SQUARE else SLOT_FLOW * free**1.5 * box["width_m"]
    content = OUTFLOW_SHARE * box["length_m"] * box["width_m"] * box["fill_height_m"]
    return content / (flow * math.sqrt(GRAVITY))


def calibration_stages(parameters: Parameters) -> tuple[Stage, ...]:
    """Return the stages of a calibration: of each test the most simulations, and the repeats of three pairs."""
    asked = parameters["calibration"]
    numbers = {kind: asked["most"][kind] + REPEATED_PAIRS * asked["repeats"] for kind in asked["tests"]}
    found = (stages_of(test_of(parameters, kind, {}, 0), number) for kind, number in numbers.items())
    return tuple(stage for stages in found for stage in stages)


def sizes_stages(runs: Sequence[Parameters]) -> tuple[Stage, ...]:
    """Return the stages of the shear boxes of all sizes with all their packings."""
    found = (stages_of(test_of(run, SHEAR_BOX, {}, 0), run["calibration"]["repeats"]) for run in runs)
    return tuple(stage for stages in found for stage in stages)
