"""What beds and runs of the circular wear tester will cost the solver, see `workflows.engine.work`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from bulkwear.meshes.estimate import sample_triangles
from bulkwear.workflows.cases.circular_tester import decks as tester_deck
from bulkwear.workflows.cases.circular_tester.decks import HOLDER_SIZE
from bulkwear.workflows.config.patterns import pattern_of
from bulkwear.workflows.engine.work import Stage, builds_per_step, bytes_of_bed, bytes_of_run

Parameters = Mapping[str, Any]


def settled_particles(run: Parameters) -> float:
    """Return about how many particles are poured, all of which stay."""
    return run["derived"]["bed_particles"] * tester_deck.FILL_EXCESS


def surface_triangles(run: Parameters) -> float:
    """Return about how many triangles a run's sample has: its top, and the coarse holder."""
    sample = run["sample"]
    lengths = (sample["width_m"], sample["length_m"], sample["element_size_m"])
    top = sample_triangles(*lengths, pattern_of(run["pattern"]), 0.0, math.pi / 4.0)
    bottom = sample_triangles(*lengths[:2], HOLDER_SIZE, None, 0.0, math.pi / 4.0)
    rim = 2.0 * (sample["width_m"] + sample["length_m"])
    sides = rim / sample["element_size_m"] + 2.0 * rim / HOLDER_SIZE * (sample["thickness_m"] / HOLDER_SIZE)
    return top + bottom + sides


def trough_triangles(run: Parameters) -> float:
    """Return about how many triangles the trough of a ring has; a channel has none."""
    tester = run["tester"]
    if tester["shape"] == tester_deck.CHANNEL:
        return 0.0
    edge = tester_deck.TROUGH_ELEMENT
    height = (1.0 + tester_deck.FREEBOARD) * tester["bed_height_m"]
    around = 2.0 * math.pi * tester["outer_radius_m"] / edge
    return 2.0 * around * (2.0 * tester_deck.half_width(tester) + 2.0 * height) / edge


def triangles(run: Parameters) -> float:
    """Return about how many triangles the solver has."""
    return surface_triangles(run) + trough_triangles(run)


def bed_stages(run: Parameters, bed: Parameters) -> tuple[Stage, ...]:
    """Return the stages of filling the trough and of turning it until the flow is steady."""
    parameters = tester_deck.tester_bed(bed)
    particles, steady = settled_particles(run), bed["steady_steps"]
    meshes = trough_triangles(run)
    return (
        Stage(1, parameters["settling_steps"], particles, meshes),
        Stage(0, parameters["lowering_steps"], particles, meshes),
        Stage(0, steady, particles, meshes, builds_per_step(run) * steady, True),
    )


def run_stages(run: Parameters) -> tuple[Stage, ...]:
    """Return the stages of a run: run-in and wear cycles."""
    derived, particles, number = run["derived"], settled_particles(run), triangles(run)
    travel, run_in, often = derived["travel_steps"], derived["run_in_steps"], builds_per_step(run)
    return (
        Stage(1, run_in, particles, number, often * run_in, True),
        Stage(run["sliding"]["cycles"], travel, particles, number, often * travel, True, surface_triangles(run)),
    )


def bed_bytes(run: Parameters) -> float:
    """Return what a bed leaves on disk."""
    return bytes_of_bed(settled_particles(run))


def run_bytes(run: Parameters) -> float:
    """Return what a run leaves on disk."""
    return bytes_of_run(run, settled_particles(run), triangles(run), surface_triangles(run), run["sliding"]["cycles"])
