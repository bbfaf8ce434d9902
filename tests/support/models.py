"""Designs in coded units, and which models obey a heredity, one by one: what searches over models are held against."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.factors import Factor
from bulkwear.postproc.statistics.model_terms import Heredity, Term


def coded_table(design: pd.DataFrame, factors: Sequence[Factor]) -> np.ndarray:
    """Return a design table in coded units, (runs, factors)."""
    return np.column_stack([factor.coded(design[factor.name].to_numpy()) for factor in factors])


def obeys(choices: np.ndarray, terms: Sequence[Term], heredity: Heredity) -> np.ndarray:
    """Return which models (m,) obey a heredity.

    choices: (m, s) positions in `terms` of each model's terms. An interaction or a square needs in the model: with
    "strong" the main effects of all its factors, with "weak" of one of them, with "none" nothing.
    """
    allowed = np.ones(len(choices), dtype=bool)
    if heredity == "none" or not choices.size:
        return allowed
    chosen = np.zeros((len(choices), len(terms)), dtype=bool)
    np.put_along_axis(chosen, choices, True, axis=1)
    mains = {term[0]: position for position, term in enumerate(terms) if len(term) == 1}
    absent = np.zeros(len(choices), dtype=bool)
    enough = np.logical_and if heredity == "strong" else np.logical_or
    for position, term in enumerate(terms):
        if len(term) == 2:
            parents = [chosen[:, mains[k]] if k in mains else absent for k in term]
            allowed &= ~chosen[:, position] | enough(*parents)
    return allowed
