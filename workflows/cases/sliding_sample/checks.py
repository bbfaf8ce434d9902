"""Checks of one run of a sliding sample, before any solver starts."""

from __future__ import annotations

import math

from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.sliding_sample.container_checks import CONTAINER_CHECKS
from bulkwear.workflows.cases.sliding_sample.parameters import THIN_BED_LAYERS
from bulkwear.workflows.cases.sliding_sample.range_checks import LEAST_EXTENTS, RANGE_CHECKS
from bulkwear.workflows.cases.sliding_sample.shape import clumps_stay_whole
from bulkwear.workflows.config.optimise import OPTIMISE
from bulkwear.workflows.config.patterns import highest_point, pattern_of
from bulkwear.workflows.config.run_checks import (
    Check,
    CheckedRun,
    Fault,
    deeper_than,
    element_resolves_pattern,
    element_resolves_sample,
    millimetres,
    patch_within_sample,
    pattern_fits,
    physical_modulus_known,
    reaches,
    shown_inside,
)
from bulkwear.workflows.engine.derived import ADAPTIVE, PERIODIC, ROUNDING, WINDOW, window_lengths
from bulkwear.workflows.engine.grains import CLUMP, grain_kind, largest_extent, smallest_radius
from bulkwear.workflows.engine.schedule import LEAST_CYCLE_STEPS

LARGEST_AHEAD = 5.0  # m, as the schema has it for bed.ahead_mm
LARGEST_TRAVEL = 100.0  # m, as the schema has it for sliding.travel_mm
# -, of a periodic bed, in largest extents: in a narrower one a particle can touch a neighbour and that one's image, and
# hangs between them. No wider bound, for small comparisons go down to 2.1; studies have 4.7 and more.
LEAST_WIDTH_EXTENTS = LEAST_EXTENTS


def bed_wider_than_arches(run: CheckedRun) -> Fault | None:
    """A bed, which is periodic across, is wider than two of its largest particles."""
    least = LEAST_WIDTH_EXTENTS * largest_extent(run.parameters["particle"])
    if run.parameters["bed"]["width_m"] > least:
        return None
    return "bed.width_mm", (
        f"above {millimetres(least)}, two of the largest particles: in a narrower bed, which is periodic across, they"
        " hang between a neighbour and its image"
    )


def sample_in_bed(run: CheckedRun) -> Fault | None:
    """The sample and its skirt on both sides lie within the bed's width."""
    sample, skirt = run.parameters["sample"], run.parameters["derived"]["skirt_width_m"]
    room = run.parameters["bed"]["width_m"] - 2.0 * skirt
    if sample["width_m"] <= room:
        return None
    return (
        "sample.width_mm",
        f"at most {shown_inside(room, -1)}, bed.width_mm less a skirt of {millimetres(skirt)} on each side",
    )


def skirt_in_bed(run: CheckedRun) -> Fault | None:
    """The bed is longer than the sample's skirt, ahead of the sample and behind it."""
    skirt = run.parameters["derived"]["skirt_width_m"]
    for key in ("ahead", "behind"):
        if run.parameters["bed"][f"{key}_m"] < skirt:
            return f"bed.{key}_mm", f"at least {shown_inside(skirt, 1)}, the width of the sample's skirt"
    return None


def ramp_holds_bed(run: CheckedRun) -> Fault | None:
    """A curved ramp up to the sample is curved so gently that particles follow it: its radius is at least v^2/g."""
    radius, least = (
        run.parameters["sample"]["skirt_radius_m"],
        run.parameters["sliding"]["velocity_m_per_s"] ** 2 / GRAVITY,
    )
    if radius == 0.0 or reaches(radius, least):
        return None
    return (
        "sample.skirt_radius_mm",
        f"at least {millimetres(least)}, velocity squared over gravity, or 0 for a straight ramp",
    )


def floor_drives_bed(run: CheckedRun) -> Fault | None:
    """In a periodic bed the friction of the moving floor exceeds that of the sample and its skirt, which stand still.

    Each carries the weight of the bed above it: mu_floor (L W - A) >= mu_sample A, A the area of sample and skirt.
    """
    bed, sample, skirt = (run.parameters[name] for name in ("bed", "sample", "derived"))
    if bed["ends"] != PERIODIC:
        return None
    covered = math.prod(sample[side] + 2.0 * skirt["skirt_width_m"] for side in ("width_m", "length_m"))
    floor, own = (run.parameters[name]["contact"]["sliding_friction"] for name in ("floor_material", "sample_material"))
    least = math.inf
    if floor > 0.0:
        least = bed["ahead_m"] + covered * (floor + own) / floor / bed["width_m"] - skirt["bed_length_m"]
    if reaches(bed["ahead_m"], least):
        return None
    if least > LARGEST_AHEAD:
        return "bed.floor_material", (
            f"a wall with more sliding friction than {floor:g} with bed.ends: periodic, where the floor drives the bed,"
            " or bed.ends: walls"
        )
    return (
        "bed.ahead_mm",
        f"at least {millimetres(least)} with bed.ends: periodic, so that the friction of the floor exceeds that of the"
        " sample and its skirt",
    )


def exchange_holds(run: CheckedRun) -> Fault | None:
    """A window exchanges at least as much bed as the strip that holds the fresh bed is long."""
    bed = run.parameters["bed"]
    if bed["ends"] != WINDOW:
        return None
    least = window_lengths(run.parameters["particle"])[0]
    if reaches(bed["exchange_m"], least):
        return None
    return (
        "bed.exchange_mm",
        f"at least {millimetres(least)} with bed.ends: window, the length of the strip that is held",
    )


def enough_layers(run: CheckedRun) -> Fault | None:
    """A bed has three layers of particles, unless thin beds are allowed."""
    if run.settings["bed"]["allow_thin_bed"] or not run.parameters["derived"]["thin_bed"]:
        return None
    particle = run.parameters["particle"]
    diameter, scale = particle["median_diameter_m"], particle["scale"]
    return "bed_thickness_mm", (
        f"at least {millimetres(THIN_BED_LAYERS * diameter)}, three layers of particles of {millimetres(diameter)}"
        f" (particle_scale {scale:g}), or bed.allow_thin_bed: true"
    )


def no_particle_between(run: CheckedRun) -> Fault | None:
    """The sample's top is less than a particle's radius above the floor, of clumps that of their smallest sphere."""
    radius = smallest_radius(run.parameters["particle"])
    if run.parameters["sample"]["height_above_floor_m"] < radius:
        return None
    return (
        "sample.height_above_floor_mm",
        f"below {millimetres(radius)}, the radius of the smallest particle",
    )


def pattern_in_bed(run: CheckedRun) -> Fault | None:
    """The bed is thicker than a pattern is high."""
    highest = highest_point(run.parameters["pattern"])
    if highest < run.parameters["bed"]["thickness_m"]:
        return None
    return "bed_thickness_mm", f"above {millimetres(highest)}, the height of the pattern"


def bump_not_too_steep(run: CheckedRun) -> Fault | None:
    """In a search, a bump is no higher than a stated multiple of the smaller radius of its foot."""
    pattern = pattern_of(run.parameters["pattern"])
    if pattern is None or OPTIMISE not in run.settings:
        return None
    most = run.settings[OPTIMISE]["largest_height_over_radius"] * min(pattern.half_width, pattern.half_length)
    if pattern.highest_point <= most * (1.0 + ROUNDING):
        return None
    found = millimetres(pattern.highest_point)
    return "", f"{pattern.noun} too high for its foot: {found}, allowed is at most {millimetres(most)}"


def pattern_above_floor(run: CheckedRun) -> Fault | None:
    """A pattern is less deep than the sample's top is above the floor."""
    return deeper_than(run, "height_above_floor")


def cycle_long_enough(run: CheckedRun) -> Fault | None:
    """A wear cycle has at least a hundred time steps."""
    steps = _raw_steps(run)
    if steps >= LEAST_CYCLE_STEPS:
        return None
    if run.settings["sliding"]["cycles"] == ADAPTIVE and steps < _raw_steps(run, whole_travel=True):
        return (
            "sliding.first_cycle_mm",
            f"at least {millimetres(_least_travel(run))}, {LEAST_CYCLE_STEPS} time steps",
        )
    most = int(_raw_steps(run, whole_travel=True) / LEAST_CYCLE_STEPS)
    if most < 1:
        return _travel_fault(run, "least", _least_travel(run), f"{LEAST_CYCLE_STEPS} time steps")
    return "sliding.cycles", f"at most {most}, so that a cycle has {LEAST_CYCLE_STEPS} time steps"


def travel_within_reason(run: CheckedRun) -> Fault | None:
    """The travel that a test duration makes is at most 100 m."""
    travel = run.parameters["sliding"]["travel_m"]
    return None if reaches(LARGEST_TRAVEL, travel) else _travel_fault(run, "most", LARGEST_TRAVEL, "100 m of travel")


def _travel_fault(run: CheckedRun, bound: str, travel: float, reason: str) -> Fault:
    """Return the fault of a travel (m), in terms of the key that the study gives it by."""
    if "test_duration_h" not in run.settings["sliding"]:
        return "sliding.travel_mm", f"at {bound} {millimetres(travel)}, {reason}"
    hours = run.settings["sliding"]["test_duration_h"] * travel / run.parameters["sliding"]["travel_m"]
    return "sliding.test_duration_h", f"at {bound} {hours:.6g} h at this acceleration and velocity, {reason}"


def clumps_set_in_motion(run: CheckedRun) -> Fault | None:
    """With clumps the run-in has a time step, in which they are set in motion."""
    if grain_kind(run.parameters["particle"]) != CLUMP or run.parameters["derived"]["run_in_steps"] >= 1:
        return None
    least = run.parameters["sliding"]["velocity_m_per_s"] * run.parameters["derived"]["time_step_s"]
    return (
        "sliding.run_in_mm",
        f"at least {millimetres(least)}, one time step, with clumps, which are set in motion in it",
    )


def sampled_in_cycle(run: CheckedRun) -> Fault | None:
    """Contacts are sampled more than once in a cycle, where they are sampled (`ledger: dumps`)."""
    steps = _raw_steps(run)
    if run.settings["ledger"] != "dumps" or run.settings["solver"]["sampling_interval_steps"] < steps:
        return None
    return "solver.sampling_interval_steps", f"below {int(steps)}, the time steps of a cycle"


def _raw_steps(run: CheckedRun, whole_travel: bool = False) -> float:
    """Time steps of the first wear cycle, or of the whole travel, before rounding to whole ones."""
    derived, sliding = run.parameters["derived"], run.parameters["sliding"]
    travel = sliding["travel_m"]
    if not whole_travel:
        adaptive = sliding["cycles"] == ADAPTIVE
        travel = min(sliding["first_cycle_m"], travel) if adaptive else travel / sliding["cycles"]
    return travel / sliding["velocity_m_per_s"] / derived["largest_time_step_s"]


def _least_travel(run: CheckedRun) -> float:
    step = run.parameters["derived"]["largest_time_step_s"]
    return LEAST_CYCLE_STEPS * step * run.parameters["sliding"]["velocity_m_per_s"]


SLIDING_CHECKS: tuple[Check, ...] = (
    *CONTAINER_CHECKS,
    enough_layers,
    pattern_in_bed,
    pattern_fits,
    bump_not_too_steep,
    pattern_above_floor,
    no_particle_between,
    bed_wider_than_arches,
    sample_in_bed,
    skirt_in_bed,
    ramp_holds_bed,
    floor_drives_bed,
    exchange_holds,
    clumps_stay_whole,
    element_resolves_sample,
    element_resolves_pattern,
    patch_within_sample,
    travel_within_reason,
    cycle_long_enough,
    clumps_set_in_motion,
    sampled_in_cycle,
    physical_modulus_known,
    *RANGE_CHECKS,
)
