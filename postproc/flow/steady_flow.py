"""Whether the flow through a machine is steady: as much goes out as comes in, held mass and power stay as they are.

What comes in and goes out is counted, so the mean rate of a block is exact; between blocks rates fluctuate. In and out
are compared block by block; held mass and power by the second half of the window and the first, along a straight line.
Each is judged by its interval, with the answers of `statistics.steady`: within the tolerance for sure, beyond it for
sure, or not to be said. Where something flows the mass balance decides, in a filled machine the power; what does not
decide may not change beyond the tolerance for sure. That held mass and power are shown to be constant is not asked for
besides: they fluctuate slowly, over as long as particles stay, and a window that shows it is many times that long.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from scipy.integrate import cumulative_trapezoid

from bulkwear.postproc.statistics.block_means import change_of_blocks, mean_of_blocks
from bulkwear.postproc.statistics.intervals import CONFIDENCE, Estimate
from bulkwear.postproc.statistics.steady import (
    DRIFTING,
    FEWEST_VALUES,
    LARGEST_DRIFT,
    STEADY,
    UNSAID,
    answer_on_change,
    steady_window,
)

TIME, HELD, INSERTED, OUT = "time_s", "held_mass_kg", "inserted_mass_kg", "out_mass_kg"
BALANCE, MASS, POWER = "mass balance", "held mass", "power"
POWER_PREFIX, POWER_SUFFIX = "power_", "_W"
FEWEST_BLOCKS = FEWEST_VALUES
ROUNDING = 1e-9  # -, of a number of blocks
UNKNOWN = Estimate(math.nan, math.nan, 0, 0)


@dataclass(frozen=True)
class SteadyFlow:
    """What a flow does in a window of time, of this run alone.

    start_s, end_s: of the blocks; block_s: of each; blocks: their number
    tolerance: -, within which a difference or a change counts as none
    rate_in_kg_per_s, rate_out_kg_per_s: means over the blocks; imbalance: -, in less out over the larger of the two
    held_kg: mean; held_change: -, second half of the window less the first over the mean, by a line
    power_w: of all moving parts, NaN without; power_change: as of the held mass; power_changes: those of each part
    answers: {mass balance, held mass, power: STEADY, DRIFTING or UNSAID}, of what is there, the one that decides first
    answer: DRIFTING if one is, else that of the one that decides
    """

    start_s: float
    end_s: float
    block_s: float
    blocks: int
    tolerance: float
    rate_in_kg_per_s: Estimate = UNKNOWN
    rate_out_kg_per_s: Estimate = UNKNOWN
    imbalance: Estimate = UNKNOWN
    held_kg: float = math.nan
    held_change: Estimate = UNKNOWN
    power_w: float = math.nan
    power_change: Estimate = UNKNOWN
    power_changes: dict[str, Estimate] = field(default_factory=dict)
    answers: dict[str, str] = field(default_factory=dict)

    @property
    def answer(self) -> str:
        """Return the answer on the flow as a whole."""
        found = list(self.answers.values())
        return DRIFTING if DRIFTING in found else next(iter(found), UNSAID)

    @property
    def steady(self) -> bool:
        """Return whether the flow is shown to be steady."""
        return self.answer == STEADY

    def said(self) -> str:
        """Return one sentence with the answer and the numbers behind it."""
        window = f"from {self.start_s:.4g} to {self.end_s:.4g} s ({self.blocks} blocks of {self.block_s:.4g} s)"
        head = {
            STEADY: f"The flow is steady within {100.0 * self.tolerance:.3g} % {window}",
            DRIFTING: f"The flow is not steady within {100.0 * self.tolerance:.3g} % {window}",
            UNSAID: f"Whether the flow is steady within {100.0 * self.tolerance:.3g} % cannot be said {window}",
        }[self.answer]
        if self.blocks < FEWEST_BLOCKS:
            return f"{head}: {FEWEST_BLOCKS} blocks or more are needed."
        rates = (
            f"{_with_interval(self.rate_in_kg_per_s, 'kg/s')} come in and"
            f" {_with_interval(self.rate_out_kg_per_s, 'kg/s')} go out,"
            f" a difference of {_with_interval(self.imbalance, '%', 100.0)}"
        )
        told = {
            BALANCE: rates,
            MASS: f"{self.held_kg:.4g} kg are held and change by {_with_interval(self.held_change, '%', 100.0)}",
            POWER: f"{self.power_w:.4g} W are taken and change by {_with_interval(self.power_change, '%', 100.0)}",
        }
        sentences = [f"{told[name]}: {answer}" for name, answer in self.answers.items()]
        return f"{head}: {'; '.join(sentences or ['nothing flows and nothing moves'])}."


def steady_flow(table: pd.DataFrame, block_s: float, tolerance: float = LARGEST_DRIFT) -> SteadyFlow:
    """Return what the flow does over the whole of a table, in blocks that end with it.

    table: rows of one run by time: time_s, held_mass_kg; inserted_mass_kg, out_mass_kg counted from the start of the
    run; power_<part>_W of moving parts, if any. block_s: s, longer than the flow remembers; tolerance: -
    Of fewer than FEWEST_BLOCKS blocks nothing is said. Looked at again and again while a run goes on, a flow that
    drifts by the tolerance is called steady more often than the 5 % of one look.
    Raises ValueError for a table without these columns, rows that are not in the order of time or too far apart.
    """
    return _judged(_block_series(table, block_s), block_s, tolerance)


def steady_rest(table: pd.DataFrame, block_s: float, tolerance: float = LARGEST_DRIFT) -> SteadyFlow:
    """Return what the flow does after its start, which is cut off as `statistics.steady.steady_window` does.

    The latest start of held mass, outflow and power counts, at most half of the table, and FEWEST_BLOCKS blocks stay.
    Arguments and errors as for `steady_flow`.
    """
    series = _block_series(table, block_s)
    if len(series) < FEWEST_BLOCKS:
        return _judged(series, block_s, tolerance)
    names = [HELD, OUT, *([POWER] if POWER in series else [])]
    middles = series["start_s"].to_numpy() + 0.5 * block_s
    latest = max(steady_window(middles, series[name].to_numpy()).start for name in names)
    return _judged(series[middles >= min(latest, middles[-FEWEST_BLOCKS])], block_s, tolerance)


def _block_series(table: pd.DataFrame, block_s: float) -> pd.DataFrame:
    """Return a row per block: start_s, rates of INSERTED and OUT in kg/s, means of HELD and of the powers in W."""
    missing = [name for name in (TIME, HELD, INSERTED, OUT) if name not in table]
    if missing:
        raise ValueError(f"the flow table has no column {missing[0]}, allowed is one with {TIME} to {OUT}")
    time = table[TIME].to_numpy(float)
    apart = np.diff(time)
    if not (apart > 0.0).all():
        at = time[1:][~(apart > 0.0)][0]
        raise ValueError(f"the flow table goes back at {TIME} {at:g}, allowed are times that increase")
    if not block_s >= apart.max(initial=0.0) * (1.0 - ROUNDING) or not block_s > 0.0:
        raise ValueError(
            f"the flow table has rows {apart.max(initial=0.0):g} s apart and blocks of {block_s:g} s, allowed are"
            " blocks that are as long or longer"
        )
    count = int((time[-1] - time[0]) / block_s + ROUNDING) if len(time) else 0
    borders = (time[-1] if len(time) else 0.0) - block_s * np.arange(count, -1, -1.0)
    powers = [name for name in table if name.startswith(POWER_PREFIX) and name.endswith(POWER_SUFFIX)]
    columns = {name: np.diff(np.interp(borders, time, table[name].to_numpy(float))) for name in (INSERTED, OUT)}
    for name in (HELD, *powers):
        sums = cumulative_trapezoid(table[name].to_numpy(float), time, initial=0.0)
        columns[name] = np.diff(np.interp(borders, time, sums))
    series = pd.DataFrame(columns) / block_s
    if powers:
        series[POWER] = series[powers].sum(axis=1)
    return series.assign(start_s=borders[:-1])


def _judged(series: pd.DataFrame, block_s: float, tolerance: float) -> SteadyFlow:
    blocks = len(series)
    start = float(series["start_s"].iloc[0]) if blocks else math.nan
    window = start, start + blocks * block_s, block_s, blocks, tolerance
    if blocks < FEWEST_BLOCKS:
        return SteadyFlow(*window)
    rate_in, rate_out = (mean_of_blocks(series[name]) for name in (INSERTED, OUT))
    larger = max(rate_in.value, rate_out.value)
    flows = larger > 0.0
    imbalance = mean_of_blocks((series[INSERTED] - series[OUT]) / larger) if flows else UNKNOWN
    parts = [name for name in series if name.startswith(POWER_PREFIX) and name.endswith(POWER_SUFFIX)]
    changes = {name: change_of_blocks(series[name]) for name in (HELD, *parts, *([POWER] if parts else []))}
    judged = {BALANCE: imbalance} if flows else {}
    if _takes_power(series):
        judged[POWER] = changes[POWER]
    if judged:
        judged[MASS] = changes[HELD]
    return SteadyFlow(
        *window,
        rate_in_kg_per_s=rate_in,
        rate_out_kg_per_s=rate_out,
        imbalance=imbalance,
        held_kg=float(series[HELD].mean()),
        held_change=changes[HELD],
        power_w=float(series[POWER].mean()) if parts else math.nan,
        power_change=changes.get(POWER, UNKNOWN),
        power_changes={name.removeprefix(POWER_PREFIX).removesuffix(POWER_SUFFIX): changes[name] for name in parts},
        answers={name: answer_on_change(found, tolerance) for name, found in judged.items()},
    )


def _takes_power(series: pd.DataFrame) -> bool:
    """Return whether the power is more than it fluctuates by: of a part that turns idle a change says nothing."""
    return POWER in series and bool(abs(series[POWER].mean()) > series[POWER].std(ddof=1))


def _with_interval(found: Estimate, unit: str, factor: float = 1.0) -> str:
    """Return a value with its interval."""
    if not found.known:
        return f"{factor * found.value:.3g} {unit} (scatter unknown)"
    low, high = (factor * end for end in found.interval())
    return f"{factor * found.value:.3g} {unit} ({100.0 * CONFIDENCE:.0f} % interval {low:.3g} to {high:.3g})"
