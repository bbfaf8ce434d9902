"""Runs of a study against each other: convex over plain, base against bumps, one wear law against another."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from postproc.tables.display import in_display_units
from postproc.tables.summary import PLAIN


def plain_of_row(summary: pd.DataFrame, column: str) -> pd.Series:
    """Return, for each run, a column's value of the plain run of the same design row; NaN without one."""
    plain = summary[summary["surface"] == PLAIN].set_index("row")[column]
    return summary["row"].map(plain)


def wear_split(summary: pd.DataFrame) -> pd.DataFrame:
    """Return each run's wear on base and on bumps over the wear of the plain run of its row.

    Columns run, row, surface, base_volume_mm3, bump_volume_mm3, base_over_plain, bump_over_plain.
    """
    plain = plain_of_row(summary, "archard_volume_m3")
    table = summary[["run", "row", "surface"]].assign(
        base_volume_m3=summary["base_archard_volume_m3"],
        bump_volume_m3=summary["bump_archard_volume_m3"],
        base_over_plain=summary["base_archard_volume_m3"] / plain,
        bump_over_plain=summary["bump_archard_volume_m3"] / plain,
    )
    return in_display_units(table)


def law_comparison(summary: pd.DataFrame) -> pd.DataFrame:
    """Return each run's volume by Archard and by the solver's own Finnie, and their ratio."""
    table = summary[["run", "row", "surface", "archard_volume_m3", "finnie_volume_m3"]]
    ratio = summary["finnie_volume_m3"] / summary["archard_volume_m3"]
    return in_display_units(table.assign(finnie_over_archard=ratio))


def cycle_ratios(history: pd.DataFrame) -> pd.DataFrame:
    """Return row, surface, lowest and highest ratio to the plain run over the single cycles of each run.

    history: as from `wear_history`; where the plain run has cycles of other lengths, its volume is interpolated along
    the travel. The range shows the scatter along the travel, not an uncertainty of the mean.
    """
    plain = {row: table for row, table in history[history["surface"] == PLAIN].groupby("row", sort=False)}
    rows = []
    for (row, surface), run in history[history["surface"] != PLAIN].groupby(["row", "surface"], sort=False):
        if row not in plain:
            continue
        twin = np.interp(run["travel_mm"], plain[row]["travel_mm"], plain[row]["archard_volume_mm3"])
        ratio = np.diff(run["archard_volume_mm3"]) / np.diff(twin)
        rows.append(
            {"row": row, "surface": surface, "lowest_cycle_ratio": ratio.min(), "highest_cycle_ratio": ratio.max()}
        )
    return pd.DataFrame(rows, columns=["row", "surface", "lowest_cycle_ratio", "highest_cycle_ratio"])


def relative_wear_table(
    summary: pd.DataFrame, history: pd.DataFrame, size_ratios: Mapping[str, float | None]
) -> pd.DataFrame:
    """Return row, surface, wear_over_plain, range over cycles and alpha_ER of every run that is not plain.

    size_ratios: alpha_ER by run (Yan 2022, Eq 4.18). Rows in the order of the design.
    """
    table = summary[summary["surface"] != PLAIN][["run", "row", "surface", "wear_over_plain"]]
    ratios = [size_ratios.get(run) for run in table["run"]]
    table = table.assign(equivalent_size_ratio=np.array(ratios, dtype=float))
    return table.merge(cycle_ratios(history), on=["row", "surface"], how="left")
