"""Predictions of absolute wear with the scatter of packings and the error of the wear coefficient in one interval.

A volume, a depth, a rate are proportional to the wear coefficient, hours until a depth is lost are inverse to it. What
packings scatter by and what the coefficient is wrong by are independent factors: their 95 % half widths are added as
squares in the logarithm. Of half widths by Student's t such an interval holds the truth at least as often as it says
(S. K. Banerjee, Sankhya 22, 1960, 357; H. Ruben, Sankhya A 64, 2002, 139). An error of 0.2 means 0.8 to 1.2 times the
coefficient: the interval is not symmetric, even in the logarithm. Ratios of two surfaces that wear by one coefficient
leave its error out. It is of first order: how the worn shape changes its own wear is not in it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

UNKNOWN = "one packing, scatter unknown"


class Estimated(Protocol):
    """What is asked of an estimate, as `postproc.statistics.intervals.Estimate` is one."""

    value: float
    packings: int

    @property
    def known(self) -> bool:
        """Whether there is an interval."""

    def interval(self) -> tuple[float, float]:
        """Both ends at 95 %."""


@dataclass(frozen=True)
class Prediction:
    """A predicted amount with its 95 % interval, in the unit of its value.

    low, high: by scatter and coefficient together, NaN where the scatter is unknown
    coefficient_low, coefficient_high: by the coefficient alone
    scatter_reach, coefficient_reach: -, half widths in the logarithm, of the coefficient the mean of both sides
    packings: behind it; with 1 a known interval is of this packing alone
    """

    value: float
    low: float
    high: float
    coefficient_low: float
    coefficient_high: float
    scatter_reach: float
    coefficient_reach: float
    packings: int

    @property
    def known(self) -> bool:
        """Whether there is an interval."""
        return not (math.isnan(self.low) or math.isnan(self.high))

    @property
    def scatter_share(self) -> float:
        """What part (-) of the interval's squared width the scatter makes; the coefficient makes the rest.

        NaN where the scatter is unknown or there is neither.
        """
        squares = self.scatter_reach**2 + self.coefficient_reach**2
        return self.scatter_reach**2 / squares if squares > 0.0 else math.nan

    def said(self, unit: str) -> str:
        """Value, interval, of what it is, and what makes it wide, in words."""
        value, ends = f"{few(self.value)} {unit}", f"95 % interval {few(self.low)} to {few(self.high)} {unit}"
        if self.known:
            of = f"{self.packings} packings" if self.packings > 1 else "of this packing alone"
            share = "" if math.isnan(self.scatter_share) else f", {shares_words(self.scatter_share)}"
            return f"{value} ({ends}, {of}{share})"
        said = [UNKNOWN] * (self.packings < 2)
        if self.coefficient_reach > 0.0 and math.isfinite(self.value):
            ends = f"{few(self.coefficient_low)} to {few(self.coefficient_high)} {unit}"
            said.append(f"the wear coefficient alone gives {ends}")
        return f"{value} ({'; '.join(said)})" if said else value


def predicted(found: Estimated, coefficient_error: float, inverse: bool = False) -> Prediction:
    """What is told of an estimate that holds the scatter alone, with the error of the coefficient joined.

    found: best of the logarithm; of another its upper end is taken for both sides
    coefficient_error: -, half width of the coefficient's 95 % interval over its value
    inverse: whether it is inverse to the coefficient, as hours, and not proportional to it, as volumes and rates
    Raises ValueError for an error not within 0 and less than 1.
    """
    return joined(found.value, log_reach(found), coefficient_error, found.packings, inverse)


def joined(
    value: float, scatter_reach: float, coefficient_error: float, packings: int, inverse: bool = False
) -> Prediction:
    """The same of a value whose scatter has that half width (-) in the logarithm; NaN where it is unknown."""
    less, more = coefficient_reaches(coefficient_error)
    down, up = (more, less) if inverse else (less, more)
    return Prediction(
        value,
        value * math.exp(-math.hypot(scatter_reach, down)),
        value * math.exp(math.hypot(scatter_reach, up)),
        value * math.exp(-down),
        value * math.exp(up),
        scatter_reach,
        0.5 * (less + more),
        packings,
    )


def coefficient_reaches(coefficient_error: float) -> tuple[float, float]:
    """Half widths (-) in the logarithm by which the coefficient may be smaller, and larger.

    Raises ValueError for an error not within 0 and less than 1.
    """
    if not 0.0 <= coefficient_error < 1.0:
        raise ValueError(f"the error of the wear coefficient is {coefficient_error:g}, allowed is 0 to less than 1")
    return -math.log1p(-coefficient_error), math.log1p(coefficient_error)


def log_reach(found: Estimated) -> float:
    """Half width (-) in the logarithm, by the upper end; of an estimate that is not of the logarithm to first order.

    NaN where the scatter is unknown or the value not above 0.
    """
    if not found.known or not found.value > 0.0:
        return math.nan
    upper = found.interval()[1] / found.value
    return math.log(upper) if getattr(found, "log", False) else upper - 1.0


def shares_words(scatter: float) -> str:
    """What scatter and coefficient make of the squared width, in words; scatter: -, its share."""
    return (
        f"scatter makes {100.0 * scatter:.0f} % of its square and the wear coefficient {100.0 * (1.0 - scatter):.0f} %"
    )


def few(value: float) -> str:
    """A number with three significant digits, without an exponent where it is neither tiny nor huge."""
    rounded = float(f"{value:.3g}")
    return f"{rounded:,.12g}" if rounded == 0.0 or 1e-3 <= abs(rounded) < 1e12 else f"{value:.2e}"
