"""What a search has spent of its core hours, and what it must keep for a round and for the confirmation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.tables.packings import PACKING, SETTING
from bulkwear.workflows.config.optimise import CONFIRMED, Optimise
from bulkwear.workflows.config.rounds import core_hours


@dataclass(frozen=True)
class Spent:
    """Core hours of the solver.

    total: of all runs and beds; pattern: of the dearest pattern in one packing; packing: of what all patterns of a
    packing share, its bed and its plain twin
    """

    total: float
    pattern: float
    packing: float

    def kept(self, search: Optimise, rows: int) -> float:
        """Return the core hours of so many further patterns, the best predicted one and the confirmation, whose
        packings need beds and plain twins of their own.
        """
        further = search.confirming_packings - search.packings
        patterns = (rows + 1) * search.packings + CONFIRMED * further
        return self.pattern * patterns + self.packing * further


def spent_on(runs: pd.DataFrame, costs: Sequence[str]) -> Spent:
    """Return what was spent.

    runs: setting, packing and surface of each run; costs: tables of the runs in that order, then of beds
    """
    hours, beds = np.array([core_hours([path]) for path in costs[: len(runs)]]), core_hours(list(costs[len(runs) :]))
    plain = (runs["surface"] == PLAIN).to_numpy()
    of_pattern = pd.Series(hours[~plain]).groupby([runs.loc[~plain, name].to_numpy() for name in (SETTING, PACKING)])
    shared = beds + float(hours[plain].sum())
    return Spent(float(hours.sum()) + beds, float(of_pattern.sum().max()), shared / runs[PACKING].nunique())
