"""Checks of the boxes of one run of a calibration, before any solver starts: what they hold, and whether it rests."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from bulkwear.postproc.flow.free_surface import CELL_DIAMETERS, END_DIAMETERS, LEAST_COLUMNS
from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.calibration import boxes
from bulkwear.workflows.config.run_checks import SHOWN, Check, CheckedRun, Fault, reaches
from bulkwear.workflows.engine.bulk_simulations import filled_particles
from bulkwear.workflows.engine.bulk_tests import fill_top
from bulkwear.workflows.engine.derived import PERIODIC
from bulkwear.workflows.engine.grains import largest_extent
from bulkwear.workflows.engine.pouring import bulk_density

LEAST_DIAMETERS = 10.0  # -, of a box: below, no slope can be measured on it
LEAST_DRAG_DIAMETERS = 6.0  # -, of a plate's way. Measured: with friction 0.7 the bed slides after 2.8
LEAST_OPENING_DIAMETERS = (
    5.0  # -, of an opening as simulated. Measured: a slot of 4.0 was blocked, friction 0.32 and 0.37
)
LEAST_EXTENTS = 3.0  # -, of a box between walls and of an opening, in largest extents: fewer stand as an arch
LEAST_PERIODIC_EXTENTS = 2.0  # -, of a periodic slice: in a narrower one a particle hangs between another and its image
LEAST_FILLED, MOST_FILLED = 0.5, 1.5  # -, of a filling by its bulk density, wider than beds are loose and dense
FASTEST_OUTFLOW = 0.75  # -, over the time that it is estimated to take. Measured: 0.91
LEAST_FLOOR_DIAMETERS = 2.0 * END_DIAMETERS + LEAST_COLUMNS * CELL_DIAMETERS  # -, of a slope that can be measured
MOST_PARTICLES = 10_000_000  # of a test, which a single core simulates: they take it months
DIGITS = 4  # significant, of a limit in a sentence


def _asked(run: CheckedRun) -> dict[str, dict[str, Any]]:
    """Return {section: test} of the boxes that are simulated: those of the tests, and shear boxes of all sizes."""
    kinds = dict.fromkeys((boxes.SHEAR_BOX, *run.parameters["calibration"]["tests"]))
    return {kind: boxes.test_of(run.parameters, kind, {}, 0) for kind in kinds}


def enough(least: float) -> str:
    """Return a least value as a sentence shows it, rounded up, so that it `reaches` itself."""
    return _rounded(least * (1.0 - SHOWN), math.ceil)


def at_most(most: float) -> str:
    """Return a largest value as a sentence shows it, rounded down."""
    return _rounded(most * (1.0 + SHOWN), math.floor)


def _rounded(value: float, whole: Callable[[float], int]) -> str:
    """Return a value with DIGITS significant digits, of which `whole` makes a whole number."""
    if value <= 0.0:
        return "0"
    step = 10.0 ** (math.floor(math.log10(value)) + 1 - DIGITS)
    return f"{whole(value / step) * step:.{DIGITS}g}"


def box_holds_particles(run: CheckedRun) -> Fault | None:
    """A box is at least ten median diameters of its (coarse-grained) particles long and high, and three largest."""
    particle = run.parameters["particle"]
    median, largest = LEAST_DIAMETERS * particle["median_diameter_m"], LEAST_EXTENTS * largest_extent(particle)
    words = "ten particle diameters" if median >= largest else "three of the largest particles"
    for section in _asked(run):
        for key in ("length", "fill_height"):
            if not reaches(run.parameters[section][f"{key}_m"], max(median, largest)):
                return f"{section}.{key}_mm", f"at least {enough(1e3 * max(median, largest))}, {words}"
    return None


def box_wide_enough(run: CheckedRun) -> Fault | None:
    """Between walls a box is three largest particles wide, a periodic slice more than two, so that none is held up."""
    largest = largest_extent(run.parameters["particle"])
    for section, test in _asked(run).items():
        periodic = test["box"].get("front_and_back", PERIODIC) == PERIODIC
        least = (LEAST_PERIODIC_EXTENTS if periodic else LEAST_EXTENTS) * largest
        if not reaches(test["box"]["width_m"], least):
            words = "two of the largest particles" if periodic else "three of the largest particles between walls"
            return f"{section}.width_mm", f"at least {enough(1e3 * least)}, {words}"
    return None


def opening_lets_particles_pass(run: CheckedRun) -> Fault | None:
    """A draw-down test's opening is at least five median diameters and three largest particles long as simulated,
    at most half as long as the box, and a square one no wider than the box."""
    if boxes.DRAW_DOWN not in run.parameters["calibration"]["tests"]:
        return None
    box, particle = run.parameters["draw_down"], run.parameters["particle"]
    wider = boxes.opening_length({"box": box, "particle": particle}) - box["opening_m"]
    median, largest = LEAST_OPENING_DIAMETERS * particle["median_diameter_m"], LEAST_EXTENTS * largest_extent(particle)
    words = "five particle diameters" if median >= largest else "three of the largest particles"
    low = max(median, largest) - wider
    if not (reaches(box["opening_m"], low) and box["opening_m"] <= box["length_m"] / 2.0):
        allowed = f"from {enough(1e3 * low)} ({words} as simulated) to half the box's length"
        return "draw_down.opening_mm", allowed
    widest = boxes.simulated_width(box, particle) - wider
    if box["opening"] == boxes.SQUARE and not reaches(widest, box["opening_m"]):
        return (
            "draw_down.opening_mm",
            f"at most {at_most(1e3 * widest)} with draw_down.opening: square, the box's width",
        )
    return None


def floor_holds_slopes(run: CheckedRun) -> Fault | None:
    """On both sides of a draw-down test's opening the floor is long enough for the slope that is measured on it."""
    test = _asked(run).get(boxes.DRAW_DOWN)
    if test is None:
        return None
    opening, floor = boxes.opening_length(test), LEAST_FLOOR_DIAMETERS * test["particle"]["median_diameter_m"]
    least = opening + 2.0 * floor
    if reaches(test["box"]["length_m"], least):
        return None
    return "draw_down.length_mm", (
        f"at least {enough(1e3 * least)}, the opening as simulated, {1e3 * opening:.4g}, and six particle diameters"
        " beside it, on which slopes are measured"
    )


def drag_makes_it_slide(run: CheckedRun) -> Fault | None:
    """A plate is drawn at least six median diameters: the bed slides on it in the second half, which is measured."""
    least = LEAST_DRAG_DIAMETERS * run.parameters["particle"]["median_diameter_m"]
    asked = boxes.WALL_SHEAR in run.parameters["calibration"]["tests"]
    if asked and not reaches(run.parameters["wall_shear"]["drag_m"], least):
        return "wall_shear.drag_mm", f"at least {enough(1e3 * least)}, six particle diameters"
    return None


def mass_fills_the_box(run: CheckedRun) -> Fault | None:
    """A mass that is told fills its box about as high as is told."""
    for section, test in _asked(run).items():
        box, told = test["box"], test["box"].get("fill_mass_kg_per_m")
        expected = bulk_density(test["particle"]) * box["length_m"] * box["fill_height_m"]
        low, high = LEAST_FILLED * expected, MOST_FILLED * expected
        if told is not None and not (reaches(told, low) and reaches(high, told)):
            makes = f"{section}.fill_height_mm at the bulk density makes {expected:.4g}"
            return f"{section}.fill_mass_kg_per_m", f"from {enough(low)} to {at_most(high)}: {makes}"
    return None


def particles_within_reason(run: CheckedRun) -> Fault | None:
    """A test has fewer particles than a core simulates in months."""
    held_by = {section: filled_particles(test) for section, test in _asked(run).items()}
    section = max(held_by, key=held_by.__getitem__)
    held, scale = held_by[section], run.parameters["particle"]["scale"]
    if reaches(MOST_PARTICLES, held):
        return None
    least = scale * (held / MOST_PARTICLES) ** (1.0 / 3.0)
    found = f"{section} holds about {held:.2g} particles, at most {MOST_PARTICLES:.2g} are allowed"
    return "particle_scale", f"at least {enough(least)}, or a smaller box: {found}"


def rest_can_be_found(run: CheckedRun) -> Fault | None:
    """The longest time of a filling, and of what flows, is enough for a fall or the outflow, and the looks that must
    find rest."""
    rest = run.parameters["rest"]
    looks = rest["calm_checks"] * rest["check_interval_s"]
    for section, test in _asked(run).items():
        moving = {
            "a fall through the filling": math.sqrt(2.0 * fill_top(test) / GRAVITY),
            "the outflow": FASTEST_OUTFLOW * boxes.discharge_time(test) if section == boxes.DRAW_DOWN else 0.0,
        }
        longest = max(moving, key=moving.__getitem__)
        if not reaches(rest["longest_s"], looks + moving[longest]):
            return "rest.longest_s", (
                f"at least {enough(looks + moving[longest])}: {longest} of {section} takes {moving[longest]:.4g} s, and"
                f" the looks that rest.calm_checks asks for {looks:.4g} s"
            )
    return None


BOX_CHECKS: tuple[Check, ...] = (
    box_holds_particles,
    box_wide_enough,
    opening_lets_particles_pass,
    floor_holds_slopes,
    drag_makes_it_slide,
    mass_fills_the_box,
    particles_within_reason,
    rest_can_be_found,
)
