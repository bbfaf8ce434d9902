"""Facets of an STL that the project wrote."""

from pathlib import Path

import numpy as np

from bulkwear.meshes.own.stl import read_stl_solids


def stl_facets(path: Path) -> np.ndarray:
    """Corners of the facets in their order, (m, 3, 3) m."""
    solids = read_stl_solids(path)
    return solids.points[solids.triangles]
