"""What is asked of the bed of a sliding sample, and what the log of its deck says that it has."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bulkwear.workflows.cases.sliding_sample.decks import bed_mass, settled_bed
from bulkwear.workflows.engine.beds import BedMeasure, level_measure, mass_measure
from bulkwear.workflows.engine.derived import WINDOW

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any


def bed_measures(bed: Mapping[str, Any], thermo: Mapping[str, np.ndarray]) -> list[BedMeasure]:
    """Return mass (kg) and level (m) of a bed that has settled, which is how deep any sample will lie under it.

    A window's bed is measured once more, in use: after its second fall, on to the true floor.
    thermo: columns of the log of the bed's deck
    """
    settled = int(np.flatnonzero(thermo["Step"] <= 1 + settled_bed(bed)["settling_steps"])[-1])
    measures = _measures_at(bed, thermo, settled)
    if bed["ends"] == WINDOW:
        measures += _measures_at(bed, thermo, -1, 2.0 * bed["temporary_floor_m"], " in use")
    return measures


def _measures_at(
    bed: Mapping[str, Any], thermo: Mapping[str, np.ndarray], line: int, fallen: float = 0.0, when: str = ""
) -> list[BedMeasure]:
    """Return the measures of a line of the log, whose level counts from the temporary floor.

    fallen: m, twice as far as the bed lies below that floor, since a level is twice the height of a centre
    """
    mass, level = float(thermo["bed_mass"][line]), float(thermo["level_h"][line]) + fallen
    particle = bed["particle"]
    return [
        mass_measure(particle, bed_mass(bed), mass, f"mass{when}"),
        level_measure(particle, bed["thickness_m"], level, f"level{when}"),
    ]
