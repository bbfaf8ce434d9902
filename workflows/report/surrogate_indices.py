"""Sobol indices of a surrogate: which parameter decides a response over the ranges that were simulated."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from bulkwear.postproc.inference.surrogate import KERNELS, Surrogate
from bulkwear.postproc.statistics.sensitivity import RESAMPLES, sobol_indices

POWER = 8  # 256 points, each (parameters + 2) times: the draws of a process are of all of them together
FEWEST_PER_PARAMETER = 2  # simulations, and one more, below which a surrogate is little but its prior


def surrogate_indices(surrogate: Surrogate, names: Sequence[str]) -> pd.DataFrame:
    """Return the indices of a surrogate's parameters as `sobol_indices` does; intervals hold what it does not know."""
    return sobol_indices(lambda points: surrogate.draws(points, -(-RESAMPLES // KERNELS), 0), names, POWER)


def why_not(surrogate: Surrogate) -> str:
    """Return why a surrogate does not hold, "" where it does."""
    count, parameters = surrogate.points.shape
    fewest = FEWEST_PER_PARAMETER * parameters + 1
    if count < fewest:
        return f"{count} simulations of {parameters} parameters, allowed are {fewest} or more"
    share = surrogate.left_out_share
    if not share > 0.0:
        return f"simulations that are left out are predicted no better than by their mean (R² {share:.2g})"
    return ""
