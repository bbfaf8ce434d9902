"""Which parameter decides a response of a calibration: Sobol indices of its surrogate over the ranges."""

from __future__ import annotations

import pandas as pd

from bulkwear.postproc.inference.surrogate import KERNELS, Surrogate
from bulkwear.postproc.statistics.sensitivity import RESAMPLES, sobol_indices
from bulkwear.workflows.cases.calibration.figure_findings import parameter_words, said_of
from bulkwear.workflows.cases.calibration.outcome import Calibrated
from bulkwear.workflows.report.sensitivity import REASON, RESPONSE, refused

POWER = 8  # 256 points, each (parameters + 2) times: the draws of a process are of all of them together
FEWEST_PER_PARAMETER = 2  # simulations, and one more, below which a surrogate is little but its prior


def sensitivity_table(done: Calibrated) -> pd.DataFrame:
    """Return the Sobol indices of each response: response, `sensitivity.COLUMNS` and why there are none."""
    names, tables = [parameter_words(name) for name in done.problem.names], []
    for response, surrogate in done.known.surrogates.items():
        words, reason = said_of(response)[0], why_not(surrogate)
        if reason:
            tables.append(refused(words, reason))
            continue
        found = sobol_indices(lambda points, of=surrogate: of.draws(points, -(-RESAMPLES // KERNELS), 0), names, POWER)
        tables.append(found.assign(**{RESPONSE: words, REASON: ""}))
    return pd.concat(tables, ignore_index=True)


def why_not(surrogate: Surrogate) -> str:
    """Return why a surrogate does not hold, "" where it does."""
    count, parameters = surrogate.points.shape
    fewest = FEWEST_PER_PARAMETER * parameters + 1
    if count < fewest:
        return f"{count} simulations of {parameters} parameters, allowed are {fewest} or more"
    share = surrogate.left_out_share
    if not share > 0.0:
        return f"simulations that are left out are predicted no better than by their mean (R² {share:.2g})"
    return ""
