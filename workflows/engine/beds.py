"""What was asked of a bed of particles and what it has: mass, level, depth. One that misses any of them is refused."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from bulkwear.workflows.engine.job import write_table

MEASURES = "measures.csv"  # in a bed's folder
MASS_TOLERANCE = 0.01  # -, of what is asked
ROUNDED_PARTICLES = 2.0  # -, largest particles: the number of each size is rounded, which shows in small beds
LEVEL_TOLERANCE = 0.5  # -, in median diameters: the layer on a floor is looser by as much; seen -0.12 to 0.37
DENSITY_TOLERANCE = 0.05  # -, of the height: by so much a bed may settle or flow looser or denser than its bulk density


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


def mass_measure(particle: Mapping[str, Any], asked: float, found: float) -> BedMeasure:
    """Return the measure of a bed's mass (kg)."""
    largest = particle["density_kg_per_m3"] * math.pi / 6.0 * max(particle["diameters_m"]) ** 3
    return BedMeasure("mass", "kg", asked, found, max(MASS_TOLERANCE * asked, ROUNDED_PARTICLES * largest))


def level_measure(
    particle: Mapping[str, Any], height: float, found: float, name: str = "level", covering: float = 0.0
) -> BedMeasure:
    """Return the measure of a bed's level (m), or of what of it lies over something.

    height: asked of the whole bed; found: twice the height of its centre of mass; covering: m, of what it lies over.
    Two things add up that no pouring decides: the looser layer on the floor, and the density to which a bed settles.
    """
    tolerance = LEVEL_TOLERANCE * particle["median_diameter_m"] + DENSITY_TOLERANCE * height
    return BedMeasure(name, "m", height - covering, found - covering, tolerance)


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
    density = missed["level"].asked / missed["level"].found
    return f"{said}; it settles to {density:.2g} times the bulk density of its material (bulk_solid_fraction)"
