"""What the bed of a circular wear tester does from instant to instant and from revolution to revolution.

A series has one row per instant and measure, see `series_of`; its revolutions are counted since the bed began to turn.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.readers.cycle_folders import LAYER_TABLE, cycle_files, cycle_folders
from bulkwear.postproc.readers.solver_log import thermo_rows, thermo_table
from bulkwear.postproc.statistics.steady import FEWEST_VALUES, STEADY, UNSAID, Window, common_start, steady_window
from bulkwear.workflows.cases.circular_tester.packings import PACKING, over_packings
from bulkwear.workflows.cases.circular_tester.runs import LOG, TesterRun

STEADINESS = ("velocity_m_per_s", "bed_height_m", "wear_rate_m3_per_s")  # the three criteria of Fig 6.7
MILLIMETRES = 1e3  # per metre
WHOLE = 1e-6  # revolutions that an instant may lie before a whole one and belong to the next
FEWEST_INSTANTS = 3  # in a revolution, for a standard deviation that says anything
OF_RUN = ["run", "surface", PACKING]
# measures of Fig 6.17, 6.18 and 6.21
SPIN, VELOCITY, FORCE = "bottom_averaged_angular_velocity_rad_per_s", "bottom_velocity_m_per_s", "normal_force_N"
MEAN_SPIN = "bottom_mean_angular_speed_rad_per_s"  # of the particles' own magnitudes; stands beside it in tables


def revolution_numbers(revolution: np.ndarray) -> np.ndarray:
    """Number (k,) of the revolution that each instant lies in: the first one is 1."""
    return np.floor(np.asarray(revolution, dtype=float) + WHOLE).astype(np.int64) + 1


def revolution_means(series: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """Mean and coefficient of variation of measures in each revolution of each run.

    Columns: run, surface, packing, revolution (its number), measure, mean, variation (standard deviation over mean, Yan
    2022, Eq 6.1), instants. Revolutions of fewer than FEWEST_INSTANTS instants are left out.
    """
    number = pd.Series(revolution_numbers(series["revolution"]), index=series.index)
    keys = [*OF_RUN, "revolution"]
    long = series.assign(revolution=number).melt(keys, list(measures), "measure")
    grouped = long.dropna(subset="value").groupby([*keys, "measure"], sort=False)["value"]
    table = pd.DataFrame({"mean": grouped.mean(), "variation": grouped.std(ddof=1) / grouped.mean().abs()})
    table = table.assign(instants=grouped.size())
    return table[table["instants"] >= FEWEST_INSTANTS].reset_index()


def revolutions_over_packings(means: pd.DataFrame, value: str) -> pd.DataFrame:
    """Mean or variation of each revolution over the packings: surface, measure, revolution, value, and those of
    `over_packings`. means: as from `revolution_means`.
    """
    return over_packings(means, ["surface", "measure", "revolution"], value)


def steady_revolutions(series: pd.DataFrame, measures: Sequence[str] = STEADINESS) -> pd.DataFrame:
    """From which revolution on each measure of each run is steady, by the rule of `postproc.statistics.steady`.

    Columns: run, surface, packing, measure, start_revolutions, mean, drift_percent with drift_low_percent and
    drift_high_percent, answer; measure "all" has the latest start, NaN where one is not steady. Raises ValueError for a
    run of fewer instants than FEWEST_VALUES.
    """
    rows = []
    for key, of_run in series.groupby(OF_RUN, sort=False):
        ordered = of_run.sort_values("revolution")
        if len(ordered) < FEWEST_VALUES:
            raise ValueError(f"run {key[0]} has {len(ordered)} instants, allowed are {FEWEST_VALUES} or more")
        same = dict(zip(OF_RUN, key, strict=True))
        windows = {name: steady_window(ordered["revolution"], ordered[name]) for name in measures}
        rows += [same | {"measure": name} | _told(window) for name, window in windows.items()]
        start = common_start(windows.values())
        rows.append(
            same | {"measure": "all", "start_revolutions": start, "answer": STEADY if np.isfinite(start) else UNSAID}
        )
    return pd.DataFrame(rows)


def _told(window: Window) -> dict[str, float | str]:
    ends = {f"drift_{end}_percent": 100.0 * getattr(window, f"drift_{end}") for end in ("low", "high")}
    numbers = {"start_revolutions": window.start, "mean": window.mean, "drift_percent": 100.0 * window.drift}
    return numbers | ends | {"answer": window.answer}


def series_of(run: TesterRun) -> pd.DataFrame:
    """What a run does from instant to instant; the bed before it with a block in its place.

    Columns: run, surface, packing, revolution (of the bed), worn_revolution (of wear, below 0 before), and measures,
    each in rows of its own: velocity_m_per_s and bed_height_m of the particles over the sample, wear_rate_m3_per_s,
    normal_force_N, bottom_velocity_m_per_s, SPIN and MEAN_SPIN, see `layer.reduce_layer`.
    """
    run_in, *_ = cycle_folders(run.folder)
    parts = [_turning(run.bed_folder / LOG, run.bed_revolution_steps)]
    parts.append(_after(_running_in(run_in / LOG, run.revolution_steps), run.bed_revolutions))
    forces = _rows(run.folder, "forces.csv")
    over = {"velocity_over_m_per_s": "velocity_m_per_s", "height_over_m": "bed_height_m"}
    parts.append(_after(forces.rename(columns=over)[["revolution", *over.values()]], run.before))
    history = _rows(run.folder, "wear_history.csv")
    duration = np.diff(history["time_s"], prepend=0.0)
    middle = history["time_s"] - 0.5 * duration  # a stretch up to the end of a revolution belongs to it
    wear = pd.DataFrame({"revolution": middle / run.revolution_s})
    wear["wear_rate_m3_per_s"] = history["worn_volume_m3"] / duration
    wear["normal_force_N"] = history["mean_normal_force_N"]
    parts.append(_after(wear, run.before))
    parts.append(_after(lowest_layer(run.folder), run.before))
    table = pd.concat(parts, ignore_index=True)
    table.insert(0, "run", run.name)
    table.insert(1, "surface", run.surface)
    table.insert(2, PACKING, run.packing)
    return table.assign(worn_revolution=table["revolution"] - run.before)


def bed_in_use(run: TesterRun) -> dict[str, str | float]:
    """Return run, bed, and mass, level of the bed past the consolidator and height over the sample's middle (kg, mm)
    with the sample in it: over the run-in, before wear is counted.
    """
    thermo = thermo_rows(cycle_folders(run.folder)[0] / LOG)
    level, over = (MILLIMETRES * float(thermo[name].mean()) for name in ("level_h", "sample_h"))
    words = {"run": run.name, "bed": run.bed_folder.name, "mass_in_use_kg": float(thermo["bed_mass"][-1])}
    return words | {"level_in_use_mm": level, "over_sample_in_use_mm": over}


def lowest_layer(folder: Path) -> pd.DataFrame:
    """What the lowest layer of a run does by revolution: VELOCITY, SPIN and MEAN_SPIN.

    Raises ValueError for tables of an earlier version, which averaged otherwise.
    """
    layer = _rows(folder, LAYER_TABLE)
    bottom = {name.removeprefix("bottom_"): name for name in (VELOCITY, SPIN, MEAN_SPIN)}
    if missing := [name for name in bottom if name not in layer]:
        raise ValueError(
            f"{folder}: cycle_*/{LAYER_TABLE} has no column {missing[0]}, allowed are {', '.join(bottom)}; remove these"
            " tables and the run's wear.csv, and its cycles are simulated again."
        )
    return layer.rename(columns=bottom)[["revolution", *bottom.values()]]


def _after(table: pd.DataFrame, revolutions: float) -> pd.DataFrame:
    return table.assign(revolution=table["revolution"] + revolutions)


def _turning(path: Path, revolution_steps: int) -> pd.DataFrame:
    """What the bed does over the sample, from the last run of its log, which turns it, by revolution of that run."""
    thermo = thermo_table(path)
    thermo = thermo.of_rows(thermo["run"] == thermo["run"].max())
    return _over_sample(thermo, thermo["Step"] - thermo["Step"][0], revolution_steps).iloc[1:]  # first: no motion yet


def _running_in(path: Path, revolution_steps: int) -> pd.DataFrame:
    """The same from the log of a run-in, whose steps count from its start on, however many pieces it is of."""
    thermo = thermo_rows(path)
    return _over_sample(thermo, thermo["Step"], revolution_steps)


def _over_sample(thermo: Mapping[str, np.ndarray], step: np.ndarray, revolution_steps: int) -> pd.DataFrame:
    """Velocity and height of the bed over the sample, by revolution."""
    columns = {"velocity_m_per_s": thermo["sample_v"], "bed_height_m": thermo["sample_h"]}
    return pd.DataFrame({"revolution": step / revolution_steps, **columns})


def _rows(folder: Path, name: str) -> pd.DataFrame:
    """The rows of a table that every wear cycle has left."""
    return pd.concat([pd.read_csv(path) for path in cycle_files(folder, name)], ignore_index=True)


def flow_means(flow: pd.DataFrame) -> pd.DataFrame:
    """Spin and velocity of the lowest layer and normal force per revolution of wear, as from `revolution_means`."""
    worn = flow[flow["worn_revolution"] > 0.0]
    return revolution_means(worn.assign(revolution=worn["worn_revolution"]), (SPIN, MEAN_SPIN, VELOCITY, FORCE))
