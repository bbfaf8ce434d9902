"""Candidates that a benchmark compares: means over packings, and the ratio of each to a reference, with intervals.

One scatter is taken for all candidates, as they differ little from each other: an assumption, which gives candidates of
few packings the degrees of freedom of all. A candidate of one packing has no interval all the same.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
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
    groups: Sequence[Hashable] | np.ndarray | None = None,
) -> pd.DataFrame:
    """Return group, setting, packings, mean (geometric) with low and high, scatter (standard deviation of ln(value)
    between packings), freedom (of it), and ratio to the reference of the group with ratio_low and ratio_high, which it
    has not itself.

    settings: (n,) labels; values: (n,) positive, one per packing. Packings of two settings are taken as independent.
    groups: (n,) labels within which settings are compared, one for all where nothing is given; the scatter is that of
        all groups
    Raises ValueError where a group has no value of the reference.
    """
    of_group = [0] * len(values) if groups is None else list(groups)
    found = estimates(list(zip(of_group, settings, strict=True)), values, log=True, one_scatter=True)
    for group in dict.fromkeys(of_group):
        if (group, reference) not in found or not found[group, reference].packings:
            there = ", ".join(str(name) for at, name in found if at == group)
            at = "" if groups is None else f" at {group}"
            raise ValueError(f"no run of {reference}{at}, found are {there or 'none'}")
    rows = []
    for (group, name), each in found.items():
        # one scatter: its degrees of freedom
        over = replace(difference(each, found[group, reference]), freedom=each.freedom)
        ends = over.interval(level) if name != reference else (math.nan, math.nan)
        scatter = each.error * math.sqrt(each.packings)
        freedom = each.freedom if each.known else 0
        rows.append(
            (group, name, each.packings, each.value, *each.interval(level), scatter, freedom, over.value, *ends)
        )
    columns = ["group", "setting", "packings", "mean", "low", "high", "scatter", "freedom"]
    return pd.DataFrame(rows, columns=[*columns, "ratio", "ratio_low", "ratio_high"])
