"""What a finished calibration answers, in sentences, and how far that can be trusted."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from math import isnan, nan
from operator import getitem
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.inference.loop import Posterior
from bulkwear.postproc.inference.posterior import FAMILY_SHARE, densest, posterior_weights
from bulkwear.postproc.inference.problem import Problem
from bulkwear.postproc.inference.told import LEFT
from bulkwear.workflows.cases.calibration.boxes import test_of
from bulkwear.workflows.cases.calibration.figure_findings import MET, parameter_words, reproduced, said_of, values_of
from bulkwear.workflows.cases.calibration.outcome import Calibrated
from bulkwear.workflows.cases.calibration.responses import (
    RECOMMENDED,
    information_table,
    interval_table,
    is_searched,
    shares_at,
)
from bulkwear.workflows.report.sections import CARE, SOUND, WEAK, Light
from bulkwear.workflows.report.sentences import PERCENT, capital, listed, measured, spoken
from bulkwear.workflows.report.text import number, range_text
from bulkwear.workflows.report.verdict import ENOUGH_PACKINGS


def on_pairs(statements: pd.DataFrame) -> list[str]:
    """Return what the recommended pair reproduces, and whether the other pairs are in the family."""
    others = [pair for pair in dict.fromkeys(statements["pair"]) if pair != RECOMMENDED]
    return [*filter(None, [reproduced(statements, RECOMMENDED)]), *(in_family(statements, pair) for pair in others)]


def in_family(statements: pd.DataFrame, pair: str) -> str:
    """Return whether a pair is kept by what was measured, by the share of the posterior that fits better."""
    rows = statements[statements["pair"] == pair]
    return f"The {spoken(pair)} pair ({values_of(rows)}) {kept_words(float(rows['denser_share'].iloc[0]))}."


def kept_words(share: float) -> str:
    """Return whether a pair is kept, by the share of the posterior that fits better; NaN: it was not searched."""
    if isnan(share):
        return "lies outside of the range that was searched"
    verdict = "is rejected" if share > FAMILY_SHARE else "is in the family"
    fits = f"{number(PERCENT * share, 3)} % of the posterior fits better"
    return f"{verdict}: {fits} (allowed: {PERCENT * FAMILY_SHARE:.0f} %)"


def of_material(done: Calibrated) -> str:
    """Return whether the values that materials have already, with which other studies run, are in the family."""
    test = test_of(done.parameters, done.parameters["calibration"]["tests"][-1], {}, 0)
    values = {name: float(reduce(getitem, name.split("."), test)) for name in done.problem.names}
    point = np.array([list(values.values())])
    share = float(shares_at(done.problem, done.known, point)[0]) if is_searched(done.problem, point)[0] else nan
    words = ", ".join(f"{parameter_words(name)} {value:.2f}" for name, value in values.items())
    return f"The pair of the materials file ({words}) {kept_words(share)}."


def on_posterior(done: Calibrated) -> list[str]:
    """Return the intervals of the parameters, which measurement decides, and which pairs are rejected: of those that
    others simulated, and the one that the material has.
    """
    problem, known = done.problem, done.known
    intervals = interval_table(problem, known, done.pairs[done.compared])
    ends = f"{capital('; '.join(interval_words(row) for _, row in intervals.iterrows()))}."
    best = information_table(problem, known).iloc[0]
    bits = measured(best["information_bits"], "bit")
    further = f"Measuring the {said_of(best['response'])[0]} once more is expected to tell most, {bits}."
    return [ends, *deciding(shares_left(problem, known)), further, *rejected(done), of_material(done)]


def interval_words(row: pd.Series) -> str:
    """Return a parameter's value and interval, and whether that is most of the range; row: of `interval_table`."""
    left = (row["high"] - row["low"]) / (FAMILY_SHARE * (row["searched_to"] - row["searched_from"]))
    hardly = f" ({PERCENT * left:.0f} % of the range is left: hardly told alone)" if left > LEFT else ""
    return (
        f"{parameter_words(row['parameter'])} is {row['recommended']:.2f}, {PERCENT * FAMILY_SHARE:.0f} % of what fits"
        f" between {row['low']:.2f} and {row['high']:.2f}{hardly}"
    )


def shares_left(problem: Problem, known: Posterior) -> dict[str, float]:
    """Return the share (-) of the range of the parameters in the family of each measured response alone, least first;
    "" has that of all together.
    """
    used = {name: each for name, each in known.predicted.items() if name in problem.measured}
    alone = {name: posterior_weights({name: each}, problem.measured) for name, each in used.items()}
    left = {name: float(densest(weights, FAMILY_SHARE).mean()) for name, weights in alone.items()}
    together = float(densest(posterior_weights(used, problem.measured), FAMILY_SHARE).mean())
    return {"": together, **dict(sorted(left.items(), key=lambda item: item[1]))}


def deciding(left: Mapping[str, float]) -> list[str]:
    """Return which measured response decides, the one that alone leaves the least of the range."""
    words = [(said_of(name)[0], f"{number(PERCENT * share, 2)} %") for name, share in left.items() if name]
    together = f"{number(PERCENT * left[''], 2)} %"
    if len(words) == 1:
        return [
            f"The {words[0][0]}, the only response that was measured and simulated, leaves {together} of the range."
        ]
    others = listed([f"{name} {share}" for name, share in words[1:]])
    return [
        f"The {words[0][0]} decides most: alone it leaves {words[0][1]} of the range of the parameters, {others}; all"
        f" together leave {together}."
    ]


def rejected(done: Calibrated) -> list[str]:
    """Return how many of the pairs that others simulated are rejected; nothing where they have other parameters or lie
    outside of the range.
    """
    names = done.problem.names
    if not set(names) <= set(done.published):
        return []
    inside = done.published[is_searched(done.problem, done.published[names].to_numpy(float))]
    if inside.empty:
        return []
    shares = shares_at(done.problem, done.known, inside[names].to_numpy(float))
    kept = inside.loc[shares <= FAMILY_SHARE, "row"].map(spoken).tolist()
    rest = f"; {listed(kept)} {'is' if len(kept) == 1 else 'are'} not" if kept else ""
    return [f"Of {len(shares)} pairs that others simulated {int((shares > FAMILY_SHARE).sum())} are rejected{rest}."]


# ---------------------------------------------------------------- how far it can be trusted


def lights(statements: pd.DataFrame, looks: pd.DataFrame, most_share: float) -> list[Light]:
    """Return whether responses are reproduced, the surrogate is sure enough, and the pair was simulated several times.

    looks: simulations, test and surrogate_share; most_share: (-) of the variance, of the stopping rule
    """
    own = statements[(statements["pair"] == RECOMMENDED) & statements["measured"].notna()]
    return [reproduced_light(own), surrogate_light(looks, most_share), repeats_light(own)]


def reproduced_light(own: pd.DataFrame) -> Light:
    """Return whether the recommended pair gives what was measured; own: its statements."""
    asked = own[own["seeds"] > 0]
    off = int((~asked["inside"].isin(MET)).sum())
    if off:
        return Light("Reproduced", WEAK, f"{off} of {len(asked)} responses that were simulated are not.")
    if len(asked) < len(own) or asked.empty:
        return Light("Reproduced", CARE, f"{len(own) - len(asked)} of {len(own)} responses were not simulated again.")
    return Light("Reproduced", SOUND, f"{len(own)} of {len(own)} that were measured and simulated are.")


def surrogate_light(looks: pd.DataFrame, most_share: float) -> Light:
    """Return whether the simulations were enough for the stopping rule."""
    last = looks.groupby("test", sort=False)["surrogate_share"].last()
    over = last[last > most_share]
    if over.empty:
        return Light("Enough simulations", SOUND, "The stopping rule ended all tests.")
    names = listed([f"{spoken(str(test))} {share:.2f}" for test, share in over.items()])
    said = f"the surrogate's share of the variance is still above {most_share:g}: {names}"
    return Light("Enough simulations", CARE, f"{capital(said)}.")


def repeats_light(own: pd.DataFrame) -> Light:
    """Return whether the scatter between packings of the recommended pair is known."""
    counts = own.loc[own["seeds"] > 0, "seeds"].tolist() or [0]
    state = SOUND if min(counts) >= ENOUGH_PACKINGS else CARE if min(counts) > 1 else WEAK
    unknown = ", the scatter is unknown" if min(counts) < 2 else ""
    return Light("Replicated", state, f"Random packings of the recommended pair: {range_text(counts)}{unknown}.")


def lights_of(study: Mapping[str, Any], folder: Path) -> list[Light]:
    """Return the lights of a study; folder: results/<study>."""
    statements, looks = (pd.read_csv(folder / f"{name}.csv") for name in ("summary", "looks"))
    return lights(statements, looks, study["settings"]["calibration"]["surrogate_share"])
