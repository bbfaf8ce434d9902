"""What was asked of a bed of particles and what it has: mass, level, depth. One that misses any of them is refused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from bulkwear.workflows.engine.job import write_table

MEASURES = "measures.csv"  # in a bed's folder


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


def write_measures(measures: Sequence[BedMeasure], folder: Path) -> None:
    """Write the measures of a bed into its folder, if there are any."""
    if measures:
        write_table(folder / MEASURES, [asdict(each) | {"missed": each.missed} for each in measures])


def bed_fault(measures: Sequence[BedMeasure]) -> str | None:
    """Return a phrase with all measures where one is missed, else None."""
    if not any(each.missed for each in measures):
        return None
    return f"the bed is not as asked: {', '.join(each.said() for each in measures)}"
