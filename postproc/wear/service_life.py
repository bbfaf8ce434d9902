"""Service life of a part: how much it may lose, when that is lost, and the interval of it.

Life is what is allowed over the rate at which it is lost. The rate scatters between packings and blocks, and its
coefficient of wear is known to some error, which is one factor on all rates of a part. Both are independent factors:
their 95 % half widths are added as squares in the logarithm. Of half widths by Student's t such an interval holds the
truth at least as often as it says (S. K. Banerjee, Sankhya 22, 1960, 357; H. Ruben, Sankhya A 64, 2002, 139). An error
of the coefficient of 0.2 means 0.8 to 1.2 times the value, so that it makes the life at most 1/0.8 as long and at least
1/1.2: the interval of the life is not symmetric, even in the logarithm.

A rate of one packing has an interval of its own blocks: the life is then that of this packing. How often intervals hold
the truth: benchmarks/service_life_coverage.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

TONNES_PER_MT = 1e6


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
class Life:
    """When an allowed amount is lost, in hours of operation, with the 95 % interval.

    hours: allowed amount over the rate, infinite where nothing is lost; low_h, high_h: NaN where the scatter is unknown
    scatter_reach, coefficient_reach: -, half widths in the logarithm, of the rate and of the coefficient
    packings: behind the rate; with 1 the interval is of this packing alone
    """

    hours: float
    low_h: float
    high_h: float
    scatter_reach: float
    coefficient_reach: float
    packings: int

    @property
    def known(self) -> bool:
        """Whether there is an interval."""
        return not (math.isnan(self.low_h) or math.isnan(self.high_h))

    @property
    def scatter_share(self) -> float:
        """What part (-) of the interval's squared width the scatter of the rate makes; the coefficient makes the rest.

        NaN where the scatter is unknown or there is neither.
        """
        squares = self.scatter_reach**2 + self.coefficient_reach**2
        return self.scatter_reach**2 / squares if squares > 0.0 else math.nan

    def throughput_mt(self, rate_t_per_h: float) -> tuple[float, float, float]:
        """Life and its ends in Mt of bulk, at so many t/h."""
        return tuple(throughput_mt(hours, rate_t_per_h) for hours in (self.hours, self.low_h, self.high_h))

    def years(self, hours_per_year: float) -> tuple[float, float, float]:
        """Life and its ends in years of so many hours of operation."""
        return tuple(hours / hours_per_year for hours in (self.hours, self.low_h, self.high_h))

    def said(self) -> str:
        """Life, interval, what makes it wide, and of what it is, in words."""
        if not self.known:
            return f"{_few(self.hours)} h{' (one packing, scatter unknown)' * (self.packings < 2)}"
        of = f"{self.packings} packings" if self.packings > 1 else "of this packing alone"
        share = "" if math.isnan(self.scatter_share) else f", {_shares(self.scatter_share)}"
        low, high = _few(self.low_h), _few(self.high_h)
        return f"{_few(self.hours)} h (95 % interval {low} to {high} h, {of}{share})"


def _few(hours: float) -> str:
    """Hours with three significant digits, without an exponent."""
    return f"{float(f'{hours:.3g}'):,.12g}"


class Reached(NamedTuple):
    """When a depth is reached, hours of operation; extrapolated: later than the history goes."""

    hours: float
    extrapolated: bool


def allowed_depth(
    thickness_m: np.ndarray | float, remaining_m: float = 0.0, remaining_fraction: float = 0.0
) -> np.ndarray:
    """Depth (k,) m that places with a thickness (k,) m may lose until so much is left of it.

    remaining_m, remaining_fraction: m, and - of the thickness; of both the larger counts; 0: until it is worn through
    NaN where the thickness is not known or no more than what shall remain. Raises ValueError for other rules.
    """
    if not (math.isfinite(remaining_m) and remaining_m >= 0.0):
        raise ValueError(f"the thickness that remains is {remaining_m:g} m, allowed is 0 or more")
    if not 0.0 <= remaining_fraction < 1.0:
        raise ValueError(f"the fraction of the thickness that remains is {remaining_fraction:g}, allowed is 0 to 1")
    thickness = np.asarray(thickness_m, dtype=np.float64)
    allowed = thickness - np.maximum(remaining_m, remaining_fraction * thickness)
    return np.where(allowed > 0.0, allowed, np.nan)


def allowed_volume(volume_m3: float, worn_mass_fraction: float) -> float:
    """Volume (m3) that a part of one material may lose until a fraction (-) of its mass is worn.

    Raises ValueError for a volume not above 0 or a fraction not above 0 and up to 1.
    """
    if not volume_m3 > 0.0:
        raise ValueError(f"the volume of the part is {volume_m3:g} m3, allowed is above 0; its surface must be closed")
    if not 0.0 < worn_mass_fraction <= 1.0:
        raise ValueError(f"the fraction of the mass that is worn is {worn_mass_fraction:g}, allowed is above 0 up to 1")
    return worn_mass_fraction * volume_m3


def life(rate: Estimated, coefficient_error: float, allowed: float) -> Life:
    """When an allowed amount is lost at a rate per hour of operation.

    rate: m/h with allowed in m, m3/h in m3, or the share of what is allowed per hour (1/h) with 1; with the scatter of
    packings, or of the blocks of one; best of the logarithm: of another its upper end is taken for both sides
    coefficient_error: -, half width of the coefficient's 95 % interval over its value
    NaN where rate or allowed amount are not known. Raises ValueError for a negative rate and other errors.
    """
    if rate.value < 0.0:
        raise ValueError(f"the rate of wear is {rate.value:g} per hour, allowed is 0 or more")
    both = coefficient_reaches(coefficient_error)
    mean = 0.5 * sum(both)
    if not rate.value > 0.0:
        hours = math.inf if rate.value == 0.0 and allowed > 0.0 else math.nan
        return Life(hours, math.nan, math.nan, math.nan, mean, rate.packings)
    hours, scatter = allowed / rate.value, _reach(rate)
    low, high = _ends(hours, scatter, both)
    return Life(hours, low, high, scatter, mean, rate.packings)


def life_interval(hours: Estimated, coefficient_error: float) -> tuple[float, float]:
    """The 95 % interval of a life that is known with its scatter alone, as by following each packing to its end.

    hours: with the scatter of packings or blocks; coefficient_error: as of `life`. NaN where the scatter is unknown.
    """
    return _ends(hours.value, _reach(hours), coefficient_reaches(coefficient_error))


def coefficient_reaches(coefficient_error: float) -> tuple[float, float]:
    """Half widths (-) in the logarithm by which the coefficient's error makes a life shorter, and longer.

    Raises ValueError for an error not within 0 and less than 1.
    """
    if not 0.0 <= coefficient_error < 1.0:
        raise ValueError(f"the error of the wear coefficient is {coefficient_error:g}, allowed is 0 to less than 1")
    return math.log1p(coefficient_error), -math.log1p(-coefficient_error)


def hour_reached(
    operation_h: np.ndarray, depth_m: np.ndarray, allowed_m: float, last_rate_m_per_h: float = math.nan
) -> Reached:
    """When a place has lost an allowed depth, along its history and beyond it at the last rate.

    operation_h: (k,) increasing; depth_m: (k,) lost by then; it may not fall: where it seems to, as a mean over faces
    that were remeshed, it stays; infinite without a rate, NaN where allowed depth or last rate are not known
    Raises ValueError for an empty history, or hours that do not increase.
    """
    hours, depth = np.asarray(operation_h, dtype=np.float64), np.asarray(depth_m, dtype=np.float64)
    if hours.shape != depth.shape or hours.ndim != 1 or not len(hours):
        raise ValueError(
            f"found {hours.size} hours and {depth.size} depths, allowed is one depth per hour, one or more"
        )
    if not (np.diff(hours) > 0.0).all():
        raise ValueError("the hours of operation do not increase, allowed are increasing ones")
    depth = np.maximum.accumulate(depth)
    if depth[-1] >= allowed_m:
        after = int(np.argmax(depth >= allowed_m))
        if after == 0:
            return Reached(float(hours[0]), False)
        share = (allowed_m - depth[after - 1]) / (depth[after] - depth[after - 1])
        return Reached(float(hours[after - 1] + share * (hours[after] - hours[after - 1])), False)
    left = allowed_m - float(depth[-1])
    beyond = math.inf if last_rate_m_per_h == 0.0 and left > 0.0 else left / (last_rate_m_per_h or math.nan)
    return Reached(float(hours[-1]) + beyond, True)


def throughput_mt(hours: float, rate_t_per_h: float) -> float:
    """Bulk (Mt) that passes in so many hours at so many t/h."""
    return hours * rate_t_per_h / TONNES_PER_MT


def hours_of(throughput_mt: float, rate_t_per_h: float) -> float:
    """Hours in which so much bulk (Mt) passes at so many t/h."""
    return throughput_mt * TONNES_PER_MT / rate_t_per_h


def _reach(found: Estimated) -> float:
    """Half width (-) in the logarithm, by the upper end; of an estimate that is not of the logarithm to first order."""
    if not found.known or not found.value > 0.0:
        return math.nan
    upper = found.interval()[1] / found.value
    return math.log(upper) if getattr(found, "log", False) else upper - 1.0


def _ends(hours: float, scatter: float, coefficient: tuple[float, float]) -> tuple[float, float]:
    shorter, longer = (math.hypot(scatter, each) for each in coefficient)
    return hours * math.exp(-shorter), hours * math.exp(longer)


def _shares(scatter: float) -> str:
    return (
        f"scatter makes {100.0 * scatter:.0f} % of its square and the wear coefficient {100.0 * (1.0 - scatter):.0f} %"
    )
