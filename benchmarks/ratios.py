"""Candidates that a benchmark compares: means over packings, and the ratio of each to a reference, with intervals.

One scatter is taken for all candidates, as they differ little from each other: an assumption, which gives candidates of
few packings the degrees of freedom of all. A candidate of one packing has no interval all the same.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import CONFIDENCE, difference, estimates

ASSUMED = "one scatter is assumed for all"


def ratio_intervals(
    settings: Sequence[str] | np.ndarray,
    values: Sequence[float] | np.ndarray,
    reference: str,
    level: float = CONFIDENCE,
) -> pd.DataFrame:
    """Return setting, packings, mean (geometric) with low and high, scatter (standard deviation of ln(value) between
    packings), freedom (of it), and ratio to the reference with ratio_low and ratio_high, which it has not itself.

    settings: (n,) labels; values: (n,) positive, one per packing. Packings of two settings are taken as independent.
    Raises ValueError without a value of the reference.
    """
    found = estimates(settings, values, log=True, one_scatter=True)
    if reference not in found or not found[reference].packings:
        raise ValueError(f"no run of {reference}, found are {', '.join(map(str, found)) or 'none'}")
    rows = []
    for name, each in found.items():
        over = replace(difference(each, found[reference]), freedom=each.freedom)  # one scatter: its degrees of freedom
        ends = over.interval(level) if name != reference else (math.nan, math.nan)
        scatter = each.error * math.sqrt(each.packings)
        freedom = each.freedom if each.known else 0
        rows.append((name, each.packings, each.value, *each.interval(level), scatter, freedom, over.value, *ends))
    columns = ["setting", "packings", "mean", "low", "high", "scatter", "freedom", "ratio", "ratio_low", "ratio_high"]
    return pd.DataFrame(rows, columns=columns)
