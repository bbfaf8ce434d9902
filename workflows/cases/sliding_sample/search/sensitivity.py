"""Which measure of a pattern decides its wear and its loss: Sobol indices of a search's surrogates over its ranges."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pandas as pd

from bulkwear.workflows.report.sensitivity import REASON, RESPONSE, refused
from bulkwear.workflows.report.surrogate_indices import surrogate_indices, why_not
from bulkwear.workflows.report.text import name_and_unit

if TYPE_CHECKING:
    from bulkwear.postproc.inference.improvement import Tried
    from bulkwear.workflows.config.optimise import Optimise


def sensitivity_table(tried: Tried, search: Optimise) -> pd.DataFrame:
    """Return the Sobol indices of both responses of a search: response, `sensitivity.COLUMNS`, why there are none."""
    names, tables = [name_and_unit(name)[0] for name in search.names], []
    surrogates = {"ln wear over plain": tried.response, "ln loss of the pattern per hour": tried.limited_response}
    for response, surrogate in surrogates.items():
        reason = why_not(surrogate)
        if reason:
            tables.append(refused(response, reason))
            continue
        tables.append(surrogate_indices(surrogate, names).assign(**{RESPONSE: response, REASON: ""}))
    return pd.concat(tables, ignore_index=True)
