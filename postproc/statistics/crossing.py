"""Where a ratio that depends on a place, such as a scale, passes a level: an interval over forms, with lack of fit.

What is fitted are replicates, packings at every place. Their scatter about the means of their places is the pure error.
A form that misses those means by more than the pure error lets expect (F test of lack of fit) is rejected; the interval
is what the others leave open together. Nothing is extended beyond the places that there are.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import CONFIDENCE, UNKNOWN, estimates, students_t

REJECTED = 0.05  # -, a form whose lack of fit is less probable than that is no form of these data
PLACES = 2001  # at which a fitted form is looked at between the first and the last place
FEWEST_PLACES = 3  # a line has two coefficients and must be able to fail

Columns = Callable[[np.ndarray], list[np.ndarray]]
# of the place, for the ratio or for its logarithm
FORMS: Mapping[str, tuple[bool, Columns]] = {
    "ratio, line": (False, lambda x: [np.ones_like(x), x]),
    "ratio, parabola": (False, lambda x: [np.ones_like(x), x, x**2]),
    "ln ratio, line": (True, lambda x: [np.ones_like(x), x]),
    "ln ratio, parabola": (True, lambda x: [np.ones_like(x), x, x**2]),
    "ln ratio, power law": (True, lambda x: [np.ones_like(x), np.log(x)]),
    "ln ratio, parabola of ln": (True, lambda x: [np.ones_like(x), np.log(x), np.log(x) ** 2]),
}
TABLE = (
    *("form", "crossing", "interval_low", "interval_high", "lack_of_fit_F", "freedom_of_lack", "freedom_of_error"),
    *("p_value", "rejected"),
)


@dataclass(frozen=True)
class Crossing:
    """Where a ratio passes its level.

    value: by the form with the fewest coefficients that is not rejected, of several the one that misses least; NaN
        where none crosses between the places
    low, high: interval over all forms that are not rejected; an infinite end lies beyond the places that there are
    below, above: the place next below and next above it at which a place's own packings tell the side, whatever the
        form; NaN without one
    forms: how many are not rejected, of the number tried: those that the places can tell
    packings: at the place that has fewest
    reason: why there is no interval; "" where there is one
    """

    value: float
    low: float
    high: float
    below: float
    above: float
    forms: int
    tried: int
    packings: int
    reason: str = ""

    @property
    def bounded(self) -> bool:
        """Return whether both ends of the interval lie between the places."""
        return not self.reason and math.isfinite(self.low) and math.isfinite(self.high)


def form_table(place: np.ndarray, ratio: np.ndarray, level: float = 1.0) -> pd.DataFrame:
    """Return TABLE, a line per form that the places can tell: its crossing, interval, and test of lack of fit.

    place, ratio: (k,) one of each packing, above zero; level: of the ratio
    The crossing is the first one between the places, NaN without one; the interval holds all places at which the level
    is within Student's t times the standard error of the form (E. C. Fieller, J. Roy. Stat. Soc. B 16, 1954, for a
    line); it is empty (NaN) where none is, and an end is infinite where it reaches the first or last place. The error
    is the pure one; without repeated places there is none, and no interval and no test.
    """
    place, ratio = _whole(place, ratio)
    own = np.unique(place)
    rows = []
    for name, (logarithm, columns) in FORMS.items():
        if len(own) <= len(columns(own)):
            continue  # it would pass through every mean: no lack of fit could show
        y = np.log(ratio / level) if logarithm else ratio - level
        rows.append({"form": name, **_fitted(place, y, columns)})
    return pd.DataFrame(rows, columns=list(TABLE))


def _fitted(place: np.ndarray, y: np.ndarray, columns: Columns) -> dict[str, float | bool]:
    """Return the numbers of one form."""
    matrix = np.column_stack(columns(place))
    coefficients, *_ = np.linalg.lstsq(matrix, y, rcond=None)
    test = lack_of_fit(place, y, matrix @ coefficients, matrix.shape[1])
    of_error = test["freedom_of_error"]
    grid = np.linspace(place.min(), place.max(), PLACES)
    over = np.column_stack(columns(grid))
    value = over @ coefficients
    found = {"crossing": _first_zero(grid, value), "interval_low": math.nan, "interval_high": math.nan}
    found |= test | {"rejected": bool(test["p_value"] < REJECTED)}
    if not of_error:
        return found
    error = pure_error(place, y) * np.sqrt(np.einsum("ij,jk,ik->i", over, np.linalg.inv(matrix.T @ matrix), over))
    within = grid[np.abs(value) <= students_t(0.5 + 0.5 * CONFIDENCE, of_error) * error]
    if within.size:
        found["interval_low"] = float(within[0]) if within[0] > grid[0] else -math.inf
        found["interval_high"] = float(within[-1]) if within[-1] < grid[-1] else math.inf
    return found


def pure_error(place: np.ndarray, y: np.ndarray) -> float:
    """Return the standard deviation of values (k,) about the means of their places; NaN where none is repeated."""
    means = pd.Series(y).groupby(np.asarray(place)).transform("mean").to_numpy()
    freedom = len(y) - len(np.unique(place))
    return math.sqrt(float(((y - means) ** 2).sum()) / freedom) if freedom else math.nan


def lack_of_fit(place: np.ndarray, y: np.ndarray, fitted: np.ndarray, coefficients: int) -> dict[str, float]:
    """Return lack_of_fit_F, its degrees of freedom and p_value: what a fit misses the means of the places by, over the
    pure error (N. R. Draper and H. Smith, Applied Regression Analysis, section 2.1); NaN where no place is repeated.

    place, y, fitted: (k,); coefficients: of the fit
    """
    means = pd.Series(y).groupby(np.asarray(place)).transform("mean").to_numpy()
    places = len(np.unique(place))
    of_lack, of_error = places - coefficients, len(y) - places
    found = {"lack_of_fit_F": math.nan, "freedom_of_lack": of_lack, "freedom_of_error": of_error, "p_value": math.nan}
    if of_lack < 1 or of_error < 1:
        return found
    lack, pure = float(((means - fitted) ** 2).sum()) / of_lack, pure_error(place, y) ** 2
    f_value = lack / pure if pure > 0.0 else (math.inf if lack > 0.0 else 0.0)
    from scipy import special  # slow to import, and every start of Snakemake reads this module

    return found | {"lack_of_fit_F": f_value, "p_value": float(special.fdtrc(of_lack, of_error, f_value))}


def _whole(place: np.ndarray, ratio: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return places and ratios without those that are missing or not above zero."""
    place, ratio = np.asarray(place, dtype=float), np.asarray(ratio, dtype=float)
    there = np.isfinite(ratio) & (ratio > 0.0)
    return place[there], ratio[there]


def _first_zero(grid: np.ndarray, value: np.ndarray) -> float:
    passes = np.flatnonzero(np.sign(value[1:]) != np.sign(value[:-1]))
    if not passes.size:
        return math.nan
    k = passes[0]
    return float(grid[k] - value[k] * (grid[k + 1] - grid[k]) / (value[k + 1] - value[k]))


def crossing(place: np.ndarray, ratio: np.ndarray, level: float = 1.0) -> Crossing:
    """Return where a ratio rises or falls through a level, over all forms; arguments as for `form_table`."""
    place, ratio = _whole(place, ratio)
    table = form_table(place, ratio, level)
    below, above = _bracket(place, ratio, level)
    told = {
        "below": below,
        "above": above,
        "tried": len(table),
        "packings": int(np.unique(place, return_counts=True)[1].min(initial=len(place))),
    }
    if table.empty:
        few = f"{len(np.unique(place))} places, a form that can fail needs {FEWEST_PLACES} or more"
        return Crossing(math.nan, math.nan, math.nan, forms=0, reason=few, **told)
    kept = table[~table["rejected"]]
    value = _simplest(kept)
    if not table["freedom_of_error"].iloc[0]:
        return Crossing(value, math.nan, math.nan, forms=len(kept), reason=UNKNOWN, **told)
    if kept.empty:
        return Crossing(math.nan, math.nan, math.nan, forms=0, reason="no form tried describes the wear", **told)
    ends = kept[["interval_low", "interval_high"]].dropna()
    if ends.empty:
        return Crossing(
            math.nan, math.nan, math.nan, forms=len(kept), reason="none between the smallest and the largest", **told
        )
    low, high = float(ends["interval_low"].min()), float(ends["interval_high"].max())
    return Crossing(value, low, high, forms=len(kept), **told)


def _simplest(kept: pd.DataFrame) -> float:
    """Return the crossing of the form with the fewest coefficients, of several of the one with the least lack."""
    ordered = kept.sort_values(["freedom_of_lack", "lack_of_fit_F"], ascending=[False, True], kind="stable")
    return float(ordered["crossing"].iloc[0]) if len(ordered) else math.nan


def _bracket(place: np.ndarray, ratio: np.ndarray, level: float) -> tuple[float, float]:
    """Return the places next to each other, of those at which the interval of the place's own packings excludes the
    level, between which the side changes for the first time; NaN where it does not.
    """
    sides = []
    for where, one in sorted(estimates(place, ratio / level, log=True).items()):
        low, high = one.interval()
        if low > 1.0 or high < 1.0:
            sides.append((float(where), low > 1.0))
    for (first, side), (second, other) in itertools.pairwise(sides):
        if side != other:
            return first, second
    return math.nan, math.nan
