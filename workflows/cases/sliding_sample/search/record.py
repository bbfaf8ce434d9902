"""The record of a search: every pattern that was tried, and those confirmed, beside plain and the reference."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import estimate
from bulkwear.postproc.tables.packings import PACKING, SETTING, relative_wear_of_settings
from bulkwear.postproc.wear.prediction import predicted
from bulkwear.workflows.cases.sliding_sample.search.results import left_after
from bulkwear.workflows.config.optimise import Optimise

PERCENT = 100.0
FORESEEN = ("predicted", "predicted_low", "predicted_high")
WEAR, LOSS = "ln_wear_over_plain", "ln_loss_per_h"


def record_table(
    summary: pd.DataFrame, runs: pd.DataFrame, rounds: Sequence[Mapping[str, Any]], search: Optimise
) -> pd.DataFrame:
    """Return a line per pattern in the order in which they were simulated.

    summary: as from `summary.summary_table`; runs: as from `results.run_results`; rounds: what they decided, in order
    Columns: setting, round (0: before the first), the factors, wear_over_plain with packings and interval, FORESEEN by
    the round that proposed it (NaN without one), left_percent after the hours of the search, enough_left (yes, no).
    """
    wear = relative_wear_of_settings(summary).drop(columns="surface").set_index(SETTING)
    groups = runs.groupby(SETTING, sort=False)
    left = PERCENT * left_after(groups[LOSS].mean(), search)
    born = {name: number for number, each in reversed(list(enumerate(rounds, 1))) for name in each["rows"]}
    lines = []
    for name, of_setting in groups:
        number = born.get(name, 0)
        told = rounds[number - 1]["predicted"][name] if number else {}
        lines.append(
            {
                SETTING: name,
                "round": number,
                **of_setting[search.names].iloc[0],
                **wear.loc[name, ["wear_over_plain", "packings", "interval_low", "interval_high"]],
                **{key: told.get(key, np.nan) for key in FORESEEN},
                "left_percent": left[name],
                "enough_left": "yes" if left[name] >= PERCENT * search.least_left else "no",
            }
        )
    return pd.DataFrame(lines).sort_values("round", kind="stable").reset_index(drop=True)


def confirmed_table(
    runs: pd.DataFrame, last: Mapping[str, Any], reference: str, search: Optimise, error: float
) -> pd.DataFrame:
    """Return a line per confirmed pattern, the best predicted one first and the reference last.

    runs: as from `results.run_results`; last: what the last round decided; error: -, of the wear coefficient
    Columns: setting, the factors, packings, FORESEEN by the last round, wear_over_plain with interval, over_reference
    with interval (of the same packings), left_percent with interval (packings and coefficient), enough_left: yes or no
    where the interval tells, else open.
    """
    of_reference = runs[runs[SETTING] == reference].set_index(PACKING)[WEAR]
    lines = []
    for name in last["confirmed"]:
        own = runs[runs[SETTING] == name].set_index(PACKING)
        wear = estimate(np.exp(own[WEAR]), log=True)
        over = estimate(np.exp((own[WEAR] - of_reference).dropna()), log=True)
        loss = predicted(estimate(np.exp(own[LOSS]), log=True), error)
        left, low, high = (_left(value, search) for value in (loss.value, loss.high, loss.low))
        lines.append(
            {
                SETTING: name,
                **own[search.names].iloc[0],
                "packings": wear.packings,
                **{key: last["predicted"][name][key] for key in FORESEEN},
                "wear_over_plain": wear.value,
                **dict(zip(("interval_low", "interval_high"), wear.interval(), strict=True)),
                "over_reference": over.value,
                **dict(zip(("over_reference_low", "over_reference_high"), over.interval(), strict=True)),
                "left_percent": left,
                "left_low_percent": low,
                "left_high_percent": high,
                "enough_left": _told(low, high, PERCENT * search.least_left),
            }
        )
    return pd.DataFrame(lines)


def _left(loss: float, search: Optimise) -> float:
    """Return what is left (%) at a loss per hour (1/h); NaN where that is unknown."""
    return PERCENT * float(left_after(np.log(loss), search)) if np.isfinite(loss) else np.nan


def _told(low: float, high: float, least: float) -> str:
    return "yes" if low >= least else "no" if high < least else "open"


def excluded_table(rounds: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return reason and patterns: how many candidates of all rounds were left out before they were meshed."""
    counts = pd.DataFrame([each["excluded"] for each in rounds]).sum()
    return pd.DataFrame({"reason": counts.index, "patterns": counts.to_numpy(int)})


def best_confirmed(confirmed: pd.DataFrame) -> pd.Series:
    """Return the line of the confirmed pattern of least wear over plain, of those of which enough may be left."""
    sound = confirmed[confirmed["enough_left"] != "no"]
    table = sound if len(sound) else confirmed
    return table.loc[table["wear_over_plain"].idxmin()]
