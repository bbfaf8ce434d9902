"""Parameters of the decks of the circular wear tester, and the surfaces beside the sample that they read.

All is seen from the sample: its middle is the origin, the trough's floor lies at `floor`, the bed's surface at
`depth_m`; see deck.py for how decks are rendered.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from bulkwear.meshes.tester import (
    annular_surface,
    annular_wall,
    consolidator,
    placed,
    sample_block,
    straight_consolidator,
    submerged_pose,
    turn_angles,
)
from bulkwear.postproc.mesh import SurfaceMesh, enclosed_volume, write_stl
from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.engine.decks import (
    DOMAIN_MARGIN_DIAMETERS,
    exact_ledger,
    integration,
    material_tables,
    steps,
)
from bulkwear.workflows.engine.pouring import bulk_density, fill_gap, fill_height, poured_particles
from bulkwear.workflows.engine.schedule import Span

CHANNEL, RING = "channel", "ring"  # values of tester.shape
BLOCK, CONSOLIDATOR, TROUGH = "block.stl", "consolidator.stl", "trough.stl"
FALLS = 2.5  # -, times sqrt(2 h/g): settling of poured particles, as for beds that are lowered
HOLDER_SIZE = 0.01  # m, elements of sides and bottom of the sample, which do not wear
WALL_GAP = 2e-3  # m, between the consolidator and the side walls, where all particles are larger
WALL_GAP_DIAMETERS = 0.5  # -, the same in smallest diameters where some are not: they would pass beside the plate
BLOCK_ELEMENTS = 4.0  # -, of the block's longer side
# -, elements of the block over its shorter side, at most: corners of 11 degrees; triangles below 10 are not meshed.
BLOCK_ASPECT = 5.0
TROUGH_ELEMENT = 0.05  # m, chords of the trough; at the outer wall they lie 0.6 mm inside the circle
FREEBOARD = 1.0  # -, height of the trough's walls over the bed, in bed heights
LOWERING_TIME = 0.5  # s, in which the consolidator comes down on the turning bed, with about 0.1 m/s
FILL_EXCESS = 1.02  # -, poured mass over that of a level bed: the consolidator pushes a little

Parameters = Mapping[str, Any]


# ---------------------------------------------------------------- decks


def tester_bed(bed: Parameters) -> dict[str, Any]:
    """Return the parameters of the deck that fills the trough and turns it until the flow is steady."""
    particle, step = bed["particle"], bed["time_step_s"]
    gap = fill_gap(particle)
    settling = steps(FALLS * math.sqrt(2.0 * _fill_height(bed) / GRAVITY), step)
    ring = {
        "outer_fill_radius_m": bed["outer_radius_m"] - gap,
        "inner_fill_radius_m": bed["inner_radius_m"] + gap,
    }
    return {
        **integration(bed, step, particle, settling),
        **material_tables(particle, bed["sample_material"], bed["floor_material"], bed),
        **_walls(bed, "bed", bed["coefficient_per_pa"], "", BLOCK),  # no mesh of a run may have these fix ids
        "report_steps": bed["report_steps"],
        **poured_particles(particle, bed["seed"], poured_mass(bed)),
        "settling_steps": settling,
        "lowering_steps": steps(LOWERING_TIME, step),
        "largest_radius_m": 0.5 * max(particle["diameters_m"]),
        "steady_steps": bed["steady_steps"],
        "domain_m": domain(bed),
        "fill_m": _fill_box(bed),
        "block_m": _block_box(bed),
        **(ring if bed["shape"] == RING else {}),
    }


def tester_run_in(run: Parameters, bed: Parameters, restart: str) -> dict[str, Any]:
    """Return the parameters of the deck that puts the sample into the moving bed and runs it in."""
    return {**_cycle(run, bed, 0, run["derived"]["run_in_steps"]), "begin": restart}


def circular_tester(run: Parameters, bed: Parameters, span: Span, restart: str) -> dict[str, Any]:
    """Return the parameters of the deck of one wear cycle."""
    return {
        **_cycle(run, bed, span.cycle, span.steps),
        "begin": restart,
        "picture_steps": min(run["derived"]["picture_interval_steps"], span.steps),
        **exact_ledger(run, look_steps(run, span)),
    }


def look_steps(run: Parameters, span: Span) -> int:
    """Return the steps between two looks at the wear inside a cycle: equal parts of it, see solver.looks."""
    looks = max(round(run["solver"]["looks_per_revolution"] * span.steps / run["derived"]["revolution_steps"]), 1)
    return math.ceil(span.steps / looks)


def _cycle(run: Parameters, bed: Parameters, cycle: int, last: int) -> dict[str, Any]:
    """Return what the decks of all cycles need; last: their last step."""
    derived = run["derived"]
    return {
        **integration(run, derived["time_step_s"], run["particle"], last),
        **material_tables(run["particle"], run["sample_material"], run["floor_material"], derived),
        **_walls(bed, cycle, run["wear"]["accelerated_wear_coefficient_per_pa"], "../", "surface.stl"),
        "report_steps": derived["report_steps"],
        "end_step": last,
    }


def _walls(bed: Parameters, cycle: int | str, coefficient: float, folder: str, sample: str) -> dict[str, Any]:
    """Return what all decks need of the machine."""
    found = {
        "shape": bed["shape"],
        "cycle": cycle,
        "velocity_m_per_s": bed["velocity_m_per_s"],
        "half_sample_width_m": 0.5 * bed["sample_width_m"],
        "half_sample_length_m": 0.5 * bed["sample_length_m"],
        "depth_m": bed["depth_m"],
        "floor_m": floor(bed),
        "past_consolidator_m": past_consolidator(bed),
        "finnie_coefficient_per_pa": [[coefficient] * 3] * 3,
        "sample_file": sample,
        "consolidator_file": folder + CONSOLIDATOR,
    }
    if bed["shape"] == RING:
        mean = mean_radius(bed)
        speed = bed["velocity_m_per_s"] / mean
        return {
            **found,
            "trough_file": folder + TROUGH,
            "radius_m": mean,
            "angular_speed_rad_per_s": speed,
        }
    return {**found, "half_width_m": half_width(bed)}


# ---------------------------------------------------------------- geometry, seen from the sample


def mean_radius(tester: Parameters) -> float:
    """Return the radius (m) at which the middle of the sample lies."""
    return 0.5 * (tester["inner_radius_m"] + tester["outer_radius_m"])


def half_width(tester: Parameters) -> float:
    return 0.5 * (tester["outer_radius_m"] - tester["inner_radius_m"])


def floor(tester: Parameters) -> float:
    """Return the height (m) of the trough's floor."""
    return tester["depth_m"] - tester["bed_height_m"]


def channel_length(tester: Parameters) -> float:
    """Return the length (m) of the straight channel: that of the sector at the mean radius."""
    return tester["channel_rad"] * mean_radius(tester)


def bed_length(tester: Parameters) -> float:
    """Return the length (m) of the bed at the mean radius: of the channel, or right round."""
    return channel_length(tester) if tester["shape"] == CHANNEL else 2.0 * math.pi * mean_radius(tester)


def domain(bed: Parameters) -> list[float]:
    """Return the ends (m) of the domain along x, y and z; the channel's are its own along the travel."""
    margin = DOMAIN_MARGIN_DIAMETERS * max(bed["particle"]["diameters_m"])
    lowest = floor(bed) - margin
    top = max(floor(bed) + _fill_height(bed), bed["depth_m"] + FREEBOARD * bed["bed_height_m"]) + margin
    if bed["shape"] == CHANNEL:
        width, length = half_width(bed) + margin, channel_length(bed)
        return [-width, width, -0.5 * length, 0.5 * length, lowest, top]
    mean, reach = mean_radius(bed), bed["outer_radius_m"] + margin
    return [-mean - reach, -mean + reach, -reach, reach, lowest, top]


def level_mass(bed: Parameters) -> float:
    """Return the mass (kg) of a level bed round the block, at the bulk density of its material."""
    block = block_mesh(bed)
    volume = bed_area(bed) * bed["bed_height_m"] - enclosed_volume(block.points, block.triangles)
    return bulk_density(bed["particle"]) * volume


def poured_mass(bed: Parameters) -> float:
    """Return the mass (kg) that is poured: a little more than the level bed's, which the consolidator pushes."""
    return FILL_EXCESS * level_mass(bed)


def bed_area(bed: Parameters, gap: float = 0.0) -> float:
    """Return the area (m2) of the bed seen from above, of places that keep a gap (m) off walls and ends."""
    if bed["shape"] == RING:
        return math.pi * ((bed["outer_radius_m"] - gap) ** 2 - (bed["inner_radius_m"] + gap) ** 2)
    return 4.0 * (half_width(bed) - gap) * (0.5 * channel_length(bed) - gap)


def past_consolidator(bed: Parameters) -> list[float | str]:
    """Return the ends (m) along x and y of the quarter of the bed that has just left the consolidator."""
    if bed["shape"] == RING:
        return ["INF", -mean_radius(bed), "INF", -bed["consolidator_flat_m"]]
    return ["INF", "INF", -0.5 * channel_length(bed), -0.25 * channel_length(bed)]


def _fill_height(bed: Parameters) -> float:
    """Return how far (m) over the floor centres are poured, off walls and block."""
    low, high = np.array(_block_box(bed)).reshape(3, 2).T
    area = bed_area(bed, fill_gap(bed["particle"]))
    return fill_height(bed["particle"], poured_mass(bed), area, float(np.prod(high - low)))


def _fill_box(bed: Parameters) -> list[float]:
    """Return the ends (m) of the box of poured centres along x, y and z; of a ring those of z count."""
    gap = fill_gap(bed["particle"])
    width, length = half_width(bed) - gap, 0.5 * bed_length(bed) - gap
    return [-width, width, -length, length, floor(bed) + gap, floor(bed) + _fill_height(bed)]


def _block_box(bed: Parameters) -> list[float]:
    """Return the ends (m) of a box round the block in the sample's place, inclined as it is, and the gap round it."""
    points, gap = block_mesh(bed).points, fill_gap(bed["particle"])
    low, high = points.min(axis=0) - gap, points.max(axis=0) + gap
    return [float(value) for pair in zip(low, high, strict=True) for value in pair]


def pose(tester: Parameters) -> np.ndarray:
    """Return the rotation (3, 3) that inclines a sample; its middle stays at the origin."""
    return submerged_pose(0.0, tester["bed_height_m"], tester["depth_m"], tester["incline_rad"])[0]


def block_mesh(bed: Parameters) -> SurfaceMesh:
    """Return the block in the sample's place, as high as the highest sample of the study and a little more."""
    above = bed["headroom_m"]
    mesh = _level_block(bed["sample_width_m"], bed["sample_length_m"], bed["thickness_m"] + above)
    raised = placed(mesh, np.eye(3), np.array([0.0, 0.0, above]))
    return placed(raised, pose(bed), np.zeros(3))


@cache  # a deck asks for it many times, and a forecast for the decks of all beds
def _level_block(width: float, length: float, thickness: float) -> SurfaceMesh:
    element = min(max(width, length) / BLOCK_ELEMENTS, BLOCK_ASPECT * min(width, length))
    return sample_block(width, length, thickness, element, None)


def wall_gap(bed: Parameters) -> float:
    """Return the gap (m) between consolidator and side walls: no particle passes there."""
    smallest = min(bed["particle"]["diameters_m"])
    return WALL_GAP if smallest > WALL_GAP else WALL_GAP_DIAMETERS * smallest


def consolidator_mesh(bed: Parameters) -> SurfaceMesh:
    """Return the plate that levels the bed once per round, half a round away from the sample."""
    level, rise = bed["consolidator_level_m"] + floor(bed), bed["consolidator_rise_m"]
    ramp, flat, gap = bed["consolidator_ramp_m"], bed["consolidator_flat_m"], wall_gap(bed)
    if bed["shape"] == CHANNEL:
        end = 0.5 * channel_length(bed) - WALL_GAP
        return straight_consolidator(half_width(bed) - gap, level, rise, end - flat - ramp, end - flat, end)
    mean = mean_radius(bed)
    angles = (math.pi - ramp / mean, math.pi, math.pi + flat / mean)
    radii = bed["inner_radius_m"] + gap, bed["outer_radius_m"] - gap
    plate = consolidator(*radii, bed["consolidator_level_m"], rise, *angles, TROUGH_ELEMENT)
    return placed(plate, np.eye(3), np.array([-mean, 0.0, floor(bed)]))


def trough_mesh(bed: Parameters) -> SurfaceMesh:
    """Return floor and walls of the ring as one surface."""
    radii, height = (bed["inner_radius_m"], bed["outer_radius_m"]), (1.0 + FREEBOARD) * bed["bed_height_m"]
    angles = turn_angles(radii[1], TROUGH_ELEMENT)
    parts = [
        annular_surface(*radii, angles, np.zeros(len(angles)), TROUGH_ELEMENT),
        annular_wall(radii[0], height, angles, TROUGH_ELEMENT, inwards=False),
        annular_wall(radii[1], height, angles, TROUGH_ELEMENT, inwards=True),
    ]
    first = np.cumsum([0, *(len(part.points) for part in parts)])
    mesh = SurfaceMesh(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.triangles + start for part, start in zip(parts, first, strict=False)]),
    )
    return placed(mesh, np.eye(3), np.array([-mean_radius(bed), 0.0, floor(bed)]))


def write_machine(bed: Parameters, folder: Path) -> None:
    """Write the surfaces beside the sample that the decks read."""
    meshes = {CONSOLIDATOR: consolidator_mesh(bed)}
    if bed["shape"] == RING:
        meshes[TROUGH] = trough_mesh(bed)
    for name, mesh in meshes.items():
        write_stl(folder / name, mesh.points, mesh.triangles)


def write_block(bed: Parameters, folder: Path) -> None:
    """Write the block in the sample's place."""
    mesh = block_mesh(bed)
    write_stl(folder / BLOCK, mesh.points, mesh.triangles)
