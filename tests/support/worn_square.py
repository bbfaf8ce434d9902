"""A worn square of two triangles, as a page compares it."""

import numpy as np

from bulkwear.postproc.mesh import HOLDER_PART, SurfaceMesh
from bulkwear.postproc.tables.compared_surfaces import Shown
from bulkwear.postproc.tables.film import without_skirt

SIDE, TIME, DEPTH, THICKNESS = 0.01, 0.5, 3e-6, 2e-3  # m, s, m, m
IMPULSE = 4e-3  # N s, of each of the two triangles


def square(depth=DEPTH, **data):
    """A square of two triangles and one of the holder beside it, worn to a depth."""
    points = SIDE * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.5], [2, 0, 0]], dtype=float)
    triangles = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 2]])
    loads = {"normal_impulse_N_s": IMPULSE, "sliding_work_J": 0.0, "impact_energy_J": 0.0, "worn_volume_m3": 1e-12}
    cells = {"part": np.array([0, 1, HOLDER_PART])} | {name: np.full(3, value) for name, value in loads.items()}
    nodes = {"removed_thickness_m": np.full(5, depth), "carried_volume_m3": np.zeros(5)} | data
    return SurfaceMesh(points, triangles, cells, nodes)


def as_shown(mesh, run="R9", cycle=1):
    return Shown(run, cycle, TIME * cycle, f"cycle {cycle}", without_skirt(mesh))
