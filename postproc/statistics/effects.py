"""Effects of an unreplicated design as orthogonal contrasts, for a half-normal plot."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy import stats

from postproc.statistics.model_terms import SAME, Term, term_columns, term_name

LARGEST_OF_NOISE = 2.5  # -, contrasts beyond so many preliminary errors do not count as noise (Lenth 1989)


def half_normal_table(
    terms: Sequence[Term], coded: np.ndarray, response: np.ndarray, names: Sequence[str]
) -> pd.DataFrame:
    """Return term, contrast, effect, half_normal_score and pseudo_error, smallest contrast first.

    A term's contrast is the response along the part of its column that is orthogonal to the constant and to all terms
    taken before it; each time the term with the largest contrast is taken. There are as many contrasts as runs less
    one at most. Where there is no effect, all have the error's standard deviation (units of the response); the largest
    ones are biased upwards, being chosen, the smallest downwards, being what is left. The effect is the contrast per
    coded unit of that part of the column.

    half_normal_score: quantile of (rank - 1/2) / contrasts of the half-normal distribution (C. Daniel, 1959)
    pseudo_error: R. V. Lenth's pseudo standard error (Technometrics 31, 1989), the same in every row
    """
    columns = term_columns(terms, coded)
    columns = columns - columns.mean(axis=0)
    rest = np.asarray(response, dtype=float) - np.mean(response)
    smallest = SAME * np.sqrt(len(columns))
    taken, contrasts, effects = [], [], []
    while len(contrasts) < len(rest) - 1:
        size = np.linalg.norm(columns, axis=0)
        unit = np.divide(columns, size, out=np.zeros_like(columns), where=size > smallest)
        along = unit.T @ rest
        if not (size > smallest).any():
            break
        best = int(np.where(size > smallest, np.abs(along), -1.0).argmax())
        taken.append(best)
        contrasts.append(along[best])
        effects.append(along[best] / size[best])
        rest = rest - along[best] * unit[:, best]
        columns = columns - np.outer(unit[:, best], unit[:, best] @ columns)
    table = pd.DataFrame(
        {"term": [term_name(terms[k], names) for k in taken], "contrast": contrasts, "effect": effects}
    )
    table = table.sort_values("contrast", key=np.abs, kind="stable", ignore_index=True)
    share = (np.arange(len(table)) + 0.5) / max(len(table), 1)
    return table.assign(half_normal_score=stats.halfnorm.ppf(share), pseudo_error=pseudo_error(table["contrast"]))


def pseudo_error(contrasts: np.ndarray) -> float:
    """Return Lenth's estimate of the error of contrasts of which few are effects; NaN without contrasts."""
    size = np.abs(np.asarray(contrasts, dtype=float))
    if not size.size:
        return float("nan")
    first = 1.5 * np.median(size)
    small = size[size < LARGEST_OF_NOISE * first]
    return float(1.5 * np.median(small)) if small.size else 0.0
