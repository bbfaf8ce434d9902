"""Which parameter decides a response of a calibration: Sobol indices of its surrogate over the ranges."""

from __future__ import annotations

import pandas as pd

from bulkwear.workflows.cases.calibration.figure_findings import parameter_words, said_of
from bulkwear.workflows.cases.calibration.outcome import Calibrated
from bulkwear.workflows.report.sensitivity import REASON, RESPONSE, refused
from bulkwear.workflows.report.surrogate_indices import surrogate_indices, why_not


def sensitivity_table(done: Calibrated) -> pd.DataFrame:
    """Return the Sobol indices of each response: response, `sensitivity.COLUMNS` and why there are none."""
    names, tables = [parameter_words(name) for name in done.problem.names], []
    for response, surrogate in done.known.surrogates.items():
        words, reason = said_of(response)[0], why_not(surrogate)
        if reason:
            tables.append(refused(words, reason))
            continue
        tables.append(surrogate_indices(surrogate, names).assign(**{RESPONSE: words, REASON: ""}))
    return pd.concat(tables, ignore_index=True)
