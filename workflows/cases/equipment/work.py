"""What runs of equipment will cost the solver, see `workflows.engine.work`."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.meshes.own.solids import MOST_TRIANGLES
from bulkwear.workflows.cases.equipment.decks import fall_speed, moving_mesh, skin
from bulkwear.workflows.cases.equipment.drawings import check_solid, drawing, drawing_digest
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.engine.work import Stage, bytes_of_run

if TYPE_CHECKING:
    from bulkwear.meshes.own.read import PartSize

SPEED = 3.0  # m/s, of the fastest particles where no feed falls faster; they say how often lists are made
EQUILATERAL = math.sqrt(3.0) / 4.0  # -, area of an equilateral triangle over its edge squared
OVER_EQUILATERAL = (
    1.1  # -, triangles of a mesh over area / equilateral ones: 1.04 to 1.19 of the chute, mill and screw;
)
# where curvature asks for smaller edges there are more, four times as many on a liner with bumps as high as an edge
# triangles whose time a particle takes in a machine with parts that move, where its walls are looked for at more steps:
# mill at quick 20, at standard 12, screw 0 to 5
MOVING_PER_PARTICLE = 14.0
Parameters = Mapping[str, Any]


def run_stages(run: Parameters) -> tuple[Stage, ...]:
    """Return the first block, and all others that there may be.

    Raises ConfigError for a drawing that cannot be read, or in a wrong unit.
    """
    derived = run["derived"]
    particles, parts = derived["held_particles"], run["parts"]
    counts = [triangles_of(part) for part in parts]
    if max(counts) > MOST_TRIANGLES:
        from bulkwear.workflows.cases.equipment.machine_checks import check_units  # slow to import

        check_units(run)  # a wrong unit may be why; what is not is told when it is meshed
    triangles = sum(counts)
    moving = MOVING_PER_PARTICLE if any(map(moving_mesh, parts)) else 0.0
    worn = sum(count for part, count in zip(parts, counts, strict=True) if part["wears"])
    often = 2.0 * max(SPEED, fall_speed(run)) * derived["time_step_s"] / skin(run)
    first, others = derived["first_cycle_steps"], derived["travel_steps"]
    blocks = others // first
    return (
        Stage(1, first, 0.5 * particles, triangles, often * first, True, wall_triangles=0.5 * moving * particles),
        Stage(blocks, others, particles, triangles, often * others, True, worn, moving * particles),
    )


def run_bytes(run: Parameters) -> float:
    """Return what a run leaves on disk."""
    blocks = run["derived"]["travel_steps"] // run["derived"]["first_cycle_steps"]
    triangles = sum(map(triangles_of, run["parts"]))
    pictures = run["sampling"]["pictures_per_block"]
    return bytes_of_run(run, run["derived"]["held_particles"] * pictures, triangles, triangles, blocks)


def triangles_of(part: Parameters) -> float:
    """Return about how many triangles a part gets, by the area of its drawing, which is meshed later.

    No fewer than a mesh file has: nothing is made coarser. Raises ConfigError for a drawing that cannot be read, and
    for a solid that is not in it.
    """
    try:
        sizes = _sizes(part["file"], part["unit"], drawing_digest(part["file"]))
    except (ValueError, OSError) as fault:
        raise ConfigError(f"parts.{part['name']}: {fault}") from None
    check_solid(part, sizes)
    per_area = OVER_EQUILATERAL / (EQUILATERAL * part["edge_m"] ** 2)
    wanted = [sizes[part["solid"]]] if "solid" in part else sizes.values()
    return sum(max(per_area * size.area_m2, size.triangles) for size in wanted)


@cache
def _sizes(name: str, unit: str, content: str) -> Mapping[str, PartSize]:
    """Return the size of each solid of a drawing; content: its digest, by which it is remembered."""
    from bulkwear.meshes.own.read import check_file, part_sizes

    path = drawing(name, Path(_drawn().name))
    check_file(path)
    return part_sizes(path, unit)


@cache
def _drawn() -> tempfile.TemporaryDirectory[str]:
    """Return the folder for drawings that a script makes, until the program ends: a script draws all of its folder."""
    return tempfile.TemporaryDirectory()
