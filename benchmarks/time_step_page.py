"""The page of `benchmarks.time_step_limits`: how long a time step may be under each rolling model."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

from benchmarks.changes import BEYOND, FAILED, UNDECIDED, WITHIN, changes
from benchmarks.stiffness import CASE, LIMIT, PERCENT, VELOCITY
from bulkwear.workflows.report.markdown_text import bullet, markdown, prose

RESPONSES = {"sliding_work_J_per_m": "sliding work", "impact_energy_J_per_m": "impact energy"}  # that wear follows
ENOUGH = 3  # packings of a model and surface before a limit is told

Answers = Mapping[tuple[str, str, str], pd.DataFrame]


def answers(table: pd.DataFrame) -> Answers:
    """Return by model, surface and response what each time step changes against the smallest one that ran.

    table: a row per run with model, surface, seed, rayleigh_fraction, `RESPONSES` and processor_s
    """
    found = {}
    for (model, surface), runs in table.groupby(["model", "surface"], sort=False):
        for response in RESPONSES:
            done = runs.loc[runs[response].notna(), "rayleigh_fraction"]
            if done.empty:
                continue
            told = changes(runs["rayleigh_fraction"], runs[response], runs["seed"], done.min(), LIMIT)
            cost = runs.groupby("rayleigh_fraction")["processor_s"].mean().rename_axis("value").reset_index()
            found[model, surface, response] = told.merge(cost, on="value")
    return found


def longest(found: pd.DataFrame) -> float:
    """Return the longest time step (-) whose change is shown to be within the limit, where of no shorter one the
    opposite is shown and none failed; NaN where there is none but the shortest, with which the others are compared.

    found: of `answers`
    """
    allowed = ~found["verdict"].isin([BEYOND, FAILED]).cummax()
    within = found.loc[allowed & (found["verdict"] == WITHIN), "value"]
    return float(within.max()) if compared(found) and len(within) > 1 else math.nan


def compared(found: pd.DataFrame) -> bool:
    """Return whether enough packings of every time step have run, all of the shortest one to their end.

    found: of `answers`
    """
    enough = len(found) > 1 and (found["runs"] + found["failed"]).min() >= ENOUGH
    return bool(enough and found["verdict"].iloc[0] == WITHIN)


def limits(found: Answers) -> pd.DataFrame:
    """Return a row per model: the longest time step (-) by surface and response, and the shortest of them, NaN where
    one of them has none.
    """
    rows = []
    for model in dict.fromkeys(key[0] for key in found):
        own = {
            f"{surface}, {RESPONSES[response]}": longest(told)
            for (of, surface, response), told in found.items()
            if of == model
        }
        least = math.nan if any(map(math.isnan, own.values())) else min(own.values())
        rows.append({"model": model, **own, "all of them": least})
    return pd.DataFrame(rows)


def costs(table: pd.DataFrame) -> pd.Series:
    """Return the processor time (-) of each model over that of the first, geometric mean over surfaces and time steps
    that both have.

    table: as in `answers`
    """
    spent = table.groupby(["model", "surface", "rayleigh_fraction"], sort=False)["processor_s"].mean().unstack(0)
    return np.exp(np.log(spent.div(spent.iloc[:, 0], axis=0)).mean())


def said_of(model: str, found: Answers, row: pd.Series) -> str:
    """Return in a sentence how long a time step may be under a model; row: of `limits`."""
    own, limit = [told for key, told in found.items() if key[0] == model], row["all of them"]
    shortest = min(told["value"].min() for told in own)
    if not all(map(compared, own)):
        return (
            f"`{model}`: not known, fewer than {ENOUGH} packings of every time step have run, or a shortest one failed"
        )
    if not math.isnan(limit):
        return (
            f"`{model}`: at {limit:g} of the Rayleigh time all is within {PERCENT * LIMIT:g} % with 95 % confidence,"
            " and no shorter step is shown to be beyond"
        )
    shown = row.drop(["model", "all of them"]).dropna()
    shown = ", ".join(f"of {name} up to {value:g}" for name, value in shown.items()) or "of nothing"
    widest = max(((told["change_high"] - told["change_low"]) / 2.0).max() for told in own)
    return (
        f"`{model}`: no step longer than {shortest:g} of the Rayleigh time, with which all are compared, is shown to"
        f" keep all within {PERCENT * LIMIT:g} % of it; shown is that {shown}. Intervals reach {PERCENT * widest:.0f} %"
        " to either side: what is undecided takes more packings"
    )


def results_page(table: pd.DataFrame) -> str:
    """Return the page; table: as in `answers`."""
    found = answers(table)
    told, first = limits(found), table.iloc[0]
    cost = ", ".join(f"`{model}` {ratio:.2f}" for model, ratio in costs(table).items())
    parts = [
        "# How long a time step, by rolling model",
        prose(
            "Generated by `python -m benchmarks.time_step_limits`; not to be edited. [Every run](time_step_limits.csv)."
        ),
        "\n".join(bullet(f"{said_of(row['model'], found, row)}.") for _, row in told.iterrows()),
        prose(
            f"A bed of some {first['particles']:.0f} particles of {CASE['particle_scale']:g} times the real size slides"
            f" at {VELOCITY:g} m/s over {first['travel_m']:g} m of channel, over a plain sample and over a convex one,"
            " whose front ends particles strike. Sliding work is what Archard's law is proportional to, impact energy"
            " what laws of impacts are. Change: against the shortest time step that ran, packings taken as blocks; how"
            " far that one is from still shorter ones is not known. A limit is the longest step that is shown to be"
            " within, where no shorter one is shown to be beyond; of shorter ones with few packings more is not known."
            f" It is told where every time step ran with {ENOUGH} packings at least."
        ),
        markdown(told),
        prose(f"Processor time of the solver at equal time steps, over `{first['model']}`: {cost}; not run in turn."),
        "![Change of sliding work and impact energy with the time step](time_step_limits.png)",
    ]
    for (model, surface, response), of in found.items():
        parts += [f"## {model}, {surface} sample, {RESPONSES[response]}", markdown(shown(of))]
    return "\n\n".join(part.rstrip("\n") for part in parts) + "\n"


def shown(found: pd.DataFrame) -> pd.DataFrame:
    """Return a table of `answers` as the page shows it, changes in per cent."""
    alone = found["runs"].max() < 2  # nothing tells of chance
    percent = {name: (PERCENT * found[name]).round(2) for name in ("change", "change_low", "change_high")}
    verdicts = found["verdict"].where(found["verdict"].eq(FAILED) | (not alone), UNDECIDED)
    return pd.DataFrame(
        {
            "time step over Rayleigh time (-)": found["value"],
            "packings": found["runs"],
            **{f"{name}_percent": values for name, values in percent.items()},
            "verdict": verdicts,
            "processor_s": found["processor_s"].round(1),
        }
    )
