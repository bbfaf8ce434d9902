"""Whether a machine runs steadily: what decides while it runs. The page judges it again, with intervals."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.flow.steady_flow import POWER_PREFIX

LOOKED_AT = 3  # blocks, of which neighbours are compared
Parameters = Mapping[str, Any]


def is_steady(run: Parameters, flow: pd.DataFrame) -> bool:
    """Return whether held mass, power, and the mass that leaves over what comes in hold still over the last blocks.

    Power is that of each part, unless it is idle. Of a machine that is not fed it decides: the mass that it holds is
    always still, so that the power of one part that takes some has to be.
    flow: as from `flow.whole_flow`
    """
    blocks = flow.groupby("cycle")
    if len(blocks) < LOOKED_AT:
        return False
    most = run["start_up"]["steady_change"]
    means, spread = (table.tail(LOOKED_AT) for table in (blocks.mean(), blocks.std()))
    powers = [name for name in means if name.startswith(POWER_PREFIX)]
    still = {name: _change(means[name].to_numpy()) <= most for name in ("held_mass_kg", *powers)}
    idle = {name for name in powers if _is_idle(means[name], spread[name])}
    if not all(holds for name, holds in still.items() if name not in idle):
        return False
    if not run["inlet"]:
        return not powers or any(still[name] and means[name].any() for name in powers)
    ends = blocks.last()
    come, gone = ends[["inserted_mass_kg", "out_mass_kg"]].diff().tail(LOOKED_AT - 1).sum()
    return bool(come > 0.0 and abs(gone - come) <= most * come)


def _is_idle(means: pd.Series, spread: pd.Series) -> bool:
    """Return whether a part takes no more power in any of some blocks than it fluctuates by within it, as one that is
    struck by a particle now and then: a change says nothing. One that material begins to reach takes more.

    spread: standard deviations within the blocks
    """
    return bool((means.abs() <= spread).all())


def _change(values: np.ndarray) -> float:
    """Return the largest change from one value to the next, over the largest of them; 0 where all are 0, infinite where
    one is not known: the first block tells no power.
    """
    if np.isnan(values).any():
        return np.inf
    largest = np.abs(values).max()
    return float(np.abs(np.diff(values)).max() / largest) if largest > 0.0 else 0.0
