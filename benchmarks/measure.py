"""What every benchmark gives: measures with their scatter, and ratios of things that were measured in turn."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

Found = TypeVar("Found")


@dataclass(frozen=True)
class Measure:
    """A measured value with its scatter over the repeats, and its ratio to what it is compared with.

    value, low, high: median, smallest and largest in `unit`; ratio, ratio_low, ratio_high: the same of value over
    `against`, repeat by repeat; NaN where nothing is compared
    """

    name: str
    unit: str
    value: float
    low: float
    high: float
    repeats: int
    against: str = ""
    ratio: float = math.nan
    ratio_low: float = math.nan
    ratio_high: float = math.nan


def measured(
    name: str, unit: str, values: Sequence[float], against: str = "", others: Sequence[float] | None = None
) -> Measure:
    """Return the measure of repeated values, and of their ratios to `others`, which were measured in turn with them.

    Raises ValueError where both are not as many.
    """
    low, value, high = np.quantile(values, (0.0, 0.5, 1.0))
    if others is None:
        return Measure(name, unit, float(value), float(low), float(high), len(values), against)
    if len(values) != len(others):
        raise ValueError(f"{name}: {len(values)} values against {len(others)} of {against}, allowed are as many")
    ratios = np.quantile(np.divide(values, others), (0.0, 0.5, 1.0))
    return Measure(name, unit, float(value), float(low), float(high), len(values), against, *ratios[[1, 0, 2]].tolist())


def in_turn(ways: Mapping[str, Callable[[], Found]], rounds: int) -> dict[str, list[Found]]:
    """Call every way once per round and return what it gave, by way.

    Their order turns from round to round, so that a drift of the machine's speed favours nobody.
    """
    names, found = list(ways), {name: [] for name in ways}
    for number in range(rounds):
        shift = number % len(names)
        for name in names[shift:] + names[:shift]:
            found[name].append(ways[name]())
    return found


def processor_times(task: Callable[[], object], repeats: int) -> list[float]:
    """Return the processor time (s) of each of several calls; other work on the machine does not count."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        task()
        times.append(time.process_time() - start)
    return times
