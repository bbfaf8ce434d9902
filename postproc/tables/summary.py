"""One row per run: what a study's plots and regressions draw on."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.tables.packings import first_packings, relative_wear_of_settings

MEANS = ("mean_normal_force_N", "bed_over_floor_velocity")  # over time; the second where friction alone moves a bed
NAMES = dict.fromkeys(("run", "row", "setting", "surface"), str)
THROUGH = "through_nodes"  # at the end: nodes at which the local thickness is worn away
AT_THE_END = ("time_s", "travel_m", "carried_volume_m3", "largest_depth_m", "smallest_angle_deg")
SUMMED = (
    "worn_volume_m3",
    "base_worn_volume_m3",
    "pattern_worn_volume_m3",
    "applied_volume_m3",
    "sliding_work_J",
    "finnie_volume_m3",
)


def run_summary(wear: pd.DataFrame) -> dict[str, float]:
    """Return a run's totals (m3, J), its state at the end, mean normal force (N) and wear per metre (m3/m); where the
    floor's friction alone moves the bed also its mean velocity over the floor's (-), and how many nodes are worn
    through.

    wear: rows of wear.csv, cycle by cycle.
    """
    duration = np.diff(wear["time_s"], prepend=0.0)
    totals = {name: float(wear[name].sum()) for name in SUMMED}
    last = {name: float(wear[name].iloc[-1]) for name in AT_THE_END}
    return {
        "cycles": len(wear),
        **last,
        **totals,
        "worn_volume_per_metre_m3_per_m": totals["worn_volume_m3"] / last["travel_m"],
        **{name: float(np.average(wear[name], weights=duration)) for name in MEANS if name in wear},
        **({THROUGH: int(wear[THROUGH].iloc[-1])} if THROUGH in wear else {}),
        "largest_balance_error": float(wear["balance_error"].max()),
    }


def relative_wear(table: pd.DataFrame) -> pd.Series:
    """Return each run's Archard volume over that of the plain run of the same design row; NaN without one."""
    plain = table[table["surface"] == PLAIN].set_index("row")["worn_volume_m3"]
    return table["worn_volume_m3"] / table["row"].map(plain)


def totals_of_runs(design: str | Path, wear_files: Sequence[str | Path]) -> pd.DataFrame:
    """Return the design table with the totals of every run; files in the order of the design's rows."""
    runs = pd.read_csv(design, keep_default_na=False, na_values=[""], dtype=NAMES)
    totals = pd.DataFrame([run_summary(pd.read_csv(path)) for path in wear_files])
    return pd.concat([runs, totals], axis=1)


def summary_table(design: str | Path, wear_files: Sequence[str | Path]) -> pd.DataFrame:
    """Return the totals of every run, and its wear over that of the plain run of its row."""
    table = totals_of_runs(design, wear_files)
    return table.assign(wear_over_plain=relative_wear(table))


def read_summary(path: str | Path) -> pd.DataFrame:
    """Return a study's summary.csv with names as text."""
    return read_named(path)


def read_named(path: str | Path, *further: str) -> pd.DataFrame:
    """Return a table whose columns of names are text, 01 and NA too; further: columns of text besides NAMES."""
    return pd.read_csv(path, dtype=NAMES | dict.fromkeys(further, str), keep_default_na=False, na_values=[""])


def patterned_name(surfaces: Iterable[str]) -> str:
    """Return the only one of some surfaces that is not plain, or what several are."""
    names = set(surfaces) - {PLAIN}
    return names.pop() if len(names) == 1 else "patterned"


def rows_to_show(summary: pd.DataFrame, most: int = 1) -> list[str]:
    """Return up to `most` design rows for figures that cannot show all, each the first packing of its setting: lowest
    relative wear first. Studies without plain runs show their first rows.
    """
    rows = dict(zip(*(first_packings(summary)[name] for name in ("setting", "row")), strict=True))
    best = relative_wear_of_settings(summary).sort_values("wear_over_plain", kind="stable")["setting"]
    return [rows[setting] for setting in dict.fromkeys([*best, *rows])][:most]


def runs_of_rows(summary: pd.DataFrame, rows: Sequence[str]) -> list[str]:
    """Return the runs of some design rows, in the order of the summary."""
    return summary.loc[summary["row"].isin(list(rows)), "run"].tolist()


def published_value(published: pd.DataFrame, quantity: str, of: str) -> float:
    """The value of a published quantity `of` laboratory or simulation, in the unit of the table.

    Raises ValueError when the table has none.
    """
    found = published[(published["quantity"] == quantity) & (published["of"] == of)]
    if len(found) != 1:
        raise ValueError(f"published '{quantity}' of '{of}' is there {len(found)} times, allowed is once")
    return float(found["value"].iloc[0])
