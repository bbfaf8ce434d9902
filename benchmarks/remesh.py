"""Time of finding faults and of remeshing a bumpy sheet of 100,000 triangles with distorted faces, by one core."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.measure import Measure, measured, processor_times
from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.postproc.wear.mesh_faults import mesh_faults, with_target_edges
from bulkwear.postproc.wear.remesh import remesh

SEED = 20220317
CELLS, QUICK_CELLS = 224, 30  # per side; two triangles each: 100,352
REPEATS = 2
JITTER = 0.35  # -, of the spacing
SPACING = 1.0e-3  # m
WAVE = 1.5e-3  # m, amplitude of the waves


def distorted_sheet(cells: int, jitter: float, share: float) -> SurfaceMesh:
    """A wavy square sheet; inner nodes shifted along it by up to `jitter` spacings on that share of its length."""
    i, j = (axis.ravel().astype(float) for axis in np.meshgrid(*[np.arange(cells + 1)] * 2, indexing="ij"))
    inner = (i > 0) & (i < cells) & (j > 0) & (j < cells) & (i <= share * cells)
    shift = np.random.default_rng(SEED).uniform(-jitter, jitter, (2, len(i))) * inner
    i, j = i + shift[0], j + shift[1]
    points = np.column_stack([i * SPACING, j * SPACING, WAVE * np.sin(i / 4.0) * np.cos(j / 5.0)])
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    a, b, c, d = corner, corner + cells + 1, corner + cells + 2, corner + 1
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return with_target_edges(SurfaceMesh(points, triangles), SPACING)


def measures(folder: Path, quick: bool) -> list[Measure]:
    """Return the triangles per second of finding faults and of remeshing, of the whole sheet, parts of it distorted."""
    told = []
    for label, share in (("a tenth", 0.1), ("all", 1.0)):
        mesh = distorted_sheet(QUICK_CELLS if quick else CELLS, JITTER, share)
        count = len(mesh.triangles)
        for name, task in (("find faults", mesh_faults), ("find and remesh", remesh)):
            times = processor_times(lambda task=task, mesh=mesh: task(mesh), REPEATS)
            rates = [count / spent for spent in times]
            told.append(measured(f"{name}, {count} triangles, {label} distorted", "triangles/s", rates))
    return told
