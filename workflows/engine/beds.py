"""What was asked of a bed of particles and what it has: mass, level, depth. One that misses any of them is refused."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from bulkwear.workflows.engine.job import write_table

MEASURES = "measures.csv"  # in a bed's folder
MASS_TOLERANCE = 0.01  # -, of what is asked
ROUNDED_PARTICLES = 2.0  # -, largest particles: the number of each size is rounded, which shows in small beds
# No centre lies lower than half a grain over a floor, or higher than half a grain under the surface. Packed like the
# bulk between, a bed would be a grain too high; its first and last layers are denser, which takes half of that or more.
LEVEL_TOLERANCE = 0.5  # -, in median diameters; seen 0.12 to 0.39 in beds of one to five layers of spheres
# Spheres poured at random fill 0.56 (loose) to 0.64 (close) of their room: from 5 % under the 0.59 of gravel's bulk.
DENSITY_TOLERANCE = 0.05  # -, of the level or depth asked for; seen 1.4 % looser than with half a grain, 2.3 % denser


@dataclass(frozen=True)
class BedMeasure:
    """A measure of a bed; asked, found and tolerance in its unit."""

    measure: str
    unit: str
    asked: float
    found: float
    tolerance: float

    @property
    def missed(self) -> bool:
        """Return whether it is not as asked; a measure that is not a number is missed."""
        return not abs(self.found - self.asked) <= self.tolerance

    def said(self) -> str:
        """Return what was found and asked in words."""
        return f"{self.measure} {self.found:.4g} {self.unit} (asked {self.asked:.4g} within {self.tolerance:.2g})"


def mass_measure(particle: Mapping[str, Any], asked: float, found: float, name: str = "mass") -> BedMeasure:
    """Return the measure of a bed's mass (kg)."""
    largest = particle["density_kg_per_m3"] * math.pi / 6.0 * max(particle["diameters_m"]) ** 3
    return BedMeasure(name, "kg", asked, found, max(MASS_TOLERANCE * asked, ROUNDED_PARTICLES * largest))


def level_measure(
    particle: Mapping[str, Any], height: float, found: float, name: str = "level", covering: float = 0.0
) -> BedMeasure:
    """Return the measure of a bed's level (m), or of what of it lies over something.

    height: asked of the whole bed; found: twice the height of its centre of mass; covering: m, of what it lies over.
    Two things add up that no pouring decides: the looser layers at floor and surface, and the density to which what is
    asked settles.
    """
    asked = height - covering
    tolerance = LEVEL_TOLERANCE * particle["median_diameter_m"] + DENSITY_TOLERANCE * asked
    return BedMeasure(name, "m", asked, found - covering, tolerance)


def over_asked_density(mass: BedMeasure, level: BedMeasure) -> float:
    """Return the bulk density (-) of a level bed over the one that its mass and level were asked with."""
    return (mass.found / mass.asked) * (level.asked / level.found)


def read_measures(folder: Path) -> list[BedMeasure]:
    """Return the measures that were written into the folder of a bed."""
    import pandas as pd  # slow to import, and every job reads this module

    table = pd.read_csv(folder / MEASURES)
    return [BedMeasure(*row) for row in table[[each.name for each in fields(BedMeasure)]].itertuples(index=False)]


def write_measures(measures: Sequence[BedMeasure], folder: Path) -> None:
    """Write the measures of a bed into its folder, if there are any."""
    if measures:
        write_table(folder / MEASURES, [asdict(each) | {"missed": each.missed} for each in measures])


def bed_fault(measures: Sequence[BedMeasure]) -> str | None:
    """Return a phrase with all measures where one is missed, else None; with the cause where the mass is as asked."""
    missed = {each.measure: each for each in measures if each.missed}
    if not missed:
        return None
    said = f"the bed is not as asked: {', '.join(each.said() for each in measures)}"
    if "mass" in missed or "level" not in missed:
        return said
    mass = next(each for each in measures if each.measure == "mass")
    density = over_asked_density(mass, missed["level"])
    return f"{said}; it settles to {density:.2g} times the bulk density of its material (bulk_solid_fraction)"
