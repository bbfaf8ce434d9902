"""Factors of a design: between real and coded units, where -1, 0 and 1 are the low, middle and high level,
and their effects as orthogonal contrasts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from scipy import stats

from bulkwear.postproc.statistics.model_terms import SAME, Term, term_columns, term_name

MIDDLE = 1e-6  # -, how near, relative to the range, a middle level must be to the mean of the ends
LARGEST_OF_NOISE = 2.5  # -, contrasts beyond so many preliminary errors do not count as noise (Lenth 1989)


@dataclass(frozen=True)
class Factor:
    """A factor with its range.

    low, high: levels -1 and 1 in real units
    spacing: "linear", the middle level is the arithmetic mean; "log", it is the geometric mean (levels that double)

    Raises ValueError when high is not above low, and for a log spacing from a level that is not positive.
    """

    name: str
    low: float
    high: float
    spacing: Literal["linear", "log"] = "linear"

    def __post_init__(self) -> None:
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise ValueError(f"factor {self.name}: found {self.low:g} to {self.high:g}, allowed is a low below a high")
        if self.spacing == "log" and not self.low > 0.0:
            raise ValueError(f"factor {self.name}: found the low {self.low:g}, allowed with log is above 0")

    def real(self, coded: np.ndarray | float) -> np.ndarray:
        """Return values in real units; coded ones beyond -1 and 1 extrapolate."""
        share = 0.5 * (1.0 + np.asarray(coded, dtype=float))
        if self.spacing == "log":
            return self.low * (self.high / self.low) ** share
        return self.low + (self.high - self.low) * share

    def coded(self, real: np.ndarray | float) -> np.ndarray:
        """Return values in coded units (-); NaN where a log spacing has no logarithm."""
        values = np.asarray(real, dtype=float)
        if self.spacing == "log":
            positive = np.where(values > 0.0, values, np.nan)
            return 2.0 * np.log(positive / self.low) / math.log(self.high / self.low) - 1.0
        return 2.0 * (values - self.low) / (self.high - self.low) - 1.0


def factor_of(name: str, values: np.ndarray) -> Factor:
    """Return the factor that a column of a design spans.

    The spacing is log where the middle one of three levels is the geometric mean of the ends, else linear.
    Raises ValueError for a column with fewer than two levels.
    """
    levels = np.unique(np.asarray(values, dtype=float))
    if len(levels) < 2:
        raise ValueError(f"factor {name}: found {len(levels)} level(s), allowed are two or more")
    low, high = float(levels[0]), float(levels[-1])
    middle = math.sqrt(low * high) if low > 0.0 else math.nan
    doubled = len(levels) == 3 and abs(levels[1] - middle) <= MIDDLE * (high - low)
    return Factor(name, low, high, "log" if doubled else "linear")


def half_normal_table(
    terms: Sequence[Term], coded: np.ndarray, response: np.ndarray, names: Sequence[str]
) -> pd.DataFrame:
    """Return term, contrast, effect, half_normal_score and pseudo_error, smallest contrast first.

    A term's contrast is the response along the part of its column that is orthogonal to the constant and to all terms
    taken before it; each time the term with the largest contrast is taken. There are as many contrasts as runs less
    one at most. Where there is no effect, all have the error's standard deviation (units of the response); the largest
    ones are biased upwards, being chosen, the smallest downwards, being what is left. The effect is the contrast per
    coded unit of that part of the column.

    half_normal_score: quantile of (rank - 1/2) / contrasts of the half-normal distribution (C. Daniel, 1959)
    pseudo_error: R. V. Lenth's pseudo standard error (Technometrics 31, 1989), the same in every row
    """
    columns = term_columns(terms, coded)
    columns = columns - columns.mean(axis=0)
    rest = np.asarray(response, dtype=float) - np.mean(response)
    smallest = SAME * np.sqrt(len(columns))
    taken, contrasts, effects = [], [], []
    while len(contrasts) < len(rest) - 1:
        size = np.linalg.norm(columns, axis=0)
        unit = np.divide(columns, size, out=np.zeros_like(columns), where=size > smallest)
        along = unit.T @ rest
        if not (size > smallest).any():
            break
        best = int(np.where(size > smallest, np.abs(along), -1.0).argmax())
        taken.append(best)
        contrasts.append(along[best])
        effects.append(along[best] / size[best])
        rest = rest - along[best] * unit[:, best]
        columns = columns - np.outer(unit[:, best], unit[:, best] @ columns)
    table = pd.DataFrame(
        {"term": [term_name(terms[k], names) for k in taken], "contrast": contrasts, "effect": effects}
    )
    table = table.sort_values("contrast", key=np.abs, kind="stable", ignore_index=True)
    share = (np.arange(len(table)) + 0.5) / max(len(table), 1)
    return table.assign(half_normal_score=stats.halfnorm.ppf(share), pseudo_error=pseudo_error(table["contrast"]))


def pseudo_error(contrasts: np.ndarray) -> float:
    """Return Lenth's estimate of the error of contrasts of which few are effects; NaN without contrasts."""
    size = np.abs(np.asarray(contrasts, dtype=float))
    if not size.size:
        return float("nan")
    first = 1.5 * np.median(size)
    small = size[size < LARGEST_OF_NOISE * first]
    return float(1.5 * np.median(small)) if small.size else 0.0
