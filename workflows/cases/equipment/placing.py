"""Where the solver places particles, at an inlet and in a filling, and how many it can place there. SI throughout.

It tries places at random and keeps those where nothing overlaps, 50 tries for each particle, and never makes up for
what it could not place. Measured with LIGGGHTS 3.8.0 (`insert/stream`, `insert/pack`), particles of one size and of
three: a stream through a square of 3, 4, 10 and 20 diameters gets 98.4, 99.6, 100 and 100 % of what is asked for at
`PLACED_FRACTION` of the rectangle less half a diameter along each side; at 0.36 it gets 91 % with one size and 99.7 %
with three. A cylinder gets all up to 0.32, and 90 % at 0.36.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bulkwear.workflows.cases.equipment.surfaces import rectangle

PLACED_FRACTION = 0.30  # -, solid volume over that of the room which particles are placed in
RIM_DIAMETERS = 0.5  # of each side of a rectangle, in largest diameters: at its rim lie fewer particles than within
LEAST_SIDE_DIAMETERS = 3.0  # of an inlet; through narrower ones 8 % less may be placed
DEPTH_DIAMETERS = 3.0  # of the room behind an inlet which particles reach into: extruded length and a diameter

Section = Mapping[str, Any]


def largest_diameter(run: Section) -> float:
    """Return the diameter (m) of a run's largest particles."""
    return max(run["particle"]["diameters_m"])


def unit_normal(inlet: Section) -> np.ndarray:
    """Return the unit vector (3,) whither the material goes through an inlet."""
    normal = np.asarray(inlet["normal"], dtype=float)
    return normal / np.linalg.norm(normal)


def normal_velocity(inlet: Section) -> float:
    """Return the velocity (m/s) of the material through an inlet, below 0 where it would go back."""
    return float(unit_normal(inlet) @ np.asarray(inlet["velocity_m_per_s"]))


def largest_rate(run: Section) -> float:
    """Return the feed (kg/s) that the solver can place before an inlet."""
    inlet, rim = run["inlet"], RIM_DIAMETERS * largest_diameter(run)
    area = math.prod(side - rim for side in inlet["size_m"])
    return PLACED_FRACTION * area * normal_velocity(inlet) * run["particle"]["density_kg_per_m3"]


def largest_filling(run: Section) -> float:
    """Return the bulk volume over that of a filling's cylinder (-) that the solver can place at once."""
    length = run["filling"]["length_m"]
    ends = max(1.0 - largest_diameter(run) / length, 0.0)  # particles keep off both ends
    return PLACED_FRACTION * ends / run["particle"]["bulk_solid_fraction"]


def placing_room(run: Section) -> np.ndarray:
    """Return the corners (8, 3) m of the room behind an inlet which particles reach into when they are placed."""
    corners = rectangle(run["inlet"]).points
    return np.concatenate([corners, corners - DEPTH_DIAMETERS * largest_diameter(run) * unit_normal(run["inlet"])])


def filling_box(run: Section) -> np.ndarray:
    """Return the lowest and the highest corner (2, 3) m of a filling's cylinder."""
    filling = run["filling"]
    half = np.full(3, filling["radius_m"])
    half["xyz".index(filling["axis"])] = 0.5 * filling["length_m"]
    return np.asarray(filling["centre_m"]) + np.array([-half, half])
