"""What runs of equipment will cost the solver, see `workflows.engine.work`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bulkwear.workflows.cases.equipment.decks import moving_mesh, skin
from bulkwear.workflows.engine.work import Stage, bytes_of_run

SPEED = 3.0  # m/s, of the fastest particles, which say how often lists of neighbours are made; a fall of half a metre
TRIANGLES_PER_PART = 5000.0  # assumption: drawings are meshed in a job of their own, later
MOVING_OVER_RESTING = 8.0  # -, cost of a triangle that moves: 0.93 over 0.11 ms a step for 13,248 of them, measured
Parameters = Mapping[str, Any]


def run_stages(run: Parameters) -> tuple[Stage, ...]:
    """Return the first block, and all others that there may be."""
    derived = run["derived"]
    particles, parts = derived["held_particles"], run["parts"]
    triangles = TRIANGLES_PER_PART * sum(MOVING_OVER_RESTING if moving_mesh(part) else 1.0 for part in parts)
    worn = TRIANGLES_PER_PART * sum(part["wears"] for part in parts)
    often = 2.0 * SPEED * derived["time_step_s"] / skin(run)
    first, others = derived["first_cycle_steps"], derived["travel_steps"]
    blocks = others // first
    return (
        Stage(1, first, 0.5 * particles, triangles, often * first, True),
        Stage(blocks, others, particles, triangles, often * others, True, worn),
    )


def run_bytes(run: Parameters) -> float:
    """Return what a run leaves on disk."""
    blocks = run["derived"]["travel_steps"] // run["derived"]["first_cycle_steps"]
    triangles = TRIANGLES_PER_PART * len(run["parts"])
    pictures = run["sampling"]["pictures_per_block"]
    return bytes_of_run(run["derived"]["held_particles"] * pictures, triangles, triangles, blocks)
