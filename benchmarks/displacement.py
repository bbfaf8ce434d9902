"""Processor time of spreading and displacing on a bumpy sheet of 100,000 triangles (one core, best of five).

Run in the root of the repository: python -m benchmarks.displacement
"""

from __future__ import annotations

import time

import numpy as np

from postproc.mesh import SurfaceMesh, edge_lengths_per_triangle
from postproc.wear.caps import step_limit
from postproc.wear.directions import rim_directions
from postproc.wear.displacement import displace
from postproc.wear.patch import ContactPatch, spread
from postproc.wear.update import wear_update, with_depths

SEED = 20220317
CELLS = 224  # per side; two triangles each: 100,352
SPACING = 1.0e-3  # m
LOADED = 20_000  # triangles with contacts
LARGEST_SECONDS = 0.5  # goal for patch and displacement together, patches of one edge


def bumpy_sheet(cells: int, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) m and triangles (m, 3) of a square sheet with smooth waves of height 3 spacings."""
    i, j = np.meshgrid(np.arange(cells + 1), np.arange(cells + 1), indexing="ij")
    height = 1.5 * spacing * np.sin(i / 4.0) * np.cos(j / 5.0)
    points = np.column_stack((i.ravel() * spacing, j.ravel() * spacing, height.ravel()))
    corner = (i[:-1, :-1] * (cells + 1) + j[:-1, :-1]).ravel()
    a, b, c, d = corner, corner + cells + 1, corner + cells + 2, corner + 1
    return points, np.concatenate((np.column_stack((a, b, c)), np.column_stack((a, c, d))))


def best_time(function, repeats: int = 5) -> float:
    """Shortest processor time of several calls, s (other work on the machine does not count)."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return min(times)


def main() -> None:
    points, triangles = bumpy_sheet(CELLS, SPACING)
    random = np.random.default_rng(SEED)
    rim = rim_directions(points, triangles)
    limit = step_limit(points, triangles, 0.1, 0.01, 1.0)
    print(f"{len(triangles)} triangles, {len(points)} nodes")
    for step_over_edge in (1e-6, 1e-3, 1e-2, 1e-1):
        volume = random.random(len(triangles)) * step_over_edge * SPACING**3
        seconds = best_time(lambda volume=volume: displace(points, triangles, volume, None, limit, rim))
        result = displace(points, triangles, volume, None, limit, rim)
        print(
            f"mean step {step_over_edge:g} of the edge: {seconds:.3f} s, "
            f"carried {result.carried_volume.sum() / volume.sum():.2e} of the wear"
        )
    time_patches(points, triangles, rim, limit, random)
    mesh = SurfaceMesh(points, triangles)
    seconds = best_time(lambda: wear_update(mesh, volume, limit), repeats=2)
    worn, _ = wear_update(mesh, volume, limit)
    depths = best_time(lambda: with_depths(worn, mesh), repeats=2)
    print(f"whole update: {seconds:.3f} s; depths of the last surface: {depths:.3f} s")


def time_patches(points, triangles, rim, limit, random) -> None:
    """Spread and displace contacts on a part of the triangles, for several patch radii."""
    loaded = random.random(len(triangles)) < LOADED / len(triangles)
    volume = loaded * random.random(len(triangles)) * 1e-2 * SPACING**3
    position = np.einsum("mc,mcx->mx", random.dirichlet((1.0, 1.0, 1.0), len(triangles)), points[triangles])
    edge = edge_lengths_per_triangle(points, triangles).mean()
    for radius_over_edge in (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0):
        patch = ContactPatch(position, np.full(len(triangles), radius_over_edge * edge))

        def update(patch=patch):
            return displace(
                points,
                triangles,
                spread(points, triangles, volume, patch),
                None,
                limit,
                rim,
                label=np.zeros(len(triangles)),
            )

        update()  # compiles once
        spreading = best_time(lambda patch=patch: spread(points, triangles, volume, patch), repeats=3)
        seconds = best_time(update, repeats=3)
        goal = "" if radius_over_edge > 1.0 else f" (goal {LARGEST_SECONDS} s)"
        print(
            f"{loaded.sum()} patches of {radius_over_edge:g} edges: {spreading:.3f} s, displaced {seconds:.3f} s{goal}"
        )


if __name__ == "__main__":
    main()
