"""What is asked of a bed of the circular wear tester, and what the log of its deck says that it has."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bulkwear.workflows.cases.circular_tester import decks as tester_deck
from bulkwear.workflows.engine.beds import BedMeasure, level_measure, mass_measure

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

    import numpy as np

NOTE = """
Asked: the mass of a level bed at the bulk density of the material, and a little more that the consolidator pushes; the
bed's height, and what of it covers the sample's middle. Found, over the last revolution before the sample comes in:
twice the height of the centre of mass of the quarter that has just left the consolidator. Over the sample the bed
heaps up above that. Bulk density: of a level bed of the found mass, less what the consolidator pushes, and the found
level, and over the material's, which is asked. A bed outside a tolerance is refused.
"""


def bed_measures(bed: Mapping[str, Any], thermo: Mapping[str, np.ndarray]) -> list[BedMeasure]:
    """Return mass (kg), level past the consolidator (m) and the sample's depth under it (m), over the last revolution.

    thermo: columns of the log of the bed's deck
    """
    last = thermo["Step"] > thermo["Step"][-1] - bed["revolution_s"] / bed["time_step_s"]
    mass, level = float(thermo["bed_mass"][-1]), float(thermo["level_h"][last].mean())
    particle, height = bed["particle"], bed["bed_height_m"]
    return [
        mass_measure(particle, tester_deck.poured_mass(bed), mass),
        level_measure(particle, height, level),
        level_measure(particle, height, level, "depth", covering=height - bed["depth_m"]),
    ]
