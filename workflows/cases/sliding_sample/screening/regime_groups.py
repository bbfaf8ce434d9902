"""Runs of a screening study by flow regime: wear gradient, relative wear and normal force, as the source groups them.

A design row is in the group of its patterned run's regime, its plain twin with it (Yan 2022, Fig 3.12, 3.13 and 3.16).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.postproc.tables.packings import BY, over_packings
from bulkwear.postproc.tables.summary import rows_to_show
from bulkwear.workflows.cases.sliding_sample.evaluation import (
    CONTINUOUS,
    DISCONTINUOUS,
    UNDECIDED,
    gradient_history,
    relative_to_largest,
    wear_rate,
)

PUBLISHED_IN_DETAIL = ("R5", "R2")  # of least wear in continuous and in discontinuous flow (Yan 2022, Fig 3.14 on)
ORDER = (CONTINUOUS, DISCONTINUOUS, UNDECIDED)
PARTS = ("base_relative_wear", "bump_relative_wear")


def groups_of_rows(regimes: pd.DataFrame) -> pd.Series:
    """Return the regime of each design row, that of the patterned runs of all packings of its setting, of its plain
    runs where it has no other ones; index: row. Packings that flow in different regimes are UNDECIDED together.

    regimes: run, row, setting, surface and regime, as from `flow_history.flow_tables`.
    """
    patterned = regimes["surface"] != PLAIN
    alone = ~regimes["setting"].isin(regimes.loc[patterned, "setting"])
    runs = regimes[patterned | alone]
    found = runs.groupby("setting")["regime"]
    shared = runs["regime"].where(found.transform("nunique") == 1, UNDECIDED)
    return runs.assign(regime=shared).drop_duplicates("row").set_index("row")["regime"]


def by_group(table: pd.DataFrame, regimes: pd.DataFrame) -> pd.DataFrame:
    """Return a table with column row as one with the column regime of the row's group, groups in ORDER; rows that
    `regimes` does not have are undecided.
    """
    group = groups_of_rows(regimes)
    table = table.assign(regime=[group.get(row, UNDECIDED) for row in table["row"]])
    return table.sort_values("regime", key=lambda name: name.map(ORDER.index), kind="stable")


def gradients_by_group(history: pd.DataFrame, regimes: pd.DataFrame) -> pd.DataFrame:
    """Return the relative wear gradient of every run along its travel with its group (Yan 2022, Eq 3.8, Fig 3.12).

    history: as from `history.wear_history`; columns as from `evaluation.gradient_history`, and regime.
    """
    return by_group(gradient_history(history), regimes)


def wear_by_group(
    summary: pd.DataFrame, regimes: pd.DataFrame, beds: Mapping[str, Mapping[str, float]]
) -> pd.DataFrame:
    """Return the wear of each setting and surface by group, with packings and interval.

    beds: arguments of `evaluation.wear_rate` besides the volume, by run
    Columns setting, surface, regime, relative_wear (-, Yan 2022, Eq 3.10), which is wear per metre over the largest of
    the group, with its parts base_relative_wear and bump_relative_wear, and wear_rate_mm3_s_per_kg (Eq 3.11).
    """
    table = by_group(summary, regimes)
    volume, travel = table["worn_volume_m3"], table["travel_m"]
    passing = pd.DataFrame([beds[run] for run in table["run"]], index=table.index)
    table = table[[*BY, "regime"]].assign(
        relative_wear=volume / travel,
        base_relative_wear=table["base_worn_volume_m3"] / travel,
        bump_relative_wear=table["pattern_worn_volume_m3"] / travel,
        wear_rate_mm3_s_per_kg=wear_rate(CUBIC_MILLIMETRES * volume, **passing),
    )
    found = over_packings(table, "relative_wear", parts=PARTS)
    names = ["relative_wear", *PARTS, "interval_low", "interval_high"]
    scale = relative_to_largest(found["relative_wear"], found["regime"]) / found["relative_wear"]
    return found.assign(**found[names].mul(scale, axis="index"))


def force_by_group(summary: pd.DataFrame, regimes: pd.DataFrame) -> pd.DataFrame:
    """Return setting, surface, regime and mean_normal_force_N with packings and interval (Yan 2022, Fig 3.16)."""
    table = by_group(summary, regimes)[[*BY, "regime", "mean_normal_force_N"]]
    return over_packings(table, "mean_normal_force_N")


def rows_in_detail(
    summary: pd.DataFrame, regimes: pd.DataFrame, preferred: Sequence[str] = (), most: int = 2
) -> list[str]:
    """Return up to `most` design rows that are shown in detail, first packings of their settings: preferred ones, then
    the lowest relative wear of each regime, then the lowest of all.
    """
    group = groups_of_rows(regimes)
    ranked = [row for row in rows_to_show(summary, len(summary)) if row in group.index]
    lowest = [next((row for row in ranked if group[row] == regime), None) for regime in ORDER]
    chosen = [*(row for row in preferred if row in ranked), *(row for row in lowest if row), *ranked]
    return list(dict.fromkeys(chosen))[:most]


def of_published_rows(published: pd.DataFrame, rows: Mapping[str, str]) -> pd.DataFrame:
    """Return a published table (column row) under the names of a study's rows; its other rows are left out.

    rows: {row of the study: published row of the same factors}; several rows may have the same.
    """
    tables = [published[published["row"] == theirs].assign(row=ours) for ours, theirs in rows.items()]
    return pd.concat(tables, ignore_index=True) if tables else published[:0]


def published_relative_wear(results: pd.DataFrame, rows: Mapping[str, str]) -> pd.DataFrame:
    """Return row (a study's), relation, value (-) and source of published wear over the plain sample's.

    results: quantity, of, relation, value (percent) and source; rows: {row of the study: published row}
    """
    wear = results[results["quantity"] == "wear_over_plain"].rename(columns={"of": "row"})
    wear = wear.assign(value=wear["value"].astype(float) / 100.0)
    return of_published_rows(wear, rows)[["row", "relation", "value", "source"]]


def published_rows_in_detail(rows: Mapping[str, str]) -> list[str]:
    """Return the rows of a study that have the factors of those which the source shows in detail, in its order.

    rows: {row of the study: published row of the same factors}
    """
    return [ours for wanted in PUBLISHED_IN_DETAIL for ours, theirs in rows.items() if theirs == wanted]


def regime_remarks(regimes: pd.DataFrame) -> list[str]:
    """Return what figures by regime must say where the flow is not steady; regimes: with steady of every run."""
    unsteady = int((~regimes["steady"].astype(bool)).sum())
    return [f"regimes of {unsteady} of {len(regimes)} runs are of a flow not shown to be steady"] if unsteady else []
