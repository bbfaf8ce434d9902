"""Whether the solver takes all parts as one mesh: bodies that touch with common edges or facets it does not."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from bulkwear.meshes.own.repairs import Repairs
from bulkwear.meshes.own.solids import Solids
from bulkwear.meshes.own.weld import groups_of
from bulkwear.postproc.mesh import centroids, directed_edges

MOST_NEIGHBOURS = 5  # at the edges of a face; LIGGGHTS (3.8) stops at more, and at faces with the same three nodes


def one_mesh(solids: Solids, tolerance: float, repairs: Repairs) -> bool:
    """Whether LIGGGHTS takes all parts as one mesh; if not, the faces that it would refuse are a row of warnings.

    tolerance: m, nodes of different parts that are closer lie in one place for the solver
    """
    faces = refused_together(solids, tolerance)
    places = centroids(solids.points, solids.triangles[faces])
    repairs.add("warning: faces at edges of other parts, a mesh per part for the solver", solids.part[faces], places)
    return not len(faces)


def refused_together(solids: Solids, tolerance: float) -> np.ndarray:
    """Faces (k,) with more neighbours at their edges than the solver takes, or with the nodes of another face."""
    none = np.empty(0, dtype=np.int64)
    if len(solids.names) == 1:
        return none
    pairs = cKDTree(solids.points).query_pairs(tolerance, output_type="ndarray")
    shared = np.zeros(len(solids.points), dtype=bool)
    shared[pairs.ravel()] = True
    faces = np.flatnonzero(shared[solids.triangles].any(axis=1))  # and the neighbours of all that matter
    if not len(faces):
        return none
    place = groups_of(pairs, len(solids.points))[solids.triangles[faces]]
    edges = np.sort(directed_edges(place), axis=1)
    _, inverse, counts = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    at_edges = (counts[inverse.reshape(-1)].reshape(-1, 3) - 1).sum(axis=1)
    _, twin, copies = np.unique(np.sort(place, axis=1), axis=0, return_inverse=True, return_counts=True)
    return faces[(at_edges > MOST_NEIGHBOURS) | (copies[twin.reshape(-1)] > 1)]
