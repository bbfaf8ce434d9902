"""What happens along the travel of the runs of a study: wear and forces, in tidy tables for figures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.readers.cycle_folders import cycle_files
from bulkwear.postproc.tables.display import in_display_units
from bulkwear.postproc.tables.packings import BY, over_packings

RUN = ["run", "row", "setting", "packing", "surface"]  # what a table of runs says of each
DIRECTIONS = {"vertical_force_N": "vertical", "drag_force_N": "drag"}
ROWS_PER_RUN = 400  # forces drawn per run; more would not show in a figure


def runs_of(design: str | Path) -> pd.DataFrame:
    """Return RUN of every run of a design table, names as text; the surface is "" where the case knows none."""
    table = pd.read_csv(design, dtype=dict.fromkeys(RUN, str) | {"packing": int})
    return (table if "surface" in table else table.assign(surface=""))[RUN]


def wear_history(design: str | Path, wear_files: Sequence[str | Path]) -> pd.DataFrame:
    """Return cumulative wear after each cycle of each run, from zero: RUN, cycle, travel_mm,
    worn_volume_mm3 (what the law takes), applied_volume_mm3 (what the surface has lost),
    carried_volume_mm3.

    wear_files: wear.csv of the runs, in the order of the design.
    """
    runs = runs_of(design).to_dict("records")
    tables = [_run_history(run, pd.read_csv(path)) for run, path in zip(runs, wear_files, strict=True)]
    return in_display_units(pd.concat(tables, ignore_index=True))


def _run_history(run: dict[str, str], wear: pd.DataFrame) -> pd.DataFrame:
    table = pd.DataFrame(
        {
            "cycle": wear["cycle"],
            "travel_m": wear["travel_m"],
            "worn_volume_m3": wear["total_worn_volume_m3"],
            "applied_volume_m3": wear["total_applied_volume_m3"],
            "carried_volume_m3": wear["carried_volume_m3"],
        }
    )
    return _from_zero(run, table)


def _from_zero(run: dict[str, str], table: pd.DataFrame) -> pd.DataFrame:
    """The table with the start, where all is zero, as its first row and with the columns of the run in front."""
    start = pd.DataFrame({name: [0] if name == "cycle" else [0.0] for name in table})
    return pd.concat([start, table], ignore_index=True).assign(**run)[[*run, *table]]


def _rows_of_cycles(folder: Path, name: str) -> pd.DataFrame:
    """The rows of a table that every wear cycle of a run has left, one cycle after the other."""
    files = cycle_files(folder, name)
    if not files:
        raise FileNotFoundError(f"{folder}: no cycle_*/{name} found, at least one wear cycle must have been run.")
    return pd.concat([pd.read_csv(path) for path in files], ignore_index=True)


def wear_within_cycles(design: str | Path, run_folders: Sequence[str | Path]) -> pd.DataFrame:
    """Return cumulative wear along the travel of each run, from zero: RUN, cycle, travel_mm,
    worn_volume_mm3, base_worn_volume_mm3, pattern_worn_volume_mm3 (what the law takes).

    Finer than `wear_history` where cycles were looked into: about every solver.wear_interval_mm of travel.
    run_folders: folders of the runs, in the order of the design, with cycle_*/wear_history.csv.
    Raises FileNotFoundError when a run has none.
    """
    runs = runs_of(design).to_dict("records")
    tables = [_run_stretches(run, Path(folder)) for run, folder in zip(runs, run_folders, strict=True)]
    return in_display_units(pd.concat(tables, ignore_index=True))


def _run_stretches(run: dict[str, str], folder: Path) -> pd.DataFrame:
    stretches = _rows_of_cycles(folder, "wear_history.csv")
    volumes = stretches[["worn_volume_m3", "base_worn_volume_m3", "pattern_worn_volume_m3"]].cumsum()
    table = stretches[["cycle", "travel_m"]].join(volumes)
    return _from_zero(run, table)


def force_history(design: str | Path, run_folders: Sequence[str | Path]) -> pd.DataFrame:
    """Return the bed's force on the whole mesh along the travel: RUN, travel_mm, vertical_force_N
    (down), drag_force_N (along the bed's motion), side_force_N; at most about `ROWS_PER_RUN` evenly spaced
    rows per run, each the mean over its stretch of travel.

    run_folders: folders of the runs, in the order of the design, with cycle_*/forces.csv.
    Raises FileNotFoundError when a run has no forces.
    """
    runs = runs_of(design).to_dict("records")
    tables = [_run_forces(run, Path(folder)) for run, folder in zip(runs, run_folders, strict=True)]
    return in_display_units(pd.concat(tables, ignore_index=True))


def _run_forces(run: dict[str, str], folder: Path) -> pd.DataFrame:
    forces = _rows_of_cycles(folder, "forces.csv")
    table = pd.DataFrame(
        {
            "travel_m": forces["travel_m"],
            "vertical_force_N": -forces["force_z_N"],
            "drag_force_N": forces["force_y_N"],
            "side_force_N": forces["force_x_N"],
        }
    )
    stretch = np.arange(len(table)) // max(-(-len(table) // ROWS_PER_RUN), 1)
    return table.groupby(stretch).mean().assign(**run)[[*run, *table]]


def force_summary(forces: pd.DataFrame) -> pd.DataFrame:
    """Return direction (vertical or drag), setting, surface, mean_force_N, packings and the interval of the mean."""
    runs = forces.groupby(RUN, sort=False)[list(DIRECTIONS)].mean().reset_index().rename(columns=DIRECTIONS)
    table = runs.melt(RUN, list(DIRECTIONS.values()), "direction", "mean_force_N")
    return over_packings(table, "mean_force_N", log=False, by=("direction", *BY))
