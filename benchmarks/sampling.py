"""Error of a load ledger made from sampled contacts, against the one that the solver sums at every step."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd


def sampling_errors(
    sampled: Mapping[int, np.ndarray], exact: np.ndarray, dump_bytes: int, ledger_bytes: int
) -> pd.DataFrame:
    """Return one row per stride: errors of the sliding work, relative, and the disk that each way takes.

    sampled: {stride in steps: (windows, m) sliding work in J per window of the travel and triangle}, with stride 1
    exact: (m,) sliding work in J of the whole travel, summed in the solver
    dump_bytes, ledger_bytes: what the dumps at stride 1, and the solver's ledger, take

    total_error: of the sum over all triangles and windows, against `exact`
    short_window_error: root mean square over the windows of the error of a window's sum, against stride 1
    map_error: sum over triangles of the error's magnitude over the total, against `exact`
    """
    every_window = sampled[1].sum(axis=1)
    rows = []
    for stride, work in sampled.items():
        short = work.sum(axis=1) / every_window - 1.0
        rows.append(
            {
                "stride_steps": stride,
                "total_error": abs(work.sum() / exact.sum() - 1.0),
                "short_window_error": float(np.sqrt(np.mean(short**2))),
                "map_error": float(np.abs(work.sum(axis=0) - exact).sum() / exact.sum()),
                "dumps_MB": dump_bytes / stride / 1e6,
                "solver_ledger_MB": ledger_bytes / 1e6,
            }
        )
    return pd.DataFrame(rows)
