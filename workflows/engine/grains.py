"""What the shape of a bulk material's particles decides: spheres, or clumps of spheres of the same volume.

A material has a key `clump` where its particles are clumps; its diameters are those of spheres of the same volume.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bulkwear.postproc.clump import Clump

SPHERE, CLUMP = "sphere", "clump"  # kinds of grains that decks know
DIGITS = 6  # significant ones, of lengths and inertia of clumps in decks
SYMMETRIC = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))  # of an inertia tensor, in the solver's order


def with_clump(particle: Mapping[str, Any], name: str, clump: Clump) -> dict[str, Any]:
    """Return a material whose particles are clumps; `particle` as from derived.particle_section."""
    spheres = np.column_stack([clump.centres, clump.radii]).round(DIGITS)
    found = {"name": name, "spheres": spheres.tolist(), "inertia": clump.inertia.round(DIGITS).tolist()}
    return {**particle, CLUMP: {**found, "reach": round(clump.reach, DIGITS)}}


def grain_kind(particle: Mapping[str, Any]) -> str:
    """Return whether a material's particles are spheres or clumps."""
    return CLUMP if CLUMP in particle else SPHERE


def shape_of(particle: Mapping[str, Any]) -> str:
    """Return the shape of a material's particles: sphere, or the name of the clump."""
    return particle[CLUMP]["name"] if CLUMP in particle else SPHERE


def spheres_per_grain(particle: Mapping[str, Any]) -> int:
    """Return of how many spheres a particle consists."""
    return len(particle[CLUMP]["spheres"]) if CLUMP in particle else 1


def smallest_radius(particle: Mapping[str, Any]) -> float:
    """Return the radius (m) of the smallest sphere that the solver has."""
    share = min(sphere[-1] for sphere in particle[CLUMP]["spheres"]) if CLUMP in particle else 0.5
    return share * min(particle["diameters_m"])


def solid_share(particle: Mapping[str, Any]) -> float:
    """Return the volume of a particle over the sum of those of its spheres (-), which overlap in clumps."""
    if CLUMP not in particle:
        return 1.0
    return 1.0 / math.fsum((2.0 * sphere[-1]) ** 3 for sphere in particle[CLUMP]["spheres"])


def largest_extent(particle: Mapping[str, Any]) -> float:
    """Return the diameter (m) of the sphere round the centre of mass that the largest particle turns in."""
    largest = max(particle["diameters_m"])
    return 2.0 * particle[CLUMP]["reach"] * largest if CLUMP in particle else largest


def equal_spheres(particle: Mapping[str, Any], count: float) -> float:
    """Return how many spheres cost the solver as much as so many particles: the body of a clump costs one more.

    So 1.5 times as much per sphere in pairs and 1.25 times in fours; measured were 1.65 and 1.2 (filling of beds).
    """
    of_grain = spheres_per_grain(particle)
    return count * (of_grain + 1.0) if of_grain > 1 else count


def grain_words(particle: Mapping[str, Any]) -> dict[str, Any]:
    """Return what decks that pour particles say of their sizes, and of the clumps that they are."""
    if CLUMP not in particle:
        return {"particle_diameter_m": particle["diameters_m"]}
    clump = particle[CLUMP]
    return {
        "clump_name": clump["name"],
        "clump_sphere_count": len(clump["spheres"]),
        "clump_sizes": [
            _clump_size(clump, diameter, particle["density_kg_per_m3"]) for diameter in particle["diameters_m"]
        ],
    }


def _clump_size(clump: Mapping[str, Any], diameter: float, density: float) -> dict[str, Any]:
    """Return a clump of an equivalent diameter (m) as decks have it: texts of its spheres (m), mass (kg) and inertia
    (kg m2).
    """
    mass = density * math.pi / 6.0 * diameter**3
    return {
        "diameter": diameter,
        "spheres": [" ".join(_number(length * diameter) for length in sphere) for sphere in clump["spheres"]],
        "mass": f"{mass:.9g}",
        "inertia": " ".join(_number(clump["inertia"][i][j] * mass * diameter**2) for i, j in SYMMETRIC),
    }


def _number(value: float) -> str:
    return f"{value + 0.0:.{DIGITS}g}"
