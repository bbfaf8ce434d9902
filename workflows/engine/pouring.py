"""Beds and boxes are poured by mass: what a level bed of their size weighs at the bulk density of its material.

Nothing is taken off afterwards. Particles are placed at random with room between them and fall, which says how high the
room has to be that they are placed in.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from bulkwear.workflows.engine.decks import primes, size_distribution
from bulkwear.workflows.engine.grains import grain_words, largest_extent

FILL_FRACTION = 0.34  # -, solid fraction at insertion; random placement becomes slow above 0.38
FALL_SPEED = 0.3  # m/s, of poured particles at insertion; shortens the fall without bouncing them
FILL_GAP_DIAMETERS = 0.6  # -, between centres of poured particles and walls, in largest diameters
PERIODIC_GAP_DIAMETERS = 0.5  # -, the same at periodic faces: LIGGGHTS places no particle across one


def bulk_density(particle: Mapping[str, Any]) -> float:
    """Return the bulk density (kg/m3) of a material: its solid's times the solid fraction of its bulk."""
    return particle["density_kg_per_m3"] * particle["bulk_solid_fraction"]


def particles_of_mass(particle: Mapping[str, Any], mass: float) -> float:
    """Return how many particles weigh so much (kg), by the mass fractions of their sizes."""
    pairs = zip(particle["mass_fractions"], particle["diameters_m"], strict=True)
    return mass / particle["density_kg_per_m3"] * math.fsum(part / (math.pi / 6.0 * size**3) for part, size in pairs)


def fill_gap(particle: Mapping[str, Any]) -> float:
    """Return how far (m) the centres of poured particles keep off walls."""
    return FILL_GAP_DIAMETERS * largest_extent(particle)


def periodic_gap(particle: Mapping[str, Any]) -> float:
    """Return how far (m) the centres of poured particles are kept off periodic faces by the solver."""
    return PERIODIC_GAP_DIAMETERS * largest_extent(particle)


def fill_height(particle: Mapping[str, Any], mass: float, area: float, blocked: float = 0.0) -> float:
    """Return how far (m) over the floor centres are poured, so that this mass (kg) finds room.

    area: seen from above, in which centres are poured, m2; blocked: room in it that something takes, m3
    """
    return fill_gap(particle) + (mass / (particle["density_kg_per_m3"] * FILL_FRACTION) + blocked) / area


def poured_particles(particle: Mapping[str, Any], seed: int, mass: float) -> dict[str, Any]:
    """Return what decks that pour a mass (kg) say of it."""
    return {
        "poured_mass_kg": mass,
        "fall_speed_m_per_s": FALL_SPEED,
        "density_kg_per_m3": particle["density_kg_per_m3"],
        **grain_words(particle),
        "size_distribution": size_distribution(particle["mass_fractions"]),
        "size_count": len(particle["mass_fractions"]),
        "seeds": primes(seed, len(particle["diameters_m"]) + 2),
    }
