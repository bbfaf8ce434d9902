"""Checks of the circular wear tester, before any solver starts: of one run, and of the rows of a design."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from bulkwear.postproc.mesh import PLAIN
from bulkwear.workflows.cases.circular_tester.decks import (
    CHANNEL,
    TROUGH_ELEMENT,
    channel_length,
    half_width,
    mean_radius,
)
from bulkwear.workflows.cases.circular_tester.room import (
    LEVEL_DIAMETERS,
    LEVEL_QUARTER_DIAMETERS,
    PUSHED_DIAMETERS,
    SIDE_DIAMETERS,
    ends,
    flatter,
    needed_over,
    needed_under,
    shallower,
    smaller_scale,
)
from bulkwear.workflows.cases.circular_tester.turning_checks import TURNING_CHECKS, rounded_up
from bulkwear.workflows.config.patterns import dimension_columns
from bulkwear.workflows.config.run_checks import (
    CheckedRun,
    Fault,
    deeper_than,
    element_resolves_pattern,
    element_resolves_sample,
    is_stronger,
    millimetres,
    patch_within_sample,
    pattern_fits,
    physical_modulus_known,
    reaches,
    shown_inside,
)

VOLUME, VARIED = "volume", "varied"  # series of the design
ALONE = ("row", "surface")  # columns in which the rows of a pair differ
# -, how far the chords of a ring's walls lie inside their circle, in largest diameters: at 0.1 poured particles, whose
# centres keep 0.6 off, begin to touch them; at 0.36 they were kicked, at 0.46 lost.
CHORD_DIAMETERS = 0.35
MOST_CHANNEL_DEG = 360.0  # of the annulus, all of it


def summed_by_the_solver(run: CheckedRun) -> Fault | None:
    """The ledger is the solver's, which is what the decks are written for."""
    return None if run.settings["ledger"] == "solver" else ("ledger", "solver for a circular wear tester")


def radii_in_order(run: CheckedRun) -> Fault | None:
    """The outer radius of the trough is the larger one."""
    tester = run.parameters["tester"]
    if tester["outer_radius_m"] > tester["inner_radius_m"]:
        return None
    if is_stronger(run, "tester.inner_radius_mm", "tester.outer_radius_mm"):
        return "tester.inner_radius_mm", f"below {millimetres(tester['outer_radius_m'])}, tester.outer_radius_mm"
    return "tester.outer_radius_mm", f"above {millimetres(tester['inner_radius_m'])}, tester.inner_radius_mm"


def sample_between_walls(run: CheckedRun) -> Fault | None:
    """Particles pass between the sample and the side walls of the trough; in a ring the sample's corners count."""
    tester, sample = run.parameters["tester"], run.parameters["sample"]
    room = SIDE_DIAMETERS * max(run.parameters["particle"]["diameters_m"])
    largest = 2.0 * (half_width(tester) - room)
    if tester["shape"] != CHANNEL:
        outer, mean = tester["outer_radius_m"] - room, mean_radius(tester)
        corner = math.sqrt(max(outer**2 - (0.5 * sample["length_m"]) ** 2, 0.0)) - mean
        largest = min(largest, 2.0 * corner)
    if reaches(largest, sample["width_m"]):
        return None
    if largest <= 0.0:
        least = tester["inner_radius_m"] + sample["width_m"] + 2.0 * room
        reason = "so that two of the largest particles pass on either side of the sample"
        return "tester.outer_radius_mm", f"at least {millimetres(least)}, {reason}"
    wider = tester["outer_radius_m"] - sample["width_m"] - 2.0 * room
    given = wider > 0.0 and is_stronger(run, "tester.inner_radius_mm", "sample.width_mm")
    trough = f", or a tester.inner_radius_mm of at most {shown_inside(wider, -1)}" if given else ""
    return (
        "sample.width_mm",
        f"at most {millimetres(largest)}, so that two of the largest particles ({millimetres(0.5 * room)}) pass "
        f"between sample and wall{trough if tester['shape'] == CHANNEL else ''}{smaller_scale(run)}",
    )


def sample_in_channel(run: CheckedRun) -> Fault | None:
    """A channel is longer than the sample and the consolidator, with room for the bed to close again between them."""
    tester, sample = run.parameters["tester"], run.parameters["sample"]
    twice = 2.0 * (sample["length_m"] + tester["consolidator_ramp_m"] + tester["consolidator_flat_m"])
    quarters = 4.0 * LEVEL_QUARTER_DIAMETERS * max(run.parameters["particle"]["diameters_m"])
    if tester["shape"] != CHANNEL or channel_length(tester) >= max(twice, quarters):
        return None
    angle = rounded_up(math.degrees(max(twice, quarters) / mean_radius(tester)))
    longest = math.pi * mean_radius(tester) - sample["length_m"] - tester["consolidator_flat_m"]
    if angle > MOST_CHANNEL_DEG and twice >= quarters and longest > 0.0:
        reason = f"so that a channel of {MOST_CHANNEL_DEG:g} degrees is twice as long as sample and consolidator"
        return "tester.consolidator_ramp_mm", f"at most {shown_inside(longest, -1)}, {reason}"
    reason = "twice the length of sample and consolidator" if twice >= quarters else "eight of the largest particles"
    scale = "" if twice >= quarters else smaller_scale(run)
    return "tester.channel_deg", f"at least {angle:g} degrees, {reason}{scale}"


def ring_is_round(run: CheckedRun) -> Fault | None:
    """A ring, whose walls are chords, is so round that no particle is poured into its walls."""
    tester, largest = run.parameters["tester"], max(run.parameters["particle"]["diameters_m"])
    least = TROUGH_ELEMENT**2 / (8.0 * CHORD_DIAMETERS * largest)
    if tester["shape"] == CHANNEL or reaches(tester["outer_radius_m"], least):
        return None
    return "tester.outer_radius_mm", (
        f"at least {millimetres(least)} with tester.shape: ring, whose walls are chords of"
        f" {millimetres(TROUGH_ELEMENT)}, in which smaller particles would be poured, or tester.shape: channel"
    )


def consolidator_in_ring(run: CheckedRun) -> Fault | None:
    """In a ring sample and consolidator take half of the way round, and the bed that leaves the flat is seen whole."""
    tester, sample = run.parameters["tester"], run.parameters["sample"]
    if tester["shape"] == CHANNEL:
        return None
    flat, most = tester["consolidator_flat_m"], tester["inner_radius_m"]
    if not reaches(most, flat):  # the level is looked at beyond a chord that far from the axis, see past_consolidator
        reason = "so that the bed is there in all its width where its level is looked at behind it"
        return "tester.consolidator_flat_mm", f"at most {millimetres(most)}, tester.inner_radius_mm, {reason}"
    found, most = sample["length_m"] + tester["consolidator_ramp_m"] + flat, math.pi * mean_radius(tester)
    if reaches(most, found):
        return None
    return "tester.consolidator_ramp_mm", (
        f"a length that makes at most {millimetres(most)}, half of the way round at the mean radius, with"
        f" tester.consolidator_flat_mm and sample.length_mm, found {millimetres(found)}"
    )


def enough_layers_over(run: CheckedRun) -> Fault | None:
    """The bed over the sample's higher end has three layers of particles."""
    _, highest = ends(run, 0.0, 0.0)
    least = needed_over(run) + highest
    if reaches(run.parameters["tester"]["depth_m"], least):
        return None
    return "tester.depth_mm", (
        f"at least {millimetres(least)}, three layers of particles over the sample's higher end"
        f"{flatter(run)}{smaller_scale(run)}"
    )


def enough_layers_under(run: CheckedRun) -> Fault | None:
    """The bed under the sample's lower end has room for two of the largest particles, so that it flows there too."""
    tester, sample = run.parameters["tester"], run.parameters["sample"]
    lowest, _ = ends(run, 0.0, sample["thickness_m"])
    least = tester["depth_m"] - lowest + needed_under(run)
    if reaches(tester["bed_height_m"], least):
        return None
    apart = LEVEL_DIAMETERS * run.parameters["particle"]["median_diameter_m"]
    level = (
        "" if reaches(tester["consolidator_level_m"], least - apart) else ", and tester.consolidator_level_mm with it"
    )
    return "tester.bed_height_mm", (
        f"at least {millimetres(least)}{level}, two of the largest particles under the sample's lower end"
        f"{shallower(run)}{flatter(run)}{smaller_scale(run)}"
    )


def consolidator_pushes(run: CheckedRun) -> Fault | None:
    """The consolidator's upper edge is higher than the middle of particles that lie on the levelled bed."""
    least = PUSHED_DIAMETERS * max(run.parameters["particle"]["diameters_m"])
    if reaches(run.parameters["tester"]["consolidator_rise_m"], least):
        return None
    return "tester.consolidator_rise_mm", (
        f"at least {millimetres(least)}, the radius of the largest particle{smaller_scale(run)}"
    )


def consolidator_on_bed(run: CheckedRun) -> Fault | None:
    """The consolidator levels above the highest point of the sample, and of the particles that lie on it."""
    tester = run.parameters["tester"]
    _, highest = ends(run, run.parameters["derived"]["headroom_m"], 0.0)
    least = tester["bed_height_m"] + highest - tester["consolidator_level_m"]
    if tester["depth_m"] > least:
        return None
    return "tester.depth_mm", f"above {millimetres(least)}, so that the sample's top is under the consolidator"


def consolidator_levels_bed(run: CheckedRun) -> Fault | None:
    """The consolidator levels the bed at its height: it comes down on it and does not start inside it."""
    tester = run.parameters["tester"]
    height, apart = tester["bed_height_m"], LEVEL_DIAMETERS * run.parameters["particle"]["median_diameter_m"]
    level = tester["consolidator_level_m"]
    if reaches(level, height - apart) and reaches(height + apart, level):
        return None
    ends = " to ".join(millimetres(height + side * apart) for side in (-1.0, 1.0))
    return "tester.consolidator_level_mm", f"{ends}, the bed's height (tester.bed_height_mm) within half a particle"


def pattern_in_sample(run: CheckedRun) -> Fault | None:
    """The pattern is less deep than the sample is thick."""
    return deeper_than(run, "thickness")


TESTER_CHECKS = (
    summed_by_the_solver,
    radii_in_order,
    sample_between_walls,
    sample_in_channel,
    consolidator_in_ring,
    ring_is_round,
    enough_layers_over,
    enough_layers_under,
    consolidator_levels_bed,
    consolidator_on_bed,
    consolidator_pushes,
    element_resolves_sample,
    pattern_fits,
    element_resolves_pattern,
    patch_within_sample,
    pattern_in_sample,
    *TURNING_CHECKS,
    physical_modulus_known,
)


def design_fault(rows: Sequence[Mapping[str, Any]]) -> str | None:
    """Return a phrase unless one plain and one patterned row, or one row alone, are of series volume, of which most
    figures are made, in equal machines with equal particles, and where seeds differ: a packing is one bed for all rows
    of a machine and particle scale.
    """
    seeds = [str(seed) for seed in dict.fromkeys(row.get("seed", "none") for row in rows)]
    if len(seeds) > 1:
        return f"seed is {', '.join(seeds)}, allowed is one for all rows; further packings are added by packings"
    main = [row for row in rows if row["series"] == VOLUME]
    if len(main) != 1 and not _is_pair(main):
        found = " and ".join(sorted(row["surface"] for row in main)) or "no row"
        return f"series {VOLUME} has {found}, allowed is one patterned and one plain row, or one row"
    if len(main) == 2 and (apart := _apart(main)):
        return f"rows of series {VOLUME} differ in {' and '.join(apart)}, allowed are row, surface and pattern"
    return _varied_fault([row for row in rows if row["series"] == VARIED])


def _varied_fault(rows: Sequence[Mapping[str, Any]]) -> str | None:
    """Return a phrase unless rows of series varied are pairs by name, alike in all but row, surface and pattern."""
    of_pair: dict[str, list[Mapping[str, Any]]] = {}
    for row in rows:
        of_pair.setdefault(row.get("pair") or "", []).append(row)
    for name, pair in of_pair.items():
        if not name or not _is_pair(pair):
            what = f"pair {name}" if name else f"no pair in row {pair[0]['row']}"
            surfaces = " and ".join(sorted(row["surface"] for row in pair))
            return f"series {VARIED} has {what} with {surfaces}, allowed is a patterned and a plain row"
        if apart := _apart(pair):
            return f"rows of pair {name} differ in {' and '.join(apart)}, allowed are row, surface and pattern"
    return None


def _is_pair(rows: Sequence[Mapping[str, Any]]) -> bool:
    return len(rows) == 2 and [row["surface"] for row in rows].count(PLAIN) == 1


def _apart(pair: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the columns in which the rows of a pair differ besides those that they may differ in."""
    own = {column for row in pair for column in dimension_columns(row["surface"])}
    allowed = {*ALONE, *own, *(f"pattern.{column}" for column in own)}
    columns = dict.fromkeys(key for row in pair for key in row)
    return [key for key in columns if key not in allowed and pair[0].get(key) != pair[1].get(key)]
