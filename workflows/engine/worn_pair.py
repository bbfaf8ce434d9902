"""What wears and what wears it: the pair of materials that a wear coefficient is of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any

from bulkwear.postproc.wear.coefficient import DIMENSIONLESS

WALL_HARDNESS = "wall_hardness_pa"  # key of what wears, from the file of materials
LAW_FIGURES = ("volume_by_law", "wear_by_law", "maps_by_law")  # of `Case.shared_figures`: laws side by side
COEFFICIENT_ERROR = "wear_coefficient_error"  # key of the section `wear`: -, half of the 95 % interval over the value
BESIDE = "beside"  # key of the section `wear`: further laws whose sums the ledgers hold, with their parameters
ONLY_TOLD = (DIMENSIONLESS, WALL_HARDNESS)  # keys beside the coefficient in 1/Pa, which is what wears


@dataclass(frozen=True)
class WornPair:
    """A wall that wears, and what wears it.

    block: path of the block of settings that holds its wear coefficient, or gets it
    """

    block: tuple[str, ...]
    wall: str
    particle: str
    law: str


def pair_of_section(settings: Mapping[str, Any], *named: tuple[str, ...]) -> WornPair:
    """Return the pair whose coefficient is that of the section `wear`.

    named: paths of the settings that name its wall and what wears it
    """
    wall, particle = (reduce(dict.__getitem__, path, settings) for path in named)
    return WornPair(("wear",), wall, particle, settings["wear"]["law"])
