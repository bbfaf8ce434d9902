"""Service life of a part: how much it may lose, when that is lost, and the interval of it.

Life is what is allowed over the rate at which it is lost. The rate scatters between packings and blocks, and its
coefficient of wear is known to some error, which is one factor on all rates of a part: `prediction` joins both. An
error of the coefficient of 0.2 makes the life at most 1/0.8 as long and at least 1/1.2.

A rate of one packing has an interval of its own blocks: the life is then that of this packing. How often intervals hold
the truth: benchmarks/service_life_coverage.py.
"""

from __future__ import annotations

import math
from dataclasses import astuple
from typing import NamedTuple

import numpy as np

from bulkwear.postproc.wear.prediction import Estimated, Prediction, joined, log_reach, predicted

TONNES_PER_MT = 1e6


class Life(Prediction):
    """When an allowed amount is lost, in hours of operation, with the 95 % interval.

    value: allowed amount over the rate, infinite where nothing is lost
    """

    @property
    def hours(self) -> float:
        """The life, h."""
        return self.value

    @property
    def low_h(self) -> float:
        """Lower end of its interval, h; NaN where the scatter is unknown."""
        return self.low

    @property
    def high_h(self) -> float:
        """Upper end of its interval, h; NaN where the scatter is unknown."""
        return self.high

    def throughput_mt(self, rate_t_per_h: float) -> tuple[float, float, float]:
        """Life and its ends in Mt of bulk, at so many t/h."""
        return tuple(throughput_mt(hours, rate_t_per_h) for hours in (self.hours, self.low_h, self.high_h))

    def years(self, hours_per_year: float) -> tuple[float, float, float]:
        """Life and its ends in years of so many hours of operation."""
        return tuple(hours / hours_per_year for hours in (self.hours, self.low_h, self.high_h))

    def said(self, unit: str = "h") -> str:
        """Life, interval, what makes it wide, and of what it is, in words."""
        return super().said(unit)


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
    known = rate.value > 0.0
    hours = allowed / rate.value if known else math.inf if rate.value == 0.0 and allowed > 0.0 else math.nan
    reach = log_reach(rate) if known else math.nan
    return Life(*astuple(joined(hours, reach, coefficient_error, rate.packings, inverse=True)))


def life_interval(hours: Estimated, coefficient_error: float) -> tuple[float, float]:
    """The 95 % interval of a life that is known with its scatter alone, as by following each packing to its end.

    hours: with the scatter of packings or blocks; coefficient_error: as of `life`. NaN where the scatter is unknown.
    """
    found = predicted(hours, coefficient_error, inverse=True)
    return found.low, found.high


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
