"""What a study of equipment found, in sentences: which design is better, what wear changes, what was worn through."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.statistics.steady import DRIFTING, STEADY
from bulkwear.postproc.statistics.steady import UNSAID as NOT_SAID
from bulkwear.postproc.tables.summary import THROUGH
from bulkwear.workflows.cases.equipment.comparison import FIRST, LIFE, UNSAID
from bulkwear.workflows.cases.equipment.life_findings import (
    FROM_ONE,
    PER_CENT,
    answers_on_first_change,
    answers_on_life,
    changed_rate_words,
    rounded,
    span,
)
from bulkwear.workflows.cases.equipment.phases import PRISTINE
from bulkwear.workflows.report.sentences import listed, spoken

Tables = Mapping[str, pd.DataFrame]
SMALLEST_CHANGE = 0.1  # %, below which a change is called none
STEADINESS = {STEADY: "steady", DRIFTING: "not steady", NOT_SAID: "not known to be steady"}
SAME_FEED = 1e-6  # -, relative: numbers of tables have nine digits
CANNOT_BE_SAID = "which is better cannot be said"
RATIOS = {  # quantity of the table of designs: what a part does in its ratio
    LIFE: "lasts {ratio} times as long",
    "steel_lost": "loses {ratio} times as much steel per hour",
}
CHANGES = {  # quantity of the table of loads: verb and noun
    "power_W": ("takes", "power"),
    "worn_mass_kg_per_h": ("loses", "steel per hour"),
}


def answers_on_designs(designs: pd.DataFrame, life: pd.DataFrame) -> list[str]:
    """Return how each design compares with the first one, whether the interval says which is better, and whose life
    hangs on a rate that wear was changing.
    """
    found, feeds = [], feeds_of(life)
    changing = {(row.setting, row.part): changed_rate_words(row) for _, row in life.iterrows()}
    for quantity, words in RATIOS.items():
        rows = designs[designs["quantity"] == quantity]
        first = rows.loc[rows["verdict"] == FIRST].set_index("part")["setting"]
        for _, row in rows[(rows["verdict"] != FIRST) & rows["ratio"].notna()].iterrows():
            told = words.format(ratio=rounded(row.ratio, 3))
            than = f"The {spoken(row.part)} of {row.setting} {told} as that of {first[row.part]}"
            found.append(f"{than} ({ratio_words(row)}): {verdict_words(row)}.")
            hanging = [name for name in (row.setting, first[row.part]) if changing.get((name, row.part))]
            feed = feeds.get(row.setting, math.nan) / feeds.get(first[row.part], math.nan)
            found[-1] += per_mt_words(row, feed)
            if quantity == LIFE and hanging:
                found[-1] += f" That is if the last rate of {listed(hanging)} goes on, which wear was changing."
    return found


def feeds_of(life: pd.DataFrame) -> dict[str, float]:
    """Return what each setting is fed (Mt/h), by the lives that are known in h and Mt."""
    known = life[np.isfinite(life["life_h"]) & np.isfinite(life["life_Mt"])]
    return (known["life_Mt"] / known["life_h"]).groupby(known["setting"]).first().to_dict()


def per_mt_words(row: pd.Series, feed: float) -> str:
    """Return the ratio of a life in Mt, or of the steel lost per Mt, of a design that is fed at another rate than the
    first one; nothing where both have one rate or none. feed: the design's rate over the first one's
    """
    if not math.isfinite(feed) or math.isclose(feed, 1.0, rel_tol=SAME_FEED):
        return ""
    lasts = row.quantity == LIFE
    factor = feed if lasts else 1.0 / feed
    scaled = row.copy()
    for name in ("ratio", "ratio_low", "ratio_high"):
        scaled[name] = factor * row[name]
    if not np.isfinite(scaled.ratio_low) or scaled.ratio_low <= 1.0 <= scaled.ratio_high:
        said = CANNOT_BE_SAID
    else:
        said = f"that is {'better' if (scaled.ratio_low > 1.0) == lasts else 'worse'}"
    what = "its life in Mt is" if lasts else "per Mt it loses"
    ratio = f"{rounded(scaled.ratio, 3)} times {'that' if lasts else 'as much'} ({ratio_words(scaled)})"
    return f" It is fed {rounded(feed, 3)} times as much; {what} {ratio}: {said}."


def ratio_words(row: pd.Series) -> str:
    """Return the interval of a ratio."""
    if not np.isfinite(row.ratio_low):
        return UNKNOWN if row.packings <= FROM_ONE else "scatter unknown"
    return f"{span(row.ratio_low, row.ratio_high, digits=3)}, {PER_CENT}"


def verdict_words(row: pd.Series) -> str:
    """Return what the interval of a ratio says."""
    if row.verdict in (UNSAID, UNKNOWN):
        return CANNOT_BE_SAID
    return f"that is {row.verdict}, and the interval says so"


def answers_on_worn_shape(loads: pd.DataFrame) -> list[str]:
    """Return what the worn shape changes: power of moving parts, steel lost by those that wear.

    Changes that are not shown to be any are left out. What may be 0 as built, or turns round, has none in per cent.
    """
    found, several = [], loads["setting"].nunique() > 1
    for _, row in loads[loads["quantity"].isin(list(CHANGES))].iterrows():
        nothing = row.pristine_low <= 0.0 <= row.pristine_high
        unshown = row.change_percent_low <= 0.0 <= row.change_percent_high
        if not row.worn * row.pristine > 0.0 or nothing or unshown:
            continue
        who = f"{f'Design {row.setting}: the' if several else 'The'} {spoken(row.part)} as worn"
        verb, what = CHANGES[row.quantity]
        size, more = abs(row.change_percent), "more" if row.change_percent >= 0.0 else "less"
        if size < SMALLEST_CHANGE:
            found.append(f"{who} {verb} as much {what} as built, within {SMALLEST_CHANGE:g} %.")
        else:
            found.append(f"{who} {verb} {rounded(size)} % {more} {what} than as built ({change_words(row)}).")
    return found


def answers_on_lifters(lifters: pd.DataFrame) -> list[str]:
    """Return how far the lifters of each mill lean and stand out as built and after the last update of their shape."""
    found, several = [], lifters["setting"].nunique() > 1
    for (setting, part), rows in lifters.dropna(subset=["height_mm"]).groupby(["setting", "part"], sort=False):
        built, worn = rows.iloc[0], rows.iloc[-1]
        if len(rows) < 2:
            continue
        who = f"{f'Design {setting}: the' if several else 'The'} leading faces of the {spoken(part)}'s lifters"
        after = f"after {rounded(worn.operation_h)} h"
        faces, crests = (
            f"{rounded(built[name])} {unit} as built and {rounded(worn[name])} {unit} {then}{_ends(worn, name)}"
            for name, unit, then in (("leading_face_angle_deg", "degrees", after), ("height_mm", "mm", "then"))
        )
        found.append(f"{who} lean back by {faces}; the crests stand out of the plates, which wear too, by {crests}.")
    return found


def _ends(row: pd.Series, name: str) -> str:
    low, high = row[f"{name}_low"], row[f"{name}_high"]
    return f" ({span(low, high, digits=3)}, {PER_CENT})" if np.isfinite(low) else f" ({UNKNOWN})"


def change_words(row: pd.Series) -> str:
    """Return the interval of a change."""
    low, high = row.change_percent_low, row.change_percent_high
    if not np.isfinite(low):
        return UNKNOWN if row.packings <= FROM_ONE else "scatter unknown"
    return f"change {span(low, high, '%')}, {PER_CENT}"


# ---------------------------------------------------------------- flow, balance, worn through


def answers_on_flow(flow: pd.DataFrame) -> list[str]:
    """Return whether the flow of each setting is steady on the shape as built, and its means."""
    found, several = [], flow["setting"].nunique() > 1
    for setting, rows in flow[flow["phase"] == PRISTINE].groupby("setting", sort=False):
        counts, whose = rows["answer"].value_counts(), f" of design {setting}" if several else ""
        told = STEADINESS[counts.index[0]]
        if len(rows) > 1:
            told = ", ".join(f"{STEADINESS[word]} in {count}" for word, count in counts.items())
            told += f" of {len(rows)} packings"
        mean = rows.mean(numeric_only=True)
        flows = mean["out_t_per_h"] > 0.0
        held = f"{rounded(mean['held_kg'], 3)} kg are held"
        rates = f"{rounded(mean['in_t_per_h'], 3)} t/h come in, {rounded(mean['out_t_per_h'], 3)} t/h go out, "
        stay = f", each for {rounded(mean['residence_s'])} s" if flows else ""
        found.append(f"The flow{whose} is {told}: {rates if flows else ''}{held}{stay}.")
    return found


def answer_on_balance(balance: pd.DataFrame) -> str:
    """Return whether every particle is accounted for."""
    missing = balance[balance["missing"] != 0]
    if missing.empty:
        runs = balance["run"].nunique()
        cycles = f"{len(balance)} cycles of {f'{runs} runs' if runs > 1 else 'the run'}"
        return f"No particle is missing in any of {cycles}: what came in was there or had gone out through an outlet."
    cases = ", ".join(f"{row.missing} in cycle {row.cycle} of {row.run}" for row in missing.itertuples())
    return f"Particles are missing: {cases}."


def answers_on_holes(summary: pd.DataFrame) -> list[str]:
    """Return which runs are worn through somewhere, and after how many hours of operation."""
    if THROUGH not in summary:
        return []
    through = summary[summary[THROUGH] > 0]
    return [
        f"In run {row.run} a first place has no thickness left by {rounded(row.through_h)} h: {row.through_said}. "
        "Lives are told by mean depths of patches: a thin edge or a deep spot goes before."
        for row in through.itertuples()
    ]


def all_answers(tables: Tables, summary: pd.DataFrame) -> list[str]:
    """Return the answers of a study in the order in which its page gives them: what decides, then all in detail."""
    ratios = answers_on_designs(tables["designs"], tables["life"])
    open_ = [said for said in ratios if CANNOT_BE_SAID in said]
    return [
        *answers_on_first_change(tables["life"], tables["steel"]),
        *(said for said in ratios if said not in open_),
        *answers_on_holes(summary),
        *answers_on_life(tables["life"]),
        *open_,
        *answers_on_worn_shape(tables["loads"]),
        *(answers_on_lifters(tables["lifters"]) if "lifters" in tables else []),
        *answers_on_flow(tables["flow"]),
        answer_on_balance(tables["mass_balance"]),
    ]
