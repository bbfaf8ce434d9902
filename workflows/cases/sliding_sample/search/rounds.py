"""What a round of a search decides: patterns to simulate next, or that the best one is confirmed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.inference.improvement import Tried, best_of
from bulkwear.postproc.inference.proposals import Search
from bulkwear.postproc.tables.packings import SETTING
from bulkwear.postproc.tables.summary import summary_table
from bulkwear.workflows.cases.sliding_sample.search.budget import Spent, spent_on
from bulkwear.workflows.cases.sliding_sample.search.results import (
    predictions,
    run_results,
    tried_of,
    tried_patterns,
    volumes_of,
)
from bulkwear.workflows.config.layers import Layer
from bulkwear.workflows.config.optimise import Optimise, fault_of, found_rows, named
from bulkwear.workflows.config.rounds import after_round

CHANCE = 0.9  # -, of enough being left of a pattern, asked of the best one
SEPARATES = (":", " is ")  # what a reason is told before, and numbers after

Fault = Callable[[Sequence[float]], str | None]  # of the values of a pattern: why it cannot be simulated


@dataclass(frozen=True, eq=False)
class Round:
    """What a round knows.

    search: that is asked for; runs: as from `results.run_results`, the reference first
    packings: that there are, by setting, of all rows of the search too; rows: {row: values} that rounds before found
    spent: core hours that the solver has taken; fault: why a pattern cannot be simulated
    """

    search: Optimise
    runs: pd.DataFrame
    packings: Mapping[str, int]
    rows: Mapping[str, Mapping[str, float]]
    spent: Spent
    fault: Fault

    @property
    def settings(self) -> list[str]:
        """Names of the patterns that were simulated."""
        return list(tried_patterns(self.runs, self.search)[SETTING])

    @property
    def values(self) -> np.ndarray:
        """Their values (n, p)."""
        return tried_patterns(self.runs, self.search)[self.search.names].to_numpy(float)

    @property
    def free(self) -> list[str]:
        """Names of the rows that have no values yet."""
        return [name for name in self.search.rows if not self.packings[name]]


def decide_round(
    study: Any,
    number: int,
    design: str | Path,
    wear: Sequence[str],
    surfaces: Sequence[str],
    costs: Sequence[str],
) -> dict[str, Any]:
    """Return what round `number` of a study's search decides, and `after` which it was made.

    design: table of the runs that it looks at; wear, surfaces: their files in its order; costs: of runs and beds
    """
    summary = summary_table(design, wear)
    folder, search = Path(design).parents[1], study.optimise
    runs = run_results(summary, volumes_of(summary["run"], surfaces), search, study.settings["wear"]["acceleration"])
    counts = summary.groupby(SETTING)["packing"].max()
    packings = dict.fromkeys(study.first_packings, 0) | {name: int(count) for name, count in counts.items()}
    now = Round(
        search,
        runs,
        packings,
        found_rows(folder, study.search_digest, before=number),
        spent_on(summary, costs),
        fault_of_study(study),
    )
    return decide(now) | {"after": after_round(folder, number - 1, study.search_digest)}


def decide(now: Round) -> dict[str, Any]:
    """Return what a round decides, JSON-able: `rows`, those found so far with their values, `packings` by setting,
    whether they are `enough`, `predicted` by setting, how many patterns were `excluded` by reason, the settings that
    are `confirmed`, and a sentence.
    """
    found = Search(now.search.factors, now.values, tried_of(now.runs, now.search), _Allowed(now.fault))
    count = now.search.rows_of_round
    next_ones = found.proposed(count)
    said = lowest_predicted(found.tried)
    too_dear = now.spent.total + now.spent.kept(now.search, count) > now.search.most_core_h
    if len(now.free) > count and len(next_ones) and not too_dear:
        names, values = now.free[:count], next_ones
        packings = dict.fromkeys(names[: len(values)], now.search.packings)
        decided = {"enough": False, "confirmed": [], "said": f"{said}; next: {', '.join(packings)}"}
    else:
        names, values, confirmed = _confirmation(now, found)
        packings = dict.fromkeys(confirmed, now.search.confirming_packings)
        why = f"the budget ends here, {now.spent.total:.2g} core hours are used" if too_dear else "no further round"
        listed = ", ".join(confirmed)
        decided = {"enough": True, "confirmed": confirmed, "said": f"{said}; {why}; confirmed: {listed}"}
    rows = {name: named(now.search, row) for name, row in zip(names, values, strict=False)}
    every = [*now.settings, *rows]
    told = predictions(found.tried, np.vstack([now.values, values]) if len(values) else now.values, now.search)
    return {
        "rows": {**now.rows, **rows},
        "packings": {**now.packings, **packings},
        **decided,
        "predicted": {name: line for name, line in zip(every, told.to_dict("records"), strict=True)},
        "excluded": dict(found.allowed.reasons),
    }


def lowest_predicted(tried: Tried) -> str:
    """Return in words the lowest predicted wear over plain of the tried patterns of which enough is left by CHANCE."""
    sure = tried.chance_within(tried.points)
    of = f"of {(sure >= CHANCE).sum()} of {len(sure)} patterns enough is left with a chance of {CHANCE:g} or more"
    if not (sure >= CHANCE).any():
        return f"{of}, the most likely one has {sure.max():.2g}"
    best = tried.points[[best_of(tried, tried.points, CHANCE)]]
    return f"{of}, their lowest predicted wear over plain is {np.exp(tried.interval(best)[0][0]):.3g}"


def _confirmation(now: Round, found: Search) -> tuple[list[str], np.ndarray, list[str]]:
    """Return the name and the values (k, p) of the best predicted pattern, none where it was simulated, and the
    settings to confirm: that one, the best of those simulated, the reference.
    """
    settings = now.settings
    best = found.best_predicted(CHANCE)
    simulated = settings[best_of(found.tried, found.tried.points, CHANCE)]
    same = np.flatnonzero((now.values == best).all(axis=1))
    if len(same):
        return [], np.empty((0, len(best))), list(dict.fromkeys([settings[same[0]], simulated, settings[0]]))
    name = now.free[0]
    return [name], best[None], list(dict.fromkeys([name, simulated, settings[0]]))


class _Allowed:
    """Says which values can be simulated, and counts why the others cannot."""

    def __init__(self, fault: Fault):
        self.fault, self.reasons = fault, Counter()

    def __call__(self, values: np.ndarray) -> np.ndarray:
        faults = [self.fault(row) for row in values]
        self.reasons = Counter(short_reason(fault) for fault in faults if fault)
        return np.array([fault is None for fault in faults], dtype=bool)


def short_reason(fault: str) -> str:
    """Return a fault of a pattern without its numbers: bumps overlap, not which and by how much."""
    ends = [fault.index(word) for word in SEPARATES if word in fault]
    return fault[: min(ends)] if ends else fault


def fault_of_study(study: Any) -> Fault:
    """Return what says why a pattern of a study's search cannot be simulated."""
    reference = Layer("", study.design_rows[0])
    return lambda values: fault_of(study.optimise, reference, study.runs_of, values)
