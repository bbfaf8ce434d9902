"""The source's regression of the wear, to be held against one's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from postproc.statistics.factors import factor_of
from postproc.statistics.model_terms import parse_term, term_columns
from postproc.statistics.regression import CONSTANT


def has_factors(coefficients: pd.DataFrame, names: Sequence[str]) -> bool:
    """Return whether a study has all factors of a published regression; coefficients: with term."""
    terms = coefficients.loc[coefficients["term"] != CONSTANT, "term"]
    return {name for term in terms for name in term.removesuffix("^2").split("*")} <= set(names)


def published_wear(coefficients: pd.DataFrame, names: Sequence[str], coded: np.ndarray) -> np.ndarray:
    """Return the normalised wear (k,) that a published regression predicts at places (k, factors) in coded units.

    coefficients: term and coefficient of ln(normalised wear); names: short names of the factors, which it has all
    """
    terms = coefficients[coefficients["term"] != CONSTANT]
    constant = float(coefficients.loc[coefficients["term"] == CONSTANT, "coefficient"].iloc[0])
    parsed = [parse_term(term, names) for term in terms["term"]]
    return np.exp(constant + term_columns(parsed, coded) @ terms["coefficient"].to_numpy(dtype=float))


def published_wear_by_row(
    design: pd.DataFrame, coefficients: pd.DataFrame, columns: Mapping[str, str]
) -> dict[str, float]:
    """Return the normalised wear (-) by row of a design by the published regression; {} without its factors.

    columns: {short name: column of the design}
    """
    if not has_factors(coefficients, list(columns)):
        return {}
    levels = {name: design[column].to_numpy(dtype=float) for name, column in columns.items()}
    coded = np.column_stack([factor_of(name, values).coded(values) for name, values in levels.items()])
    return dict(zip(design["row"].astype(str), published_wear(coefficients, list(columns), coded), strict=True))
