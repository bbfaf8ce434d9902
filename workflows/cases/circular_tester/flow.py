"""Whether the flow in the circular wear tester is steady, and what it does from revolution to revolution.

A series has one row per instant: `run`, `surface`, `revolution` (-, since the bed began to turn) and measures such as
`velocity_m_per_s` and `bed_height_m` of the particles over the sample, `wear_rate_m3_per_s`,
`bottom_angular_speed_rad_per_s`, `bottom_velocity_m_per_s`, `normal_force_N`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from postproc.statistics.steady import FEWEST_VALUES, common_start, steady_window
from postproc.tables.summary import PLAIN

STEADINESS = ("velocity_m_per_s", "bed_height_m", "wear_rate_m3_per_s")  # the three criteria of Fig 6.7
WHOLE = 1e-6  # revolutions that an instant may lie before a whole one and belong to the next
FEWEST_INSTANTS = 3  # in a revolution, for a standard deviation that says anything


def revolution_numbers(revolution: np.ndarray) -> np.ndarray:
    """Number (k,) of the revolution that each instant lies in: the first one is 1."""
    return np.floor(np.asarray(revolution, dtype=float) + WHOLE).astype(np.int64) + 1


def revolution_means(series: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """Mean, standard deviation and coefficient of variation of measures in each revolution of each run.

    Columns: run, surface, revolution (its number), measure, mean, deviation, variation (deviation over mean, Yan 2022,
    Eq 6.1), instants. Revolutions of fewer than FEWEST_INSTANTS instants are left out.
    """
    number = pd.Series(revolution_numbers(series["revolution"]), index=series.index)
    long = series.assign(revolution=number).melt(["run", "surface", "revolution"], list(measures), "measure")
    grouped = long.dropna(subset="value").groupby(["run", "surface", "revolution", "measure"], sort=False)["value"]
    table = pd.DataFrame({"mean": grouped.mean(), "deviation": grouped.std(ddof=1), "instants": grouped.size()})
    table = table[table["instants"] >= FEWEST_INSTANTS]
    table.insert(2, "variation", table["deviation"] / table["mean"].abs())
    return table.reset_index()


def steady_revolutions(series: pd.DataFrame, measures: Sequence[str] = STEADINESS) -> pd.DataFrame:
    """From which revolution on each measure of each run is steady, by the same rule as elsewhere (`analysis.steady`).

    Columns: run, surface, measure, start (revolutions), mean, drift (-), steady; measure "all" has the latest start,
    NaN where one is not steady. Raises ValueError for a run of fewer instants than FEWEST_VALUES.
    """
    rows = []
    for (run, surface), of_run in series.groupby(["run", "surface"], sort=False):
        ordered = of_run.sort_values("revolution")
        if len(ordered) < FEWEST_VALUES:
            raise ValueError(f"run {run} has {len(ordered)} instants, allowed are {FEWEST_VALUES} or more")
        windows = {name: steady_window(ordered["revolution"], ordered[name]) for name in measures}
        rows += [
            {"run": run, "surface": surface, "measure": name, "start": window.start, "mean": window.mean}
            | {"drift": window.drift, "steady": window.steady}
            for name, window in windows.items()
        ]
        start = common_start(windows.values())
        common = {"start": start, "mean": np.nan, "drift": np.nan, "steady": bool(np.isfinite(start))}
        rows.append({"run": run, "surface": surface, "measure": "all"} | common)
    return pd.DataFrame(rows)


def relative_motion(particles: pd.DataFrame) -> pd.DataFrame:
    """Speeds of the particles of a layer over the mean of the plain sample's (Fig 6.19 and 6.20).

    particles: surface, x_m, y_m, radius_m, vx_m_per_s, vy_m_per_s, angular_speed_rad_per_s. Added: relative_speed and
    relative_angular_speed, -. Raises ValueError without a plain sample's particles.
    """
    speed = np.hypot(particles["vx_m_per_s"], particles["vy_m_per_s"])
    plain = particles["surface"] == PLAIN
    if not plain.any():
        raise ValueError("relative speeds need the particles over a plain sample, found none")
    return particles.assign(
        relative_speed=speed / speed[plain].mean(),
        relative_angular_speed=particles["angular_speed_rad_per_s"]
        / particles.loc[plain, "angular_speed_rad_per_s"].mean(),
    )
