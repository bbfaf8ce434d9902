"""What the wear updates of the runs of a study did, cycle by cycle: volumes, steps, faces, the balance."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.tables.display import in_display_units
from bulkwear.postproc.tables.history import RUN, runs_of
from bulkwear.postproc.tables.packings import BY


def wear_updates(design: str | Path, wear_files: Sequence[str | Path]) -> pd.DataFrame:
    """Return what each cycle's update did: RUN, cycle, cycle_start_mm and travel_mm (its ends),
    applied_percent and carried_percent (of what the law takes in the cycle; carried: by its end), step_demand (step
    that the cycle's wear asked for over the cap of the edges, -), step_taken (largest step over the largest cap,
    -), smallest_angle_deg, remeshed_faces, bad_faces_left, balance_error (-, of the law's volume).

    wear_files: wear.csv of the runs, in the order of the design. Shares are NaN in a cycle that wears nothing.
    """
    runs = runs_of(design).to_dict("records")
    tables = [_run_updates(pd.read_csv(path)).assign(**run) for run, path in zip(runs, wear_files, strict=True)]
    table = pd.concat(tables, ignore_index=True)
    return in_display_units(table[[*RUN, *table.columns.drop(RUN)]])


def _run_updates(wear: pd.DataFrame) -> pd.DataFrame:
    law = wear["worn_volume_m3"].where(wear["worn_volume_m3"] > 0.0)
    return pd.DataFrame(
        {
            "cycle": wear["cycle"],
            "cycle_start_m": wear["travel_m"].shift(fill_value=0.0),
            "travel_m": wear["travel_m"],
            "applied_percent": 100.0 * wear["applied_volume_m3"] / law,
            "carried_percent": 100.0 * wear["carried_volume_m3"] / law,
            "step_demand": wear["step_demand"],
            "step_taken": wear["largest_step_m"] / wear["step_limit_m"].where(wear["step_limit_m"] > 0.0),
            "smallest_angle_deg": wear["smallest_angle_deg"],
            "remeshed_faces": wear["remeshed_faces"],
            "bad_faces_left": wear["bad_faces_left"],
            "balance_error": wear["balance_error"],
        }
    )


def update_summary(updates: pd.DataFrame) -> pd.DataFrame:
    """Return the worst update of all packings by setting and surface, for studies of many settings: lowest
    applied_percent and smallest angle, largest carried_percent, step_demand, step_taken, bad_faces_left and
    balance_error, the sum of remeshed_faces.

    updates: as from `wear_updates`.
    """
    worst = {
        "applied_percent": "min",
        "carried_percent": "max",
        "step_demand": "max",
        "step_taken": "max",
        "smallest_angle_deg": "min",
        "remeshed_faces": "sum",
        "bad_faces_left": "max",
        "balance_error": "max",
    }
    return updates.groupby(list(BY), sort=False).agg(worst).reset_index()


def drawn_in_log(values: pd.Series) -> np.ndarray:
    """Return values as an axis of powers of ten takes them: NaN where nothing is left to draw."""
    return values.where(values > 0.0).to_numpy(dtype=float)
