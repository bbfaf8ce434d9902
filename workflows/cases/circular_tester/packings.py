"""Means over packings of tables of the circular wear tester, with their intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import COLUMNS, Estimate, estimates

PACKING = "packing"  # column of tables of runs
LOW, HIGH = COLUMNS[1:]


def over_packings(table: pd.DataFrame, by: Sequence[str], value: str, log: bool = False) -> pd.DataFrame:
    """Return <by>, the mean of a value over the packings, and COLUMNS of its 95 % interval, NaN of one packing.

    table: <by>, value and PACKING, one row or several per packing; log: as for `intervals.estimate`
    """
    found = estimates_by(table, by, value, log)
    rows = [(*key, each.value, each.packings, *each.interval()) for key, each in found.items()]
    return pd.DataFrame(rows, columns=[*by, value, *COLUMNS])


def estimates_by(table: pd.DataFrame, by: Sequence[str], value: str, log: bool = False) -> dict[tuple, Estimate]:
    """Return {values of <by>: estimate of a value over the packings}; arguments as for `over_packings`."""
    keys = pd.MultiIndex.from_frame(table[list(by)]).to_flat_index()
    return estimates(keys, table[value], table[PACKING], log)


def of_several(found: Estimate) -> Estimate:
    """Return an estimate without scatter where it is of one packing, whose own blocks say nothing of another one."""
    return found if found.packings > 1 else replace(found, error=np.nan, freedom=0)


def interval_columns(name: str, found: Estimate, factor: float = 1.0) -> dict[str, float]:
    """Return name, <name>_low and <name>_high of an estimate, in display units by a factor."""
    found = of_several(found)
    low, high = found.interval()
    return {name: factor * found.value, f"{name}_low": factor * low, f"{name}_high": factor * high}


def errorbars(table: pd.DataFrame, value: str, factor: float = 1.0) -> np.ndarray:
    """Return how far intervals reach below and above means (2, k), for error bars; NaN where they are unknown.

    table: as from `over_packings`
    """
    return factor * np.abs(table[[LOW, HIGH]].to_numpy(dtype=float).T - table[value].to_numpy(dtype=float))
