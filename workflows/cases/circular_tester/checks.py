"""Checks of the circular wear tester, before any solver starts: of one run, and of the rows of a design."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from bulkwear.postproc.mesh import PLAIN
from bulkwear.workflows.cases.circular_tester.decks import CHANNEL, channel_length, half_width, mean_radius
from bulkwear.workflows.config.patterns import dimension_columns
from bulkwear.workflows.config.run_checks import (
    CheckedRun,
    Fault,
    deeper_than,
    element_resolves_pattern,
    element_resolves_sample,
    millimetres,
    pattern_fits,
    physical_modulus_known,
)
from bulkwear.workflows.engine.schedule import LEAST_CYCLE_STEPS

VOLUME, VARIED = "volume", "varied"  # series of the design
ALONE = ("row", "surface")  # columns in which the rows of a pair differ
LEAST_LAYERS = 3.0  # of particles over the sample and under it: fewer are no bed
LEVEL_DIAMETERS = 0.5  # -, of bed and consolidator apart, in median diameters: the plate cuts no layer off, misses none
SIDE_DIAMETERS = 2.0  # -, room between sample and side walls, in largest diameters: particles pass there without a jam
ROUNDING = 1e-9  # relative; of revolutions times cycles


def summed_by_the_solver(run: CheckedRun) -> Fault | None:
    """The ledger is the solver's, which is what the decks are written for."""
    return None if run.settings["ledger"] == "solver" else ("ledger", "solver for a circular wear tester")


def radii_in_order(run: CheckedRun) -> Fault | None:
    """The outer radius of the trough is the larger one."""
    tester = run.parameters["tester"]
    if tester["outer_radius_m"] > tester["inner_radius_m"]:
        return None
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
    if sample["width_m"] <= largest:
        return None
    return (
        "sample.width_mm",
        f"at most {millimetres(largest)}, so that two of the largest particles ({millimetres(0.5 * room)}) pass "
        "between sample and wall",
    )


def sample_in_channel(run: CheckedRun) -> Fault | None:
    """A channel is longer than the sample and the consolidator, with room for the bed to close again between them."""
    tester, sample = run.parameters["tester"], run.parameters["sample"]
    least = 2.0 * (sample["length_m"] + tester["consolidator_ramp_m"] + tester["consolidator_flat_m"])
    if tester["shape"] != CHANNEL or channel_length(tester) >= least:
        return None
    angle = math.degrees(least / mean_radius(tester))
    return "tester.channel_deg", f"at least {angle:.4g} degrees, twice the length of sample and consolidator"


def consolidator_in_ring(run: CheckedRun) -> Fault | None:
    """In a ring sample and consolidator take half of the way round, and the bed that leaves the flat is seen whole."""
    tester, sample = run.parameters["tester"], run.parameters["sample"]
    if tester["shape"] == CHANNEL:
        return None
    flat, most = tester["consolidator_flat_m"], tester["inner_radius_m"]
    if flat > most:  # the level is looked at beyond a chord that far from the axis, see past_consolidator
        reason = "so that the bed is there in all its width where its level is looked at behind it"
        return "tester.consolidator_flat_mm", f"at most {millimetres(most)}, tester.inner_radius_mm, {reason}"
    found, most = sample["length_m"] + tester["consolidator_ramp_m"] + flat, math.pi * mean_radius(tester)
    if found <= most:
        return None
    return "tester.consolidator_ramp_mm", (
        f"a length that makes at most {millimetres(most)}, half of the way round at the mean radius, with"
        f" tester.consolidator_flat_mm and sample.length_mm, found {millimetres(found)}"
    )


def _ends(run: CheckedRun, above: float, below: float) -> tuple[float, float]:
    """Return the lowest and the highest point (m over its middle) of the inclined sample between two of its planes.

    above, below: m, of the planes over and under the middle of its top
    """
    incline = run.parameters["tester"]["incline_rad"]
    rise = 0.5 * run.parameters["sample"]["length_m"] * abs(math.sin(incline))
    return -rise - below * math.cos(incline), rise + above * math.cos(incline)


def enough_layers_over(run: CheckedRun) -> Fault | None:
    """The bed over the sample's higher end has three layers of particles."""
    _, highest = _ends(run, 0.0, 0.0)
    least = LEAST_LAYERS * run.parameters["particle"]["median_diameter_m"] + highest
    if run.parameters["tester"]["depth_m"] >= least:
        return None
    return "tester.depth_mm", f"at least {millimetres(least)}, three layers of particles over the sample's higher end"


def enough_layers_under(run: CheckedRun) -> Fault | None:
    """The bed under the sample's lower end has three layers of particles, so that it flows there too."""
    tester, sample = run.parameters["tester"], run.parameters["sample"]
    lowest, _ = _ends(run, 0.0, sample["thickness_m"])
    least = tester["depth_m"] - lowest + LEAST_LAYERS * run.parameters["particle"]["median_diameter_m"]
    if tester["bed_height_m"] >= least:
        return None
    return (
        "tester.bed_height_mm",
        f"at least {millimetres(least)}, three layers of particles under the sample's lower end",
    )


def consolidator_on_bed(run: CheckedRun) -> Fault | None:
    """The consolidator levels above the highest point of the sample, and of the particles that lie on it."""
    tester = run.parameters["tester"]
    _, highest = _ends(run, run.parameters["derived"]["headroom_m"], 0.0)
    least = tester["bed_height_m"] - tester["depth_m"] + highest
    if tester["consolidator_level_m"] > least:
        return None
    return "tester.consolidator_level_mm", f"above {millimetres(least)}, the sample's highest point"


def consolidator_levels_bed(run: CheckedRun) -> Fault | None:
    """The consolidator levels the bed at its height: it comes down on it and does not start inside it."""
    tester = run.parameters["tester"]
    height, apart = tester["bed_height_m"], LEVEL_DIAMETERS * run.parameters["particle"]["median_diameter_m"]
    if abs(tester["consolidator_level_m"] - height) <= apart:
        return None
    ends = " to ".join(millimetres(height + side * apart) for side in (-1.0, 1.0))
    return "tester.consolidator_level_mm", f"{ends}, the bed's height (tester.bed_height_mm) within half a particle"


def whole_cycles(run: CheckedRun) -> Fault | None:
    """The revolutions are a whole number of wear cycles."""
    sliding = run.settings["sliding"]
    cycles = sliding["revolutions"] * sliding["cycles_per_revolution"]
    if cycles >= 1.0 - ROUNDING and abs(cycles - round(cycles)) <= ROUNDING * cycles:
        return None
    return "sliding.revolutions", f"a multiple of 1/{sliding['cycles_per_revolution']}, so that wear cycles are whole"


def cycle_long_enough(run: CheckedRun) -> Fault | None:
    """A wear cycle has at least a hundred time steps."""
    derived = run.parameters["derived"]
    steps = derived["revolution_s"] / derived["largest_time_step_s"]
    most = int(steps / LEAST_CYCLE_STEPS)
    if run.settings["sliding"]["cycles_per_revolution"] <= most:
        return None
    return "sliding.cycles_per_revolution", f"at most {most}, so that a cycle has {LEAST_CYCLE_STEPS} time steps"


def pattern_in_sample(run: CheckedRun) -> Fault | None:
    """The pattern is less deep than the sample is thick."""
    return deeper_than(run, "thickness")


TESTER_CHECKS = (
    summed_by_the_solver,
    radii_in_order,
    sample_between_walls,
    sample_in_channel,
    consolidator_in_ring,
    enough_layers_over,
    enough_layers_under,
    consolidator_on_bed,
    consolidator_levels_bed,
    element_resolves_sample,
    pattern_fits,
    element_resolves_pattern,
    pattern_in_sample,
    whole_cycles,
    cycle_long_enough,
    physical_modulus_known,
)


def design_fault(rows: Sequence[Mapping[str, Any]]) -> str | None:
    """Return a phrase unless one plain and one patterned row are of series volume, of which most figures are made, in
    equal machines with equal particles, and where seeds differ: a packing is one bed for all rows of a machine and
    particle scale.
    """
    seeds = [str(seed) for seed in dict.fromkeys(row.get("seed", "none") for row in rows)]
    if len(seeds) > 1:
        return f"seed is {', '.join(seeds)}, allowed is one for all rows; further packings are added by packings"
    main = [row for row in rows if row["series"] == VOLUME]
    if not _is_pair(main):
        found = " and ".join(sorted(row["surface"] for row in main)) or "no row"
        return f"series {VOLUME} has {found}, allowed is one patterned and one plain row"
    if apart := _apart(main):
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
