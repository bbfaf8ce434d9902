"""Processor time of spreading and displacing on a bumpy sheet of 100,000 triangles, by one core."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.measure import Measure, measured, processor_times
from bulkwear.postproc.mesh import SurfaceMesh, edge_lengths_per_triangle
from bulkwear.postproc.wear.caps import step_limit
from bulkwear.postproc.wear.directions import rim_directions
from bulkwear.postproc.wear.displacement import displace
from bulkwear.postproc.wear.patch import ContactPatch, spread
from bulkwear.postproc.wear.update import wear_update, with_depths

SEED = 20220317
CELLS, QUICK_CELLS = 224, 40  # per side; two triangles each: 100,352
REPEATS, QUICK_REPEATS = 5, 2
DOWN = (0.0, 0.0, -1.0)  # where the rim slides
SPACING = 1.0e-3  # m
LOADED = 0.2  # -, share of the triangles with contacts
STEP = 1e-2  # -, mean step of the nodes over the edge
RADII = (0.5, 1.0, 2.0, 5.0)  # -, of contact patches over the edge


def bumpy_sheet(cells: int, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) m and triangles (m, 3) of a square sheet with smooth waves of height 3 spacings."""
    i, j = np.meshgrid(np.arange(cells + 1), np.arange(cells + 1), indexing="ij")
    height = 1.5 * spacing * np.sin(i / 4.0) * np.cos(j / 5.0)
    points = np.column_stack((i.ravel() * spacing, j.ravel() * spacing, height.ravel()))
    corner = (i[:-1, :-1] * (cells + 1) + j[:-1, :-1]).ravel()
    a, b, c, d = corner, corner + cells + 1, corner + cells + 2, corner + 1
    return points, np.concatenate((np.column_stack((a, b, c)), np.column_stack((a, c, d))))


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the triangles per second of displacing, of patches with it, of a whole wear update and of depths."""
    points, triangles = bumpy_sheet(QUICK_CELLS if quick else CELLS, SPACING)
    random, count = np.random.default_rng(SEED), len(triangles)
    rim, limit = rim_directions(points, triangles), step_limit(points, triangles, 0.1, 0.01, 1.0)
    volume = random.random(count) * STEP * SPACING**3
    mesh = SurfaceMesh(points, triangles)
    worn, _ = wear_update(mesh, volume, limit, DOWN)
    tasks: dict[str, Callable[[], object]] = {
        "displace": lambda: displace(points, triangles, volume, None, limit, rim),
        **patch_tasks(points, triangles, rim, limit, random),
        "wear update": lambda: wear_update(mesh, volume, limit, DOWN),
        "depths": lambda: with_depths(worn, mesh),
    }
    told = []
    for name, task in tasks.items():
        task()  # compiles once
        times = processor_times(task, QUICK_REPEATS if quick else REPEATS)
        told.append(measured(f"{name}, {count} triangles", "triangles/s", [count / spent for spent in times]))
    return told


def patch_tasks(points, triangles, rim, limit, random) -> dict[str, Callable[[], object]]:
    """Return what spreads the wear of loaded triangles over patches and displaces them, by size of the patches."""
    loaded = random.random(len(triangles)) < LOADED
    volume = loaded * random.random(len(triangles)) * STEP * SPACING**3
    position = np.einsum("mc,mcx->mx", random.dirichlet((1.0, 1.0, 1.0), len(triangles)), points[triangles])
    edge = edge_lengths_per_triangle(points, triangles).mean()

    def task(radius_over_edge: float) -> Callable[[], object]:
        patch = ContactPatch(position, np.full(len(triangles), radius_over_edge * edge))
        label = np.zeros(len(triangles))

        def spread_and_displace() -> object:
            share = spread(points, triangles, volume, patch)
            return displace(points, triangles, share, None, limit, rim, label=label)

        return spread_and_displace

    return {f"patches of {radius:g} edges, displaced": task(radius) for radius in RADII}
