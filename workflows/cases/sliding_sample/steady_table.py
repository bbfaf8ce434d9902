"""Where every run of a study is steady, by its flow and by its wear, beside the window of the source."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pandas as pd

from postproc.statistics.steady import FEWEST_VALUES, Window, common_start, steady_window, window_between

MEASURES = ("relative_velocity_percent", "relative_gradient")  # both must be steady (Yan 2022, section 3.4.3)
NAMES = ["run", "row", "surface"]


def steady_table(along: pd.DataFrame, gradients: pd.DataFrame, window: tuple[float, float]) -> pd.DataFrame:
    """Return a line per run and measure: its steady window and what it does in the source's.

    along: run, row, surface, travel_mm and relative_velocity_percent; gradients: with relative_gradient
    window: of the source, in mm of the study's travel

    Columns run, row, surface, measure, start_mm, end_mm, mean, deviation, drift (-), values and steady;
    common_start_mm, from where on all measures of the run are steady, NaN if one is not; published_mean and
    published_deviation in the source's window, NaN where the travel does not fill it.
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
    line = dict.fromkeys(("start", "end", "mean", "deviation", "drift"), float("nan")) | {"values": len(measure)}
    line |= {"steady": False} | (asdict(found) if found else {})
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
