"""Wall friction of a bed on a plate that is drawn away under it: shear over normal force of the plate."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from bulkwear.postproc.readers.solver_log import thermo_rows
from bulkwear.postproc.statistics.intervals import error_of_mean

MOBILISED = 0.5  # -, of the drag, after which the bed slides; before, grains roll and the bed leans on the wall
BLOCKS = 10  # of the rest, whose scatter is the uncertainty
FEWEST_MEANS = 4 * BLOCKS  # of the forces, over the whole drag


class WallShearError(ValueError):
    """A wall shear test without forces to measure; the message names the log and what is missing."""


def wall_friction_angle(log: str | Path) -> tuple[float, float]:
    """Return the wall friction angle and its standard uncertainty, rad, from the log of a wall shear test.

    The angle is atan(sum of shear / sum of normal force) over the second half of the drag; the uncertainty is that of
    the mean of its blocks, correlated as they are. Raises WallShearError without forces, or without a load,
    SolverLogError for a log without their columns.
    """
    thermo = thermo_rows(Path(log))
    there = np.isfinite(thermo["shear_n"])
    shear, normal = -thermo["shear_n"][there], -thermo["normal_n"][there]
    if len(shear) < FEWEST_MEANS:
        raise WallShearError(f"{log}: {len(shear)} forces on the plate, allowed are {FEWEST_MEANS} or more.")
    start = int(MOBILISED * len(shear))
    shear, normal = shear[start:], normal[start:]
    if not normal.sum() > 0.0:
        raise WallShearError(f"{log}: no normal force on the plate, allowed is a bed that rests on it.")
    blocks = [
        math.atan2(some.sum(), load.sum())
        for some, load in zip(np.array_split(shear, BLOCKS), np.array_split(normal, BLOCKS), strict=True)
    ]
    return math.atan2(shear.sum(), normal.sum()), error_of_mean(np.array(blocks))
