"""Time of making a surface for the solver of a binary STL of 100,000 facets (read, weld, check, refine), by one core.

Facets come in random order and winding. The sheet is wavy and its triangles are good; the drum is one of long slivers,
1,000 round its circumference, whose flat ends are slivers as well.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.measure import Measure, measured, processor_times
from bulkwear.meshes.own.mesh import own_mesh
from bulkwear.meshes.own.stl import FACET_TYPE
from bulkwear.meshes.plate import flat_plate

SEED = 20220317
SPACING = 1.0e-3  # m, of the sheet's nodes
SIDE, QUICK_SIDE = 0.224, 0.03  # m, of the sheet: 100,352 triangles
WAVE, WAVE_LENGTH = 1.5e-3, 0.03  # m
SIDES, RINGS, QUICK_SIDES = 1_000, 50, 40  # of the drum, round and along: 101,996 triangles
RADIUS, LENGTH = 0.3, 2.0  # m
DRUM_EDGE = 0.02  # m
REPEATS = 2


def wavy_sheet(side: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) m and triangles of a square sheet with waves along and across it."""
    sheet = flat_plate(side, side, SPACING)
    points, angle = sheet.points.copy(), 2.0 * np.pi / WAVE_LENGTH * sheet.points[:, :2]
    points[:, 2] = WAVE * np.sin(angle[:, 0]) * np.cos(angle[:, 1])
    return points, sheet.triangles


def drum(sides: int, rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) m and triangles of a closed drum about x; its ends are fans from one node of the rim."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    along = np.repeat(LENGTH * np.arange(rings + 1) / rings, sides)
    circle = np.tile(RADIUS * np.column_stack([np.cos(angle), np.sin(angle)]), (rings + 1, 1))
    here = np.arange(rings * sides).reshape(rings, sides)
    ahead, above, both = np.roll(here, -1, axis=1), here + sides, np.roll(here, -1, axis=1) + sides
    k = np.arange(1, sides - 1)
    fan = np.column_stack([np.zeros_like(k), k + 1, k])
    wall = [np.stack(each, axis=-1).reshape(-1, 3) for each in ((here, ahead, both), (here, both, above))]
    return np.column_stack([along, circle]), np.concatenate([*wall, fan, rings * sides + fan[:, ::-1]])


def write_binary_stl(path: Path, points: np.ndarray, triangles: np.ndarray) -> None:
    """Write facets as binary STL, in random order, each wound as chance has it."""
    generator = np.random.default_rng(SEED)
    triangles = triangles[generator.permutation(len(triangles))]
    flipped = generator.random(len(triangles)) < 0.5
    facets = np.zeros(len(triangles), dtype=FACET_TYPE)
    facets["corners"] = points[np.where(flipped[:, None], triangles[:, ::-1], triangles)]
    path.write_bytes(bytes(80) + len(facets).to_bytes(4, "little") + facets.tobytes())


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the seconds of the sheet, checked only and refined too, and of the drum, refined."""
    meshes = {
        "wavy sheet": (*wavy_sheet(QUICK_SIDE if quick else SIDE), (None, 0.5 * SPACING)),
        "drum of slivers": (*drum(QUICK_SIDES if quick else SIDES, RINGS), (DRUM_EDGE,)),
    }
    folder.mkdir(parents=True, exist_ok=True)
    told = []
    for name, (points, triangles, wanted) in meshes.items():
        path = folder / f"{name.replace(' ', '_')}.stl"
        write_binary_stl(path, points, triangles)
        for edge in wanted:
            count = len(own_mesh(path, "m", edge).surface.triangles)  # compiles the loops, too
            times = processor_times(lambda path=path, edge=edge: own_mesh(path, "m", edge), REPEATS)
            label = "as it is" if edge is None else f"refined to {count}"
            told.append(measured(f"{name}, {len(triangles)} facets, {label}", "s", times))
    return told
