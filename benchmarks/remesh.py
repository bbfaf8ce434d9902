"""Time of detecting faults and of remeshing a bumpy sheet of 100,000 triangles with distorted faces (one core).

Run in the root of the repository: python -m benchmarks.remesh
"""

from __future__ import annotations

import time

import numpy as np

from postproc.mesh import SurfaceMesh, volume_above_plane
from postproc.wear.mesh_faults import mesh_faults, with_target_edges
from postproc.wear.remesh import remesh

SEED = 20220317
CELLS = 224  # per side; two triangles each: 100,352
SPACING = 1.0e-3  # m
WAVE = 1.5e-3  # m, amplitude of the waves


def distorted_sheet(jitter: float, share: float) -> SurfaceMesh:
    """A wavy square sheet; inner nodes shifted along it by up to `jitter` spacings on that share of its length."""
    i, j = (axis.ravel().astype(float) for axis in np.meshgrid(*[np.arange(CELLS + 1)] * 2, indexing="ij"))
    inner = (i > 0) & (i < CELLS) & (j > 0) & (j < CELLS) & (i <= share * CELLS)
    shift = np.random.default_rng(SEED).uniform(-jitter, jitter, (2, len(i))) * inner
    i, j = i + shift[0], j + shift[1]
    points = np.column_stack([i * SPACING, j * SPACING, WAVE * np.sin(i / 4.0) * np.cos(j / 5.0)])
    corner = (np.arange(CELLS)[:, None] * (CELLS + 1) + np.arange(CELLS)).ravel()
    a, b, c, d = corner, corner + CELLS + 1, corner + CELLS + 2, corner + 1
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return with_target_edges(SurfaceMesh(points, triangles), SPACING)


def main() -> None:
    for label, jitter, share in (("a tenth of it distorted", 0.35, 0.1), ("all of it distorted", 0.35, 1.0)):
        mesh = distorted_sheet(jitter, share)
        start = time.process_time()
        before = mesh_faults(mesh)
        middle = time.process_time()
        result = remesh(mesh)
        seconds = time.process_time() - middle
        volumes = [volume_above_plane(surface.points, surface.triangles, -WAVE) for surface in (result.mesh, mesh)]
        print(
            f"{len(mesh.triangles)} triangles, {label}: faults found in {middle - start:.2f} s, remeshed in "
            f"{seconds:.1f} s; bad faces {before.faces.sum()} -> {result.faults.faces.sum()}, smallest angle "
            f"{before.smallest_angle_deg:.2f} -> {result.faults.smallest_angle_deg:.2f} degrees, volume changed by "
            f"{volumes[0] / volumes[1] - 1:.1e}, "
            f"outside by {result.largest_outward:.4f} edges"
        )


if __name__ == "__main__":
    main()
