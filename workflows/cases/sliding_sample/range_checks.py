"""Checks of a sliding sample whose settings lie in their ranges and make no bed, no mesh or no wear together."""

from __future__ import annotations

from bulkwear.workflows.config.run_checks import Check, CheckedRun, Fault, millimetres, reaches
from bulkwear.workflows.engine.grains import largest_extent

LEAST_EXTENTS = 2.0  # -, of a bed's length and, where it is periodic, its width, in largest extents of a particle
LEAST_LAYERS = 0.5  # -, of a bed: most of the floor is bare below it, and studies have 1.4 and more


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


RANGE_CHECKS: tuple[Check, ...] = (
    bed_has_particles,
    bed_longer_than_arches,
)
