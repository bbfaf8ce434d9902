"""Which parameters the measured responses tell: what they leave of the range that each was looked for in.

A response may tell a parameter alone, or only together with others: one angle leaves a curve of pairs of frictions, on
which each of the two may have any value, and tells either as soon as the other is known. And a parameter may be told by
no response at all: then it has any value even where all others are known.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from bulkwear.postproc.inference.loop import Posterior
from bulkwear.postproc.inference.posterior import FAMILY_SHARE, interval, posterior_weights
from bulkwear.postproc.inference.problem import Problem
from bulkwear.postproc.inference.surrogate import predictions

LEFT = 0.8  # -, of the interval before; a posterior that keeps more than this has told nothing
LINES, VALUES = 48, 81  # points of the posterior at which a parameter is varied alone, and values on each line
TOLD, TOGETHER, NOT_TOLD = "yes", "only together with others", "no"


def told_table(problem: Problem, known: Posterior) -> pd.DataFrame:
    """Return one row per parameter: what is left of its 95 % interval, and whether the responses tell it.

    left: width of the posterior's 95 % interval over that of the range; left_others_known: the same with all other
    parameters held at values of the posterior, mean over these; told: by `LEFT`
    """
    rows = []
    for column, parameter in enumerate(problem.parameters):
        low, high = interval(known.points[:, column], known.weights)
        left, alone = (high - low) / FAMILY_SHARE, _left_others_known(problem, known, column)
        told = TOLD if left <= LEFT else TOGETHER if alone <= LEFT else NOT_TOLD
        rows.append({"parameter": parameter.name, "left": left, "left_others_known": alone, "told": told})
    return pd.DataFrame(rows)


def _left_others_known(problem: Problem, known: Posterior, column: int) -> float:
    """Return the mean width of a parameter's 95 % interval over that of the range, the others held."""
    shares = (np.arange(LINES) + 0.5) / LINES
    drawn = np.searchsorted(np.cumsum(known.weights), shares).clip(max=len(known.points) - 1)
    line = (np.arange(VALUES) + 0.5) / VALUES
    points = np.repeat(known.points[drawn], VALUES, axis=0)
    points[:, column] = np.tile(line, LINES)
    weights = posterior_weights(predictions(known.surrogates, points), problem.measured).reshape(LINES, VALUES)
    ends = np.array([interval(line, each / each.sum()) for each in weights])
    return float(np.diff(ends, axis=1).mean() / FAMILY_SHARE)
