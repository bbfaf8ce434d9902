"""Room in the solver's lists of neighbours, from the sizes of particles and of the triangles that they touch.

The solver keeps one list of particles and one of triangles per particle, on pages of fixed size, and ends a run in
which one does not fit. Pages take memory as far as they are filled; what ample ones cost: docs/decisions.md.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from bulkwear.workflows.engine.grains import smallest_radius

LEAST_LIST, LEAST_PAGE = 20_000, 1_000_000  # entries
PAGE_OVER_LIST = 10  # -, that the solver asks for at least
DENSEST = 0.75  # -, of a volume, that spheres fill; equal ones 0.74
EQUILATERAL = math.sqrt(3.0) / 4.0  # -, area of a triangle over its edge squared
SPARE = 2.0  # -, for folds, finer triangles at bumps and after remeshing


def finest_element(parameters: Mapping[str, Any]) -> float:
    """Return the smallest target edge (m) of the meshes of a run, a bed or a test; infinite where it has none."""
    sections = (parameters.get(name) or {} for name in ("sample", "disc"))
    edges = [section["element_size_m"] for section in sections if "element_size_m" in section]
    return min([*edges, *(part["edge_m"] for part in parameters.get("parts", ()))], default=math.inf)


def list_sizes(parameters: Mapping[str, Any], particle: Mapping[str, Any], skin: float) -> dict[str, int]:
    """Return how many neighbours a deck lets a particle have, and how many a page.

    parameters: of the run, bed or test; skin: m, of the lists. Counted are the smallest spheres that fit round the
    largest, and the triangles of a plane that it touches.
    """
    largest, smallest = 0.5 * max(particle["diameters_m"]), smallest_radius(particle)
    reach = largest + skin
    spheres = DENSEST * ((reach + 2.0 * smallest) ** 3 - largest**3) / smallest**3
    triangles = math.pi * reach**2 / (EQUILATERAL * finest_element(parameters) ** 2)
    most = max(LEAST_LIST, math.ceil(SPARE * max(spheres, triangles)))
    return {"most_neighbours": most, "neighbours_of_page": max(LEAST_PAGE, PAGE_OVER_LIST * most)}
