"""Runs of a screening study by flow regime: wear gradient, relative wear and normal force, as the source groups them.

A design row is in the group of its patterned run's regime, its plain twin with it (Yan 2022, Fig 3.12, 3.13 and 3.16).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.readers.cycle_folders import cycle_files
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
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
FEWEST_STRETCHES = 3  # of travel, of a run that has a deviation along it


def groups_of_rows(regimes: pd.DataFrame) -> pd.Series:
    """Return the regime of each design row, that of its patterned run; index: row.

    regimes: run, row, surface and regime, as from `flow_history.flow_tables`.
    """
    return regimes[regimes["surface"] != PLAIN].drop_duplicates("row").set_index("row")["regime"]


def by_group(table: pd.DataFrame, regimes: pd.DataFrame) -> pd.DataFrame:
    """Return a table with column row as one with the column regime of the row's group, groups in ORDER; rows without
    a patterned run are undecided.
    """
    group = groups_of_rows(regimes)
    table = table.assign(regime=[group.get(row, UNDECIDED) for row in table["row"]])
    return table.sort_values("regime", key=lambda name: name.map(ORDER.index), kind="stable")


def gradients_by_group(history: pd.DataFrame, regimes: pd.DataFrame) -> pd.DataFrame:
    """Return the relative wear gradient of every run along its travel with its group (Yan 2022, Eq 3.8, Fig 3.12).

    history: as from `history.wear_history`; columns as from `evaluation.gradient_history`, and regime.
    """
    return by_group(gradient_history(history), regimes)


def wear_by_group(summary: pd.DataFrame, regimes: pd.DataFrame) -> pd.DataFrame:
    """Return run, row, surface, regime and relative_wear (Yan 2022, Eq 3.10), and its parts base_relative_wear and
    bump_relative_wear, of every run (-): wear per metre over the largest of its group.
    """
    table = by_group(summary, regimes)
    per_metre = table["worn_volume_m3"] / table["travel_m"]
    relative = relative_to_largest(per_metre, table["regime"])
    parts = {
        f"{name}_relative_wear": relative * table[f"{part}_worn_volume_m3"] / table["worn_volume_m3"]
        for name, part in (("base", "base"), ("bump", "pattern"))
    }
    return table[["run", "row", "surface", "regime"]].assign(relative_wear=relative, **parts).reset_index(drop=True)


def with_wear_rates(
    table: pd.DataFrame, summary: pd.DataFrame, beds: Mapping[str, Mapping[str, float]]
) -> pd.DataFrame:
    """Return a table of runs with wear_rate_mm3_s_per_kg, wear of the whole travel over the flow of mass (Yan 2022,
    Eq 3.11); beds: arguments of `evaluation.wear_rate` besides the volume, by run.
    """
    volume = CUBIC_MILLIMETRES * table["run"].map(summary.set_index("run")["worn_volume_m3"])
    passing = pd.DataFrame([beds[run] for run in table["run"]], index=table.index)
    return table.assign(wear_rate_mm3_s_per_kg=wear_rate(volume, **passing))


def force_by_group(summary: pd.DataFrame, run_folders: Sequence[str | Path], regimes: pd.DataFrame) -> pd.DataFrame:
    """Return the normal force on every run by group (Yan 2022, Fig 3.16).

    Columns run, row, surface, regime, mean_normal_force_N and its deviation_N between stretches of travel, NaN with
    fewer than FEWEST_STRETCHES. run_folders: with cycle_*/wear_history.csv, in the order of the summary.
    """
    forces = [_stretch_forces(Path(folder)) for folder in run_folders]
    deviation = [one.std(ddof=1) if len(one) >= FEWEST_STRETCHES else float("nan") for one in forces]
    table = summary[["run", "row", "surface", "mean_normal_force_N"]].assign(deviation_N=deviation)
    return by_group(table, regimes)[["run", "row", "surface", "regime", "mean_normal_force_N", "deviation_N"]]


def _stretch_forces(folder: Path) -> pd.Series:
    files = cycle_files(folder, "wear_history.csv")
    return pd.concat([pd.read_csv(path)["mean_normal_force_N"] for path in files]) if files else pd.Series(dtype=float)


def rows_in_detail(
    summary: pd.DataFrame, regimes: pd.DataFrame, preferred: Sequence[str] = (), most: int = 2
) -> list[str]:
    """Return up to `most` design rows that are shown in detail: preferred ones, then the lowest relative wear of each
    regime, then the lowest of all.
    """
    group = groups_of_rows(regimes)
    ranked = [row for row in rows_to_show(summary, len(summary)) if row in group.index]
    lowest = [next((row for row in ranked if group[row] == regime), None) for regime in ORDER]
    chosen = [*(row for row in preferred if row in group.index), *(row for row in lowest if row), *ranked]
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


def force_remarks(table: pd.DataFrame) -> list[str]:
    """Return what a figure of `force_by_group` must say where runs have no deviation."""
    lacking = table["deviation_N"].isna()
    if not lacking.any():
        return []
    which = "no run has" if lacking.all() else f"{lacking.sum()} of {len(table)} runs do not have"
    return [f"{which} the {FEWEST_STRETCHES} stretches of travel that a deviation needs"]


def published_rows_in_detail(rows: Mapping[str, str]) -> list[str]:
    """Return the rows of a study that have the factors of those which the source shows in detail, in its order.

    rows: {row of the study: published row of the same factors}
    """
    return [ours for wanted in PUBLISHED_IN_DETAIL for ours, theirs in rows.items() if theirs == wanted]


def regime_remarks(regimes: pd.DataFrame) -> list[str]:
    """Return what figures by regime must say where the flow is not steady; regimes: with steady of every run."""
    unsteady = int((~regimes["steady"].astype(bool)).sum())
    return [f"regimes of {unsteady} of {len(regimes)} runs are of a flow not shown to be steady"] if unsteady else []
