"""What each value of a choice changes in a response that packings scatter: randomised blocks, verdicts on a limit."""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy import stats

CONFIDENCE = 0.95  # -, of intervals
WITHIN, BEYOND, UNDECIDED, FAILED = "within", "beyond", "undecided", "a run failed"


def changes(
    values: np.ndarray, responses: np.ndarray, packings: np.ndarray, reference: float, limit: float
) -> pd.DataFrame:
    """Return what each value of a choice changes, a row per value in rising order.

    values, responses, packings: (n,), a run each: value of the choice, its positive response, NaN where the solver
    failed, and label of its packing; reference: value that the others are compared with; limit: change (-) that matters

    A packing has more or fewer particles than another, which all of its runs share, so ln(response) is the sum of an
    effect of the value, one of the packing and chance (randomised blocks: Montgomery, Design and Analysis of
    Experiments, chapter 4; least squares where not every packing has every value).

    runs: with a response; failed: without; mean: geometric, over the same packings; change, change_low, change_high:
    over the reference, less 1, with its interval by Student's t, NaN where too few runs tell of chance; scatter:
    standard deviation of chance; verdict: whether the interval lies `within` the limit, `beyond` it, or neither, or
    that a run failed. The reference changes nothing, by definition. Raises ValueError without a run at the reference.
    """
    table = pd.DataFrame({"value": values, "log": np.log(np.asarray(responses, float)), "packing": packings})
    runs = table.groupby("value")["log"].agg(runs="count", failed=lambda logs: int(logs.isna().sum()))
    done = table.dropna(subset=["log"])
    if reference not in done["value"].to_numpy():
        raise ValueError(
            f"no run at the reference {reference:g}, allowed are {', '.join(f'{v:g}' for v in runs.index)}"
        )
    of_value, of_packing = (pd.get_dummies(done[name], dtype=float) for name in ("value", "packing"))
    shared = of_packing.to_numpy()[:, 1:] - of_packing.to_numpy()[:, :1]  # effects of packings add up to nothing
    matrix = np.hstack([of_value.to_numpy(), shared])
    effects, _, rank, _ = np.linalg.lstsq(matrix, done["log"].to_numpy(), rcond=None)
    freedom = len(done) - rank
    rest = done["log"].to_numpy() - matrix @ effects
    scatter = np.sqrt(rest @ rest / freedom) if freedom else np.nan
    against = np.eye(len(effects))[: of_value.shape[1]] - np.eye(len(effects))[of_value.columns.get_loc(reference)]
    spread = np.einsum("ij,jk,ik->i", against, np.linalg.pinv(matrix.T @ matrix), against)
    reach = stats.t.ppf(0.5 + CONFIDENCE / 2.0, max(freedom, 1)) * scatter * np.sqrt(np.maximum(spread, 0.0))
    reach[of_value.columns.get_loc(reference)] = 0.0
    change = against @ effects
    found = {
        "change": np.expm1(change),
        "change_low": np.expm1(change - reach),
        "change_high": np.expm1(change + reach),
    }
    told = pd.DataFrame({"mean": np.exp(effects[: of_value.shape[1]]), **found}, index=of_value.columns)
    told = runs.join(told).assign(scatter=scatter)
    told["verdict"] = [
        FAILED if row.failed else verdict(row.change_low, row.change_high, limit) for row in told.itertuples()
    ]
    return told.rename_axis("value").reset_index()


def verdict(low: float, high: float, limit: float) -> str:
    """Return what the interval of a change (-) says about a limit (-)."""
    if -limit <= low and high <= limit:
        return WITHIN
    return BEYOND if low > limit or high < -limit else UNDECIDED
