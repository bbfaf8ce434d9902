"""The room that particles have in the circular wear tester, and what else than a refused length makes enough of it."""

from __future__ import annotations

import math

from bulkwear.workflows.cases.circular_tester.decks import CHANNEL, channel_length, half_width, mean_radius
from bulkwear.workflows.config.run_checks import CheckedRun, reaches, shown_inside

LEAST_LAYERS = 3.0  # of particles over the sample: fewer are no bed
# -, largest diameters in the quarter of a channel whose level is looked at: shorter ones often hold no particle.
LEVEL_QUARTER_DIAMETERS = 2.0
# -, room beside the sample and under it, in largest diameters: particles pass there without a jam.
SIDE_DIAMETERS = 2.0
# -, rise of the consolidator, in largest diameters: it pushes particles that lie on the bed by their middle.
PUSHED_DIAMETERS = 0.5
LEVEL_DIAMETERS = 0.5  # -, of bed and consolidator apart, in median diameters: the plate cuts no layer off, misses none
HUNDREDTHS = 100.0  # of a scale or a degree, to which a bound in a sentence is rounded


def ends(run: CheckedRun, above: float, below: float) -> tuple[float, float]:
    """Return the lowest and the highest point (m over its middle) of the inclined sample between two of its planes.

    above, below: m, of the planes over and under the middle of its top
    """
    incline = run.parameters["tester"]["incline_rad"]
    rise = 0.5 * run.parameters["sample"]["length_m"] * abs(math.sin(incline))
    return -rise - below * math.cos(incline), rise + above * math.cos(incline)


def needed_over(run: CheckedRun) -> float:
    """Return the least bed (m) over the sample's higher end."""
    return LEAST_LAYERS * run.parameters["particle"]["median_diameter_m"]


def needed_under(run: CheckedRun) -> float:
    """Return the least bed (m) under the sample's lower end: room for two of the largest."""
    return SIDE_DIAMETERS * max(run.parameters["particle"]["diameters_m"])


def _rooms(run: CheckedRun) -> list[tuple[float, float]]:
    """Return each (room, least room) in m that has to do with the size of the particles, and grows with it."""
    tester, sample = run.parameters["tester"], run.parameters["sample"]
    largest = max(run.parameters["particle"]["diameters_m"])
    lowest, highest = ends(run, 0.0, sample["thickness_m"])[0], ends(run, 0.0, 0.0)[1]
    beside = half_width(tester) - 0.5 * sample["width_m"]
    if tester["shape"] != CHANNEL:
        corner = math.hypot(mean_radius(tester) + 0.5 * sample["width_m"], 0.5 * sample["length_m"])
        beside = min(beside, tester["outer_radius_m"] - corner)
    rooms = [
        (tester["depth_m"] - highest, needed_over(run)),
        (tester["bed_height_m"] - tester["depth_m"] + lowest, needed_under(run)),
        (beside, SIDE_DIAMETERS * largest),
        (tester["consolidator_rise_m"], PUSHED_DIAMETERS * largest),
    ]
    if tester["shape"] == CHANNEL:
        rooms.append((channel_length(tester), 4.0 * LEVEL_QUARTER_DIAMETERS * largest))
    return rooms


def smaller_scale(run: CheckedRun) -> str:
    """Return the particle scale with which all particles have room, in words after the least length that a run has;
    nothing where there is none.
    """
    particle, tester = run.parameters["particle"], run.parameters["tester"]
    scale = particle["scale"]
    most = _rounded_down(scale * min(room / least for room, least in _rooms(run)))
    apart = LEVEL_DIAMETERS * particle["median_diameter_m"] * most / scale
    levelled = reaches(apart, abs(tester["consolidator_level_m"] - tester["bed_height_m"]))
    return f", or a particle_scale of at most {most:g}" if 1.0 <= most < scale and levelled else ""


def flatter(run: CheckedRun) -> str:
    """Return likewise the tilts with which there is room over and under the sample."""
    tester, sample = run.parameters["tester"], run.parameters["sample"]
    half, thickness = 0.5 * sample["length_m"], sample["thickness_m"]
    over = (tester["depth_m"] - needed_over(run)) / half
    under = (tester["bed_height_m"] - tester["depth_m"] - needed_under(run)) / math.hypot(half, thickness)
    if over <= 0.0 or under <= 0.0:
        return ""
    most = min(math.asin(min(over, 1.0)), math.asin(min(under, 1.0)) - math.atan2(thickness, half))
    shown = _rounded_down(math.degrees(most))
    tilted = 0.0 < shown < abs(math.degrees(tester["incline_rad"]))
    return f", or a tester.incline_deg of {-shown:g} to {shown:g}" if tilted else ""


def shallower(run: CheckedRun) -> str:
    """Return likewise the depth of the sample with which there is room under it, if there is then room over it."""
    tester, sample = run.parameters["tester"], run.parameters["sample"]
    lowest, _ = ends(run, 0.0, sample["thickness_m"])
    most = tester["bed_height_m"] + lowest - needed_under(run)
    _, top = ends(run, run.parameters["derived"]["headroom_m"], 0.0)
    levelled = most > tester["bed_height_m"] + top - tester["consolidator_level_m"]
    enough = levelled and reaches(most, needed_over(run) + ends(run, 0.0, 0.0)[1])
    return f", or a tester.depth_mm of at most {shown_inside(most, -1)}" if enough else ""


def _rounded_down(value: float) -> float:
    return math.floor(HUNDREDTHS * value) / HUNDREDTHS
