"""How particles of the lowest layer turn along the sample, from front to back (Yan 2022, Fig 4.21 and 4.22)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.flow.moving_bins import (
    ANGULAR_VELOCITY,
    AVERAGED_ANGULAR_VELOCITY,
    BETWEEN,
    MEAN_ANGULAR_SPEED,
    add_dumps,
    averaged_angular_velocity,
    interval_numbers,
)
from bulkwear.postproc.readers.dump_text import BLOCK_BYTES, FrameBatch

NEEDED = ("x", "y", "z", "omegax", "omegay", "omegaz")
MEANS = [*ANGULAR_VELOCITY, MEAN_ANGULAR_SPEED]  # of a piece, over its particles


@dataclass(frozen=True)
class Segments:
    """Pieces of the lowest layer over the sample, m; its middle is x = y = 0 and the bed passes in +y.

    width, length: of the sample, across and along the travel; layer_height: of the layer and, as nearly as whole pieces
    allow, the length of a piece (Yan 2022: both grow with the particle scale)
    """

    width: float
    length: float
    layer_height: float

    @property
    def count(self) -> int:
        """Return the number of pieces."""
        return max(round(self.length / self.layer_height), 1)

    def place(self, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Return the piece of each place (k,), 0 at the front, which meets the bed first; -1 outside."""
        share = y / self.length + 0.5
        inside = (np.abs(x) < 0.5 * self.width) & (z >= 0.0) & (z < self.layer_height) & (share >= 0.0) & (share < 1.0)
        return np.where(inside, (share * self.count).astype(int), -1)


def spin_along_sample(
    dumps: Iterable[tuple[str | Path, float]],
    segments: Segments,
    travel_per_step: float,
    interval: float,
    block_bytes: int = BLOCK_BYTES,
) -> pd.DataFrame:
    """Return how particles turn in every piece, by intervals of travel.

    Arguments as those of `moving_bins.bin_history`. Columns travel_end_m, segment (from 1, the front), along_m (of its
    middle behind the front edge), particles (sum over frames) and MEANS over them, NaN in an empty piece.
    """
    sums = SpinSums(segments, travel_per_step, interval)
    add_dumps(dumps, [sums], block_bytes)
    return sums.table()


class SpinSums:
    """Sums over the particles in every piece, by intervals of travel; arguments as for `spin_along_sample`."""

    needed = NEEDED

    def __init__(self, segments: Segments, travel_per_step: float, interval: float) -> None:
        self._segments, self._travel_per_step, self._interval = segments, travel_per_step, interval
        self._sums: dict[int, np.ndarray] = {}

    def add(self, batch: FrameBatch, offset: float) -> None:
        """Add frames whose step 0 is at a travel of offset (m)."""
        x, y, z, *omega = (batch.table[:, batch.columns.index(name)] for name in NEEDED)
        place, turning = self._segments.place(x, y, z), [*omega, np.linalg.norm(omega, axis=0)]
        numbers = interval_numbers(batch.steps, offset, self._travel_per_step, self._interval)
        interval = np.repeat(numbers, np.diff(batch.starts))
        for number in np.unique(numbers):
            chosen = (interval == number) & (place >= 0)
            weights = [*(each[chosen] for each in turning), None]
            counted = [np.bincount(place[chosen], weight, self._segments.count) for weight in weights]
            self._sums[int(number)] = self._sums.get(int(number), 0.0) + np.array(counted, dtype=float)

    def table(self) -> pd.DataFrame:
        """Return the means, see `spin_along_sample`."""
        count = self._segments.count
        along = (np.arange(count) + 0.5) * self._segments.length / count
        tables = []
        for number in sorted(self._sums):
            *turning, particles = self._sums[number]
            means = turning / np.where(particles > 0.0, particles, np.nan)
            table = {"segment": np.arange(1, count + 1), "along_m": along, "particles": particles}
            end = (number + 1) * self._interval
            tables.append(pd.DataFrame({"travel_end_m": end, **table, **dict(zip(MEANS, means, strict=True))}))
        return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame()


def mean_spin(history: pd.DataFrame, start: float) -> pd.DataFrame:
    """Return how particles turn, averaged over all travel from `start` (m) on, by piece.

    Columns segment, along_m, particles, averaged_angular_velocity_rad_per_s, see `averaged_angular_velocity`, and
    mean_angular_speed_rad_per_s, of the magnitudes.
    history: as from `spin_along_sample`, of one run or several cycles of it. Raises ValueError when nothing is left.
    """
    later = history[history["travel_end_m"] > start * (1.0 + BETWEEN)]
    if later.empty:
        raise ValueError(f"no interval after {start:g} m of travel, allowed is a start before the end of the travel")
    weighted = later[MEANS].mul(later["particles"], axis=0).fillna(0.0).join(later[["segment", "along_m", "particles"]])
    sums = weighted.groupby(["segment", "along_m"]).sum().reset_index()
    means = sums[MEANS].div(sums["particles"].where(sums["particles"] > 0.0), axis=0)
    return sums[["segment", "along_m", "particles"]].assign(
        **{AVERAGED_ANGULAR_VELOCITY: averaged_angular_velocity(means), MEAN_ANGULAR_SPEED: means[MEAN_ANGULAR_SPEED]}
    )
