"""What is measured on a run: wear gradients, relative wear, wear rate, the flow regime, and where flow and wear are
steady, beside the window of the source.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.steady import (
    FEWEST_VALUES,
    UNSAID,
    Window,
    common_start,
    steady_window,
    window_between,
)

RIDES_ALONG = 0.85  # -, relative velocity: half-way from the continuous runs' 70 % to 100 % (Yan 2022, section 3.5.1)
HEAPED = 1.0  # -, surcharge above which particles have accumulated over the sample
CONTINUOUS, DISCONTINUOUS, UNDECIDED = "continuous", "discontinuous", "undecided"
MEASURES = ("relative_velocity_percent", "relative_gradient")  # both must be steady (Yan 2022, section 3.4.3)
NAMES = ["run", "row", "surface"]


def wear_gradient(travel: np.ndarray, volume: np.ndarray) -> np.ndarray:
    """Return the wear gradient (k - 1,), volume over travel, between places of the travel (Yan 2022, Eq 3.9).

    travel: (k,) increasing; volume: (k,) worn since the start. Raises ValueError when the travel does not increase.
    """
    increments = np.diff(np.asarray(travel, dtype=float))
    if not (increments > 0.0).all():
        raise ValueError("the travel does not increase, allowed are increasing values")
    return np.diff(np.asarray(volume, dtype=float)) / increments


def gradient_history(history: pd.DataFrame) -> pd.DataFrame:
    """Return run, row, surface, travel_mm (middle), gradient_mm3_per_mm and relative_gradient of every run.

    history: as from `history.wear_within_cycles` or `history.wear_history`; each row is an increment. The relative
    gradient is that over the largest one of all runs (Yan 2022, Eq 3.8, 3.9); NaN where nothing was worn at all.
    """
    tables = []
    for (run, row, surface), one in history.groupby(["run", "row", "surface"], sort=False):
        travel, volume = one["travel_mm"].to_numpy(), one["worn_volume_mm3"].to_numpy()
        middle = 0.5 * (travel[1:] + travel[:-1])
        gradient = wear_gradient(travel, volume)
        names = {"run": run, "row": row, "surface": surface}
        tables.append(pd.DataFrame({**names, "travel_mm": middle, "gradient_mm3_per_mm": gradient}))
    table = pd.concat(tables, ignore_index=True)
    largest = table["gradient_mm3_per_mm"].max()
    return table.assign(relative_gradient=table["gradient_mm3_per_mm"] / (largest if largest > 0.0 else np.nan))


def relative_to_largest(volume: pd.Series, group: pd.Series) -> pd.Series:
    """Return the relative wear (-) of each run: its volume over the largest of its group (Yan 2022, Eq 3.10).

    group: what each run is compared with, such as its flow regime; patterned and plain runs together. Unlike wear over
    the plain twin's (`summary.relative_wear`), it compares runs of different conditions.
    """
    return volume / volume.groupby(group).transform("max")


def wear_rate(volume, velocity, thickness, width, bulk_density):
    """Return the wear per mass flow, m3/(kg/s), Yan 2022, Eq 3.11; the arguments are numbers or arrays.

    volume: m3; velocity: m/s; thickness, width: m, of the bed; bulk_density: kg/m3
    """
    return volume / (velocity * thickness * width * bulk_density)


def flow_regime(relative_velocity: float, surcharge: float) -> str:
    """Return the regime of the bed's flow over a sample, by its steady relative velocity and surcharge (-).

    continuous: particles pass, relative velocity below RIDES_ALONG
    discontinuous: particles ride along and have accumulated, surcharge above HEAPED
    undecided: they ride along without having accumulated, or a value is missing
    """
    if relative_velocity < RIDES_ALONG:
        return CONTINUOUS
    return DISCONTINUOUS if relative_velocity >= RIDES_ALONG and surcharge > HEAPED else UNDECIDED


def regime_table(relative_velocity: Mapping[str, float], surcharge: Mapping[str, float]) -> pd.DataFrame:
    """Return run, relative_velocity, surcharge and regime; values by run, NaN where there is none."""
    rows = [
        {
            "run": run,
            "relative_velocity": velocity,
            "surcharge": surcharge.get(run, np.nan),
            "regime": flow_regime(velocity, surcharge.get(run, np.nan)),
        }
        for run, velocity in relative_velocity.items()
    ]
    return pd.DataFrame(rows, columns=["run", "relative_velocity", "surcharge", "regime"])


# ---------------------------------------------------------------- steady windows


def steady_table(along: pd.DataFrame, gradients: pd.DataFrame, window: tuple[float, float]) -> pd.DataFrame:
    """Return a line per run and measure: its steady window and what it does in the source's.

    along: run, row, surface, travel_mm and relative_velocity_percent; gradients: with relative_gradient
    window: of the source, in mm of the study's travel

    Columns run, row, surface, measure; those of `steady.Window`, start and end in mm; steady, whether the answer is
    that it is; common_start_mm, from where on all measures of the run are steady, NaN if one is not shown to be;
    published_mean and published_deviation in the source's window, NaN where the travel does not fill it.
    """
    lines = []
    tables = [
        (table.groupby(NAMES, sort=False), name) for table, name in zip((along, gradients), MEASURES, strict=True)
    ]
    for groups, measure in tables:
        for names, one in groups:
            series = one["travel_mm"].to_numpy(), one[measure].to_numpy()
            lines.append({**dict(zip(NAMES, names, strict=True)), "measure": measure, **_line(*series, window)})
    table = pd.DataFrame(lines)
    return table.drop(columns="window").assign(common_start_mm=table["run"].map(_common_starts(table)))


def _line(travel: np.ndarray, measure: np.ndarray, window: tuple[float, float]) -> dict[str, object]:
    found = steady_window(travel, measure) if np.isfinite(measure).sum() >= FEWEST_VALUES else None
    beside = window_between(travel, measure, *window) if len(travel) else None
    line = {each.name: float("nan") for each in fields(Window)} | {"values": len(measure), "answer": UNSAID}
    line |= (asdict(found) if found else {}) | {"steady": found is not None and found.steady}
    return {
        **{f"{name}_mm" if name in ("start", "end") else name: value for name, value in line.items()},
        "published_mean": beside.mean if beside else float("nan"),
        "published_deviation": beside.deviation if beside else float("nan"),
        "window": found,
    }


def _common_starts(table: pd.DataFrame) -> dict[str, float]:
    """Return from where on both measures of each run are steady; a measure of too few values is not."""
    starts = {}
    for run, windows in table.groupby("run", sort=False)["window"]:
        found: list[Window] = [each for each in windows if isinstance(each, Window)]
        starts[str(run)] = common_start(found) if len(found) == len(MEASURES) else float("nan")
    return starts
