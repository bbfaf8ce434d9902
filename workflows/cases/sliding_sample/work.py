"""What beds and runs of sliding samples will cost the solver, see `workflows.engine.work`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from bulkwear.meshes.estimate import sample_triangles
from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.sliding_sample.decks import lowered_bed, settled_bed
from bulkwear.workflows.cases.sliding_sample.parameters import RAMP
from bulkwear.workflows.config.patterns import pattern_of
from bulkwear.workflows.engine import decks as deck
from bulkwear.workflows.engine.derived import ADAPTIVE, WINDOW
from bulkwear.workflows.engine.grains import equal_spheres, spheres_per_grain
from bulkwear.workflows.engine.pouring import bulk_density
from bulkwear.workflows.engine.work import Stage, builds_per_step, bytes_of_bed, bytes_of_run

# Recession of the fastest node over the mean that Archard's law gives for the bed's weight on a plain floor. From the
# 191 adaptive cycles of worn_bump at quick fidelity; the only number here that hangs on one run.
FASTEST_OVER_MEAN = 199.0

Parameters = Mapping[str, Any]


def surface_triangles(run: Parameters) -> float:
    """Return about how many triangles a run's sample has."""
    sample = run["sample"]
    lengths = (sample["width_m"], sample["length_m"], sample["element_size_m"])
    return sample_triangles(*lengths, pattern_of(run["pattern"]), *(sample[key] for key in RAMP))


def bed_stages(run: Parameters, bed: Parameters) -> tuple[Stage, ...]:
    """Return the stages of filling a bed, of which `run` is one that starts from it: settling.

    In a window that travels it falls to the true floor once more.
    """
    parameters, particles = settled_bed(bed), single_spheres(run)
    return (
        Stage(1, parameters["settling_steps"], particles),
        Stage(0, parameters.get("packing_steps", 0), particles),
    )


def run_stages(run: Parameters, bed: Parameters) -> tuple[Stage, ...]:
    """Return the stages of a run: lowering, run-in, wear cycles."""
    derived, triangles = run["derived"], surface_triangles(run)
    particles = single_spheres(run)
    lowering = lowered_bed(run, bed, "")["lowering_steps"]
    travel, run_in = derived["travel_steps"], derived["run_in_steps"]
    often = builds_per_step(run) + exchanges_per_step(run)
    return (
        Stage(1, lowering, particles, triangles),
        Stage(0, run_in, particles, triangles, often * run_in, True),
        Stage(cycles(run), travel, particles, triangles, often * travel, True, triangles),
    )


def single_spheres(run: Parameters) -> float:
    """Return how many spheres cost the solver as much as a bed's particles."""
    return equal_spheres(run["particle"], run["derived"]["bed_particles"] / spheres_per_grain(run["particle"]))


def exchanges_per_step(run: Parameters) -> float:
    """Return the exchanges of bed per time step (-) in a window that travels; each makes the neighbour list anew."""
    if run["bed"]["ends"] != WINDOW:
        return 0.0
    return deck.travelled(run, 1) / run["bed"]["exchange_m"]


def cycles(run: Parameters) -> int:
    """Return the wear cycles of a run; adaptive ones as many as the fastest node needs updates of the largest step."""
    sliding, particle, wear = run["sliding"], run["particle"], run["wear"]
    if sliding["cycles"] != ADAPTIVE:
        return sliding["cycles"]
    weight = bulk_density(particle) * GRAVITY * run["bed"]["thickness_m"]
    recession = FASTEST_OVER_MEAN * wear["accelerated_wear_coefficient_per_pa"] * weight * sliding["travel_m"]
    return max(math.ceil(recession / (wear["largest_step_edge_fraction"] * run["sample"]["element_size_m"])), 1)


def bed_bytes(run: Parameters) -> float:
    """Return what a bed leaves on disk."""
    return bytes_of_bed(run["derived"]["bed_particles"])


def run_bytes(run: Parameters) -> float:
    """Return what a run leaves on disk."""
    triangles = surface_triangles(run)
    return bytes_of_run(run, run["derived"]["bed_particles"], triangles, triangles, cycles(run))
