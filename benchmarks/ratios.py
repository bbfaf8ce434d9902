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
from scipy.stats import chi2

from bulkwear.postproc.statistics.intervals import CONFIDENCE, difference, estimates

ASSUMED = "one scatter is assumed for all"


def scatter_of_groups(
    settings: Sequence[str] | np.ndarray, values: Sequence[float] | np.ndarray, groups: Sequence[Hashable] | np.ndarray
) -> pd.DataFrame:
    """Return by group the scatter (standard deviation of ln(value) between packings of one setting) and its degrees of
    freedom, of groups that have any; arguments as for `ratio_intervals`.
    """
    table = pd.DataFrame({"group": groups, "setting": settings, "value": np.log(np.asarray(values, float))})
    of_setting = table.groupby(["group", "setting"])["value"]
    squares = of_setting.var().mul(of_setting.size() - 1).groupby("group").sum()
    freedom = (of_setting.size() - 1).groupby("group").sum()
    found = pd.DataFrame({"scatter": np.sqrt(squares / freedom), "freedom": freedom})
    return found[found["freedom"] > 0]


def equal_scatter(scatter: np.ndarray, freedom: np.ndarray) -> float:
    """Return how probable it is that groups of one scatter differ as much as these or more, by Bartlett's test.

    scatter: (k,) standard deviations, k of 2 or more; freedom: (k,) degrees of freedom. M. S. Bartlett, Proc. R. Soc.
    Lond. A 160 (1937) 268
    """
    total = freedom.sum()
    pooled = (freedom * scatter**2).sum() / total
    statistic = total * np.log(pooled) - (freedom * np.log(scatter**2)).sum()
    correction = 1.0 + ((1.0 / freedom).sum() - 1.0 / total) / (3.0 * (len(freedom) - 1))
    return float(chi2.sf(statistic / correction, len(freedom) - 1))


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
