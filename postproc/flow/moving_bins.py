"""Bins that travel with the sample: mean motion of the particles over it, beside it, ahead and behind, by layers.

The sample rests in the deck's axes and the bed passes in +y, so bins that travel with the sample stand still. Central
and side bins are those of Yan 2022, Fig 3.9; ahead is where the sample is going, against the bed's motion.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
import pandas as pd

from bulkwear.postproc.readers.dump_text import BLOCK_BYTES, FrameBatch, read_frames

ZONES = ("central", "side", "ahead", "behind")
VELOCITY = tuple(f"velocity_{axis}_m_per_s" for axis in "xyz")
ANGULAR_VELOCITY = tuple(f"angular_velocity_{axis}_rad_per_s" for axis in "xyz")
AVERAGED_ANGULAR_VELOCITY, MEAN_ANGULAR_SPEED = "averaged_angular_velocity_rad_per_s", "mean_angular_speed_rad_per_s"
QUANTITIES = (*VELOCITY, *ANGULAR_VELOCITY, MEAN_ANGULAR_SPEED)
NEEDED = ("x", "y", "z", "vx", "vy", "vz", "omegax", "omegay", "omegaz")
BETWEEN = 1e-6  # -, of an interval: a frame so near to its start belongs to the one before


@dataclass(frozen=True)
class MovingBins:
    """Where the bins are (m). The sample's middle is x = y = 0; layers count from 1 at `floor` upwards.

    width, length: of the sample, across and along the travel; side_width: of the side bins on either side of it
    layer_height, layers: of the layers; what is above the last one or below the floor is in no bin
    """

    width: float
    length: float
    side_width: float
    layer_height: float
    layers: int
    floor: float = 0.0

    def zone(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the position in ZONES of each place (k,), -1 outside. Ahead and behind are as long as the sample."""
        across, along = np.abs(x) / (0.5 * self.width), y / (0.5 * self.length)
        beside = (np.abs(x) < 0.5 * self.width + self.side_width) & (np.abs(along) < 1.0)
        zones = np.where(beside, ZONES.index("side"), -1)
        over = across < 1.0
        zones[over & (np.abs(along) < 1.0)] = ZONES.index("central")
        zones[over & (along <= -1.0) & (along > -3.0)] = ZONES.index("ahead")
        zones[over & (along >= 1.0) & (along < 3.0)] = ZONES.index("behind")
        return zones

    def bin(self, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Return the bin of each place (k,), zone by zone and layer by layer from 0, -1 outside."""
        zone, layer = self.zone(x, y), np.floor((z - self.floor) / self.layer_height).astype(int)
        return np.where((zone >= 0) & (layer >= 0) & (layer < self.layers), zone * self.layers + layer, -1)

    @property
    def count(self) -> int:
        """Return the number of bins."""
        return len(ZONES) * self.layers


def bin_history(
    dumps: Iterable[tuple[str | Path, float]],
    bins: MovingBins,
    travel_per_step: float,
    interval: float,
    block_bytes: int = BLOCK_BYTES,
) -> pd.DataFrame:
    """Return the motion in every bin, averaged over intervals of travel, from particle dumps.

    dumps: files of `dump custom` with one frame or more, each with the travel (m) at its step 0
    travel_per_step: m, velocity times time step; interval: m, length of travel that is averaged; a frame at its end
        belongs to it
    block_bytes: bytes of a dump read at a time. Memory: a few times that or the largest frame, whatever the number of
        frames, and the sums of bins times intervals.

    Columns travel_start_m and travel_end_m of the interval, zone, layer, height_m (its middle above the floor), frames,
    particles (mean number in a frame) and means over all particles of all frames, in the deck's axes: VELOCITY,
    ANGULAR_VELOCITY and mean_angular_speed_rad_per_s, of the magnitudes. Side bins at -x are mirrored before they are
    put together with those at +x, so that x is outwards, away from the sample, and what turns alike on both sides does
    not cancel. NaN in a bin that stayed empty. Intervals without a frame are left out.

    Raises ContactDumpError for a damaged dump, ValueError for one without the columns that are needed.
    """
    sums = BinSums(bins, travel_per_step, interval)
    add_dumps(dumps, [sums], block_bytes)
    return sums.table()


class Sums(Protocol):
    """What batches of frames of a dump are added to; needed: columns of the dump."""

    needed: Sequence[str]

    def add(self, batch: FrameBatch, offset: float) -> None:
        """Add frames whose step 0 is at a travel of offset (m)."""


def add_dumps(dumps: Iterable[tuple[str | Path, float]], sums: Sequence[Sums], block_bytes: int = BLOCK_BYTES) -> None:
    """Read dumps once, in pieces, and add them to all sums; arguments and errors as for `bin_history`."""
    needed = list(dict.fromkeys(name for each in sums for name in each.needed))
    for path, offset in dumps:
        for batch in read_frames(path, "ATOMS", ("id",), block_bytes):
            _check_columns(path, batch, needed)
            for each in sums:
                each.add(batch, offset)


def interval_numbers(steps: np.ndarray, offset: float, travel_per_step: float, interval: float) -> np.ndarray:
    """Return the interval of travel (f,), from 0, of every frame; one at the end of an interval belongs to it."""
    passed = np.ceil((offset + steps * travel_per_step) / interval - BETWEEN)
    return np.maximum(passed - 1.0, 0.0).astype(int)


class BinSums:
    """Sums over the particles in every bin, by intervals of travel; arguments as for `bin_history`."""

    needed = NEEDED

    def __init__(self, bins: MovingBins, travel_per_step: float, interval: float) -> None:
        self._bins, self._travel_per_step, self._interval = bins, travel_per_step, interval
        self._sums: dict[int, np.ndarray] = {}
        self._frames: dict[int, int] = {}

    def add(self, batch: FrameBatch, offset: float) -> None:
        """Add frames whose step 0 is at a travel of offset (m)."""
        which = interval_numbers(batch.steps, offset, self._travel_per_step, self._interval)
        _add(batch, which, self._bins, self._sums)
        for number in which:
            self._frames[number] = self._frames.get(number, 0) + 1

    def table(self) -> pd.DataFrame:
        """Return the means, see `bin_history`."""
        tables = [
            _interval_table(number, self._sums[number], self._frames[number], self._bins, self._interval)
            for number in sorted(self._frames)
        ]
        return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame()


def _check_columns(path: str | Path, batch: FrameBatch, needed: Sequence[str]) -> None:
    missing = [name for name in needed if name not in batch.columns]
    if missing:
        raise ValueError(f"{path}, line 9: column {missing[0]} is missing, allowed is a dump with {' '.join(needed)}.")


def _add(batch: FrameBatch, which: np.ndarray, bins: MovingBins, sums: dict[int, np.ndarray]) -> None:
    """Add a batch of frames to the sums (quantities + 1, bins) of their intervals, the number of particles last."""
    column = {name: batch.table[:, batch.columns.index(name)] for name in NEEDED}
    place = bins.bin(column["x"], column["y"], column["z"])
    inside = place >= 0
    numbers, position = np.unique(which, return_inverse=True)
    slot = np.repeat(position, np.diff(batch.starts))[inside] * bins.count + place[inside]
    side = place // bins.layers == ZONES.index("side")
    mirrored = np.where(side, np.sign(column["x"]), 1.0)  # in x = 0: vx, and of an axial vector what is not along x
    omega = np.stack([column["omegax"], mirrored * column["omegay"], mirrored * column["omegaz"]])
    values = (mirrored * column["vx"], column["vy"], column["vz"], *omega)
    values = (*values, np.linalg.norm(omega, axis=0), np.ones(len(place)))
    size = len(numbers) * bins.count
    added = np.stack([np.bincount(slot, value[inside], size) for value in values])
    added = added.reshape(len(values), len(numbers), bins.count)
    for k, number in enumerate(numbers):
        sums[number] = sums.get(number, 0.0) + added[:, k]


def _interval_table(number: int, sums: np.ndarray, frames: int, bins: MovingBins, interval: float) -> pd.DataFrame:
    layer = np.tile(np.arange(bins.layers), len(ZONES))
    with np.errstate(invalid="ignore"):
        means = sums[:-1] / np.where(sums[-1] > 0.0, sums[-1], np.nan)
    return pd.DataFrame(
        {
            "travel_start_m": number * interval,
            "travel_end_m": (number + 1) * interval,
            "zone": np.repeat(ZONES, bins.layers),
            "layer": layer + 1,
            "height_m": (layer + 0.5) * bins.layer_height,
            "frames": frames,
            "particles": sums[-1] / frames,
            **dict(zip(QUANTITIES, means, strict=True)),
        }
    )


def merged_bins(history: pd.DataFrame, by: list[str]) -> pd.DataFrame:
    """Return bins put together: for each group of `by` the particles of a frame and the means over all particles.

    history: as from `bin_history`. Particles of layers and zones add up, those of intervals are averaged over frames.
    """
    sums = _sums(history, by)
    frames = history[list(dict.fromkeys([*by, "travel_start_m", "frames"]))].drop_duplicates()
    return _means(sums, frames.groupby(by, sort=False)["frames"].sum()).reset_index()


def joined(histories: Iterable[pd.DataFrame]) -> pd.DataFrame:
    """Return bin histories of consecutive wear cycles as one; an interval that two of them share is averaged."""
    table = pd.concat(list(histories), ignore_index=True)
    place = ["travel_start_m", "travel_end_m", "zone", "layer", "height_m"]
    frames = table.groupby(place, sort=False)["frames"].sum()
    means = _means(_sums(table, place), frames)
    means.insert(0, "frames", frames)
    return means.reset_index()


def _sums(history: pd.DataFrame, by: list[str]) -> pd.DataFrame:
    """Return the sums of all quantities over the particles of all frames, and their number, per group."""
    number = history["particles"] * history["frames"]
    sums = history[list(QUANTITIES)].mul(number, axis=0).fillna(0.0)
    return pd.concat([history[by], sums.assign(number=number)], axis=1).groupby(by, sort=False).sum()


def _means(sums: pd.DataFrame, frames: pd.Series) -> pd.DataFrame:
    """Return the particles of a frame and the means over all particles, NaN where there are none."""
    means = sums[list(QUANTITIES)].div(sums["number"].where(sums["number"] > 0.0), axis=0)
    means.insert(0, "particles", sums["number"] / frames)
    return means


def averaged_angular_velocity(means: pd.DataFrame) -> np.ndarray:
    """Return the magnitude (rad/s) of the averaged angular velocity: components are averaged first.

    means: ANGULAR_VELOCITY, averaged over particles. This is what the source draws: "the magnitude of the averaged
    angular velocity" (Yan 2022, section 3.5.3.3). It tells how fast a bed rolls as a whole; particles that turn about
    all axes alike have none, however fast they turn, which is what the mean of the magnitudes tells. It is at most that
    mean. Over n particles with independent spins it is by chance about their root mean square over the root of n.
    """
    return np.linalg.norm(means[list(ANGULAR_VELOCITY)].to_numpy(dtype=float), axis=1)


def relative_velocity_history(history: pd.DataFrame, bed_velocity: float, bed_thickness: float) -> pd.DataFrame:
    """Return travel_m (middle of the interval) and relative_velocity (-) of the particles over the sample.

    Relative velocity: mean velocity with the sample, seen from the bed at rest, over the sample's (Yan 2022, Eq 3.7):
    0 for a bed that lets the sample pass, 1 for particles that ride along. Central bins inside the original bed.

    bed_velocity: m/s, of the bed past the sample; bed_thickness: m. Layers count whose middle is inside the bed.
    """
    central = history[(history["zone"] == "central") & (history["height_m"] < bed_thickness)]
    means = merged_bins(central, ["travel_start_m", "travel_end_m"])
    return pd.DataFrame(
        {
            "travel_m": 0.5 * (means["travel_start_m"] + means["travel_end_m"]),
            "relative_velocity": relative_velocity(means["velocity_y_m_per_s"].to_numpy(), bed_velocity),
        }
    )


def relative_velocity(velocity: np.ndarray, bed_velocity: float) -> np.ndarray:
    """Return the relative velocity (-, Yan 2022, Eq 3.7) of velocities (m/s) along the travel in the sample's frame."""
    return 1.0 - np.asarray(velocity, dtype=float) / bed_velocity


def surcharge_history(history: pd.DataFrame, undisturbed: float, zone: str = "central") -> pd.DataFrame:
    """Return travel_m and surcharge (-): particles over a zone, all layers, over those of the undisturbed bed there.

    undisturbed: particles of the bed on an area as large as the zone, before the sample comes
    """
    counts = merged_bins(history[history["zone"] == zone], ["travel_start_m", "travel_end_m"])
    middle = 0.5 * (counts["travel_start_m"] + counts["travel_end_m"])
    return pd.DataFrame({"travel_m": middle, "surcharge": counts["particles"] / undisturbed})


def velocity_profile(history: pd.DataFrame, bed_velocity: float, start: float, end: float) -> pd.DataFrame:
    """Return the profile of the motion by layer over a window of travel (m), seen from the bed at rest.

    Columns zone, layer, height_m, particles, velocity_m_per_s (v_y of Yan 2022: with the sample), sideways_ratio
    (v_x / v_y, outwards in side bins), upward_ratio (v_z / v_y), averaged_angular_velocity_rad_per_s (Yan 2022, Fig
    3.19 to 3.22), see `averaged_angular_velocity`, and mean_angular_speed_rad_per_s. Averages are over the particles of
    all frames of the window. Intervals count that lie inside it; raises ValueError when there is none.
    """
    slack = BETWEEN * max(abs(end), 1.0)
    inside = history[(history["travel_start_m"] >= start - slack) & (history["travel_end_m"] <= end + slack)]
    if inside.empty:
        raise ValueError(f"no interval between {start:g} and {end:g} m of travel, allowed is a window that holds one")
    table = merged_bins(inside, ["zone", "layer", "height_m"])
    with_sample = bed_velocity - table["velocity_y_m_per_s"]
    return pd.DataFrame(
        {
            **{name: table[name] for name in ("zone", "layer", "height_m", "particles")},
            "velocity_m_per_s": with_sample,
            "sideways_ratio": table["velocity_x_m_per_s"] / with_sample,
            "upward_ratio": table["velocity_z_m_per_s"] / with_sample,
            AVERAGED_ANGULAR_VELOCITY: averaged_angular_velocity(table),
            MEAN_ANGULAR_SPEED: table[MEAN_ANGULAR_SPEED],
        }
    )
