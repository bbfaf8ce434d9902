"""Whether a machine runs steadily: what decides while it runs. The page judges it again, with intervals."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

LOOKED_AT = 3  # blocks, of which neighbours are compared
Parameters = Mapping[str, Any]


def is_steady(run: Parameters, flow: pd.DataFrame) -> bool:
    """Return whether held mass, power, and the mass that leaves over what comes in hold still over the last blocks.

    flow: as from `flow.whole_flow`
    """
    blocks = flow.groupby("cycle")
    if len(blocks) < LOOKED_AT:
        return False
    most = run["start_up"]["steady_change"]
    means = blocks.mean().tail(LOOKED_AT)
    watched = ["held_mass_kg", *(name for name in means if name.startswith("power_"))]
    still = all(_change(means[name].to_numpy()) <= most for name in watched)
    if not run["inlet"]:
        return still
    ends = blocks.last()
    come, gone = ends[["inserted_mass_kg", "out_mass_kg"]].diff().tail(LOOKED_AT - 1).sum()
    return bool(still and come > 0.0 and abs(gone - come) <= most * come)


def _change(values: np.ndarray) -> float:
    """Return the largest change from one value to the next, over the largest of them; 0 where all are 0, infinite where
    one is not known: the first block tells no power.
    """
    if np.isnan(values).any():
        return np.inf
    largest = np.abs(values).max()
    return float(np.abs(np.diff(values)).max() / largest) if largest > 0.0 else 0.0
