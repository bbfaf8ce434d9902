"""Checks of a sliding sample whose settings lie in their ranges and make no bed, no mesh or no wear together."""

from __future__ import annotations

import math

from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.config.patterns import pattern_of
from bulkwear.workflows.config.run_checks import Check, CheckedRun, Fault, millimetres, reaches
from bulkwear.workflows.config.wear_checks import taken_up, worn_within
from bulkwear.workflows.engine.derived import ADAPTIVE, ROUNDING, WINDOW
from bulkwear.workflows.engine.grains import largest_extent
from bulkwear.workflows.engine.pouring import bulk_density

LEAST_EXTENTS = 2.0  # -, of a bed's length and, where it is periodic, its width, in largest extents of a particle
LEAST_LAYERS = 0.5  # -, of a bed: most of the floor is bare below it, and studies have 1.4 and more
# -, bed ahead of a sample and behind it in a travelling window, in largest extents: less of it all feels the sample.
# With 3.5 behind wear was 3.5 to 6 % too small (docs/travelling_window.md); studies have 5.2 ahead and 10 behind.
LEAST_WINDOW_EXTENTS = 3.0
# -, height of a bump over the smaller radius of its foot: the mesh of steeper ones fails now and then from 14 on
MESHED_STEEPNESS = 12.0
LEAST_SKIRT = 0.13  # -, width of a straight skirt over an element: triangles across 0.12 have less than 10 degrees
HUNDREDTHS = 100.0  # of a scale, to which a bound in a sentence is rounded


def bed_has_particles(run: CheckedRun) -> Fault | None:
    """A bed is at least half as thick as a particle, thin ones that are allowed too."""
    particle = run.parameters["particle"]
    least = LEAST_LAYERS * particle["median_diameter_m"]
    if reaches(run.parameters["bed"]["thickness_m"], least):
        return None
    return "bed_thickness_mm", (
        f"at least {millimetres(least)}, {LEAST_LAYERS:g} layers of particles (particle_scale {particle['scale']:g}),"
        " where thin beds are allowed too"
    )


def bed_longer_than_arches(run: CheckedRun) -> Fault | None:
    """A bed is longer than two of its largest particles, which hang between its ends in a shorter one."""
    least = LEAST_EXTENTS * largest_extent(run.parameters["particle"])
    length = run.parameters["derived"]["bed_length_m"]
    if length > least:
        return None
    ahead = run.parameters["bed"]["ahead_m"] + least - length
    return "bed.ahead_mm", (
        f"above {millimetres(ahead)}, so that the bed is longer than two of the largest particles, {millimetres(least)}"
    )


def window_holds_bed(run: CheckedRun) -> Fault | None:
    """In a travelling window there is bed ahead of the sample and behind it, three of the largest particles each."""
    bed, particle = run.parameters["bed"], run.parameters["particle"]
    least = LEAST_WINDOW_EXTENTS * largest_extent(particle)
    short = next((key for key in ("ahead", "behind") if not reaches(bed[f"{key}_m"], least)), None)
    if bed["ends"] != WINDOW or short is None:
        return None
    most = math.floor(HUNDREDTHS * particle["scale"] * bed[f"{short}_m"] / least) / HUNDREDTHS
    scale = f", or a particle_scale of at most {most:g}" if most >= 1.0 else ""
    return f"bed.{short}_mm", (
        f"at least {millimetres(least)} with bed.ends: window, three of the largest particles{scale}"
    )


def bump_can_be_meshed(run: CheckedRun) -> Fault | None:
    """A bump is no higher than a stated multiple of the smaller radius of its foot."""
    pattern = pattern_of(run.parameters["pattern"])
    if pattern is None or pattern.bump_axes is None:
        return None
    most = MESHED_STEEPNESS * min(pattern.half_width, pattern.half_length)
    if pattern.highest_point <= most * (1.0 + ROUNDING):
        return None
    found = millimetres(pattern.highest_point)
    return "", (
        f"{pattern.noun} too high for a mesh: {found}, allowed is at most {millimetres(most)}, {MESHED_STEEPNESS:g}"
        " times the smaller radius of its foot"
    )


def skirt_can_be_meshed(run: CheckedRun) -> Fault | None:
    """A straight ramp up to the sample is wide enough for triangles."""
    sample, skirt = run.parameters["sample"], run.parameters["derived"]["skirt_width_m"]
    height, needed = sample["height_above_floor_m"], LEAST_SKIRT * sample["element_size_m"]
    if sample["skirt_radius_m"] > 0.0 or reaches(skirt, needed):
        return None
    return "sample.height_above_floor_mm", (
        f"at least {millimetres(height * needed / skirt)}, so that a skirt of this slope is {millimetres(needed)} wide,"
        f" {LEAST_SKIRT:g} of an element (found {millimetres(skirt)})"
    )


def wear_within_reason(run: CheckedRun) -> Fault | None:
    """What wears by sliding is neither worn down to the floor by a fraction of its wear, nor more than updates take."""
    sample, sliding = run.parameters["sample"], run.parameters["sliding"]
    rooms = [(sample["height_above_floor_m"], "the sample's height above the floor")]
    if (cycles := sliding["cycles"]) != ADAPTIVE:  # of those the number is not known
        rooms.append(taken_up(run, cycles, sliding["travel_m"] / sliding["velocity_m_per_s"] / cycles))
    pressure = bulk_density(run.parameters["particle"]) * GRAVITY * run.parameters["bed"]["thickness_m"]
    return worn_within(run, pressure, sliding["travel_m"], *rooms)


RANGE_CHECKS: tuple[Check, ...] = (
    bed_has_particles,
    bed_longer_than_arches,
    window_holds_bed,
    bump_can_be_meshed,
    skirt_can_be_meshed,
    wear_within_reason,
)
