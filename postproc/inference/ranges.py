"""Ranges of the factors of a design, in steps: the unit cube that a search works in, and the values it stands for."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

SPREAD = 256  # values over the whole ranges
DIGITS = 9  # significant ones of a value: below is what counting steps leaves

Allowed = Callable[[np.ndarray], np.ndarray]  # (n, p) values -> (n,) whether each can be simulated


@dataclass(frozen=True)
class Range:
    """A factor and the values that it may have: low, low + step, ... up to high; all in one unit. A whole number has 1
    as its step.
    """

    name: str
    low: float
    high: float
    step: float

    @property
    def steps(self) -> int:
        """How many steps there are from the lowest to the highest value."""
        return int((self.high - self.low) / self.step * (1.0 + 10.0**-DIGITS))


def values_of(ranges: Sequence[Range], points: np.ndarray) -> np.ndarray:
    """Return the values (n, p) nearest to points (n, p) of the unit cube."""
    low, step, steps = (np.array([getattr(each, key) for each in ranges]) for key in ("low", "step", "steps"))
    taken = np.minimum(np.floor(np.clip(points, 0.0, 1.0) * (steps + 1)), steps)
    return np.array([[float(f"{value:.{DIGITS}g}") for value in row] for row in low + taken * step])


def points_of(ranges: Sequence[Range], values: np.ndarray) -> np.ndarray:
    """Return values (n, p), also ones beside the steps or out of range, as points: a step is as long everywhere."""
    low, step, steps = (np.array([getattr(each, key) for each in ranges]) for key in ("low", "step", "steps"))
    return ((np.asarray(values, float) - low) / step + 0.5) / (steps + 1)


def spread_values(ranges: Sequence[Range], count: int, seed: int) -> np.ndarray:
    """Return up to `count` values (n, p) that fill the ranges evenly, each once.

    The additive sequence of irrational steps g^-1, g^-2, ... with g^(p+1) = g + 1, p = 1 that of the golden ratio, from
    a start that the seed gives. The first ones of a longer sequence are those of a shorter one.
    """
    roots = np.roots([1.0, *[0.0] * (len(ranges) - 1), -1.0, -1.0])
    steps = roots[np.isreal(roots)].real.max() ** -np.arange(1.0, len(ranges) + 1.0)
    start = np.random.default_rng(seed).random(len(ranges))
    return each_once(values_of(ranges, (start + np.arange(count)[:, None] * steps) % 1.0))


def values_near(ranges: Sequence[Range], centres: np.ndarray, reach: float, count: int, seed: int) -> np.ndarray:
    """Return up to `count` values (n, p) about each of some others (m, p), each once.

    reach: -, standard deviation over the range of each factor; beyond a range its end is taken. Seeded.
    """
    chance = np.random.default_rng(seed)
    middle = points_of(ranges, centres)[:, None]
    moved = middle + reach * chance.standard_normal((len(centres), count, len(ranges)))
    return each_once(values_of(ranges, moved.reshape(-1, len(ranges))))


def each_once(values: np.ndarray) -> np.ndarray:
    """Return the rows of a table (n, p), each where it stands first."""
    _, first = np.unique(values, axis=0, return_index=True)
    return values[np.sort(first)]


def without(values: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return the rows (n, p) that are none of the others (m, p)."""
    return values[~(values[:, None] == np.asarray(others)[None]).all(axis=2).any(axis=1)]


def first_values(
    ranges: Sequence[Range], allowed: Allowed, count: int, seed: int, others: Sequence[Sequence[float]] = ()
) -> np.ndarray:
    """Return `count` values (count, p) to begin with, which fill what is allowed of the ranges evenly,
    none of the others.

    Raises ValueError where the ranges have fewer that are allowed.
    """
    found = spread_values(ranges, SPREAD, seed)
    fresh = without(found, np.array(others)) if len(others) else found
    kept = list(itertools.islice((values for values in fresh if allowed(values[None])[0]), count))
    if len(kept) < count:
        raise ValueError(f"found {len(kept)} designs that can be simulated within ranges, allowed are {count} or more")
    return np.array(kept).reshape(count, len(ranges))
