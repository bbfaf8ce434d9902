"""What a study of equipment found, in sentences: when parts are changed, which design is better, what wear changes."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import CONFIDENCE, UNKNOWN
from bulkwear.postproc.statistics.steady import DRIFTING, STEADY
from bulkwear.postproc.statistics.steady import UNSAID as NOT_SAID
from bulkwear.postproc.tables.summary import THROUGH
from bulkwear.workflows.cases.equipment.comparison import FIRST, LIFE, UNSAID
from bulkwear.workflows.cases.equipment.life import AS_BUILT, EXTRAPOLATED, FOLLOWED, NO_WEAR, PARTLY, WHOLE_PART
from bulkwear.workflows.cases.equipment.phases import PRISTINE
from bulkwear.workflows.report.sentences import listed, spoken

Tables = Mapping[str, pd.DataFrame]
TOO_WIDE = 100.0  # -, of the ends of an interval that tells nothing
DIGITS = 2  # significant ones of an answer, whose interval is wide
SMALLEST_CHANGE = 0.1  # %, below which a change is called none
LEAST_RATE_CHANGE = 1.1  # -, factor of a rate by wear of the shape, from which on its further change is asked for
STEADINESS = {STEADY: "steady", DRIFTING: "not steady", NOT_SAID: "not known to be steady"}
SAME_FEED = 1e-6  # -, relative: numbers of tables have nine digits
FROM_ONE = 1.0  # number of packings of which the scatter is unknown
PER_CENT = f"{100.0 * CONFIDENCE:.0f} %"
CANNOT_BE_SAID = "which is better cannot be said"
RATIOS = {  # quantity of the table of designs: what a part does in its ratio
    LIFE: "lasts {ratio} times as long",
    "steel_lost": "loses {ratio} times as much steel per hour",
}
RUNNING = "the wear is not spread along the way that it goes round, so that its life is too short"
CHANGES = {  # quantity of the table of loads: verb and noun
    "power_W": ("takes", "power"),
    "worn_mass_kg_per_h": ("loses", "steel per hour"),
}


def rounded(value: float, digits: int = DIGITS) -> str:
    """Return a number with few digits, thousands apart by commas: 5,200."""
    if not math.isfinite(value):
        return "an unknown number of"
    if value == 0.0:
        return "0"
    decimals = digits - 1 - math.floor(math.log10(abs(value)))
    return f"{round(value, decimals):,.{max(decimals, 0)}f}"


def span(low: float, high: float, unit: str = "", digits: int = DIGITS) -> str:
    """Return the ends of an interval, 4,100 to 6,700 h."""
    return f"{rounded(low, digits)} to {rounded(high, digits)}{f' {unit}' if unit else ''}"


# ---------------------------------------------------------------- life


def answers_on_life(life: pd.DataFrame) -> list[str]:
    """Return when each part of each setting is changed, where it decides and how that is known; then what that means
    of parts whose surface runs.
    """
    several = life["setting"].nunique() > 1
    running = dict.fromkeys(life.loc[life["surface_runs"], "part"])
    return [
        *(life_sentence(row, several) for _, row in life.iterrows()),
        *(f"The surface of the {spoken(part)} runs, and is worn where it stands: {RUNNING}." for part in running),
    ]


def answers_on_first_change(life: pd.DataFrame) -> list[str]:
    """Return of each setting which part is changed first, and when; nothing where each has one part alone. Parts that
    wear and whose life cannot be said may be changed earlier.
    """
    known = life[np.isfinite(life["life_h"])]
    if not known.duplicated("setting").any():
        return []
    rows = known.loc[known.groupby("setting", sort=False)["life_h"].idxmin()]
    several = life["setting"].nunique() > 1
    return [
        f"{f'Design {row.setting}: the' if several else 'The'} {spoken(row.part)} is changed first, after "
        f"{rounded(row.life_h)} h ({interval_words(row)}){unless_words(life[life['setting'] == row.setting])}."
        for _, row in rows.iterrows()
    ]


def unless_words(life: pd.DataFrame) -> str:
    """Return that parts whose life cannot be said may be changed earlier; nothing where there are none that wear."""
    open_ = life[~np.isfinite(life["life_h"]) & (life["reason"] != NO_WEAR)]
    if open_.empty:
        return ""
    names = listed([f"the {spoken(part)}" for part in open_["part"]])
    several = len(open_) > 1
    return f", unless {names} {'are' if several else 'is'}: how long {'they last' if several else 'it lasts'} is open"


def life_sentence(row: pd.Series, several: bool) -> str:
    """Return the sentences on the life of a part; several: whether the study has other designs."""
    who = f"{f'Design {row.setting}: the' if several else 'The'} {spoken(row.part)}"
    if isinstance(row.reason, str) and row.reason:
        return f"{who}: how long it lasts cannot be said, because {row.reason}."
    further = [f"{rounded(row[f'life_{unit}'])} {unit}" for unit in ("Mt", "years") if np.isfinite(row[f"life_{unit}"])]
    after = ", ".join([f"{rounded(row.life_h)} h ({interval_words(row)})", *further])
    said = [f"{who} has to be changed after {after}; {place_words(row)}.", how_words(row), asked_words(row)]
    said += [earlier_words(row), faster_words(row)]
    return " ".join(filter(None, said))


def interval_words(row: pd.Series) -> str:
    """Return the interval of a life, or what is known of it from one packing."""
    ends = row.life_low_h, row.life_high_h
    if row.packings > FROM_ONE and np.isfinite(ends[0]):
        if ends[1] > TOO_WIDE * ends[0]:
            return f"{row.packings} packings do not tell it within a factor of {TOO_WIDE:g}"
        return f"{span(*ends, 'h')}, {PER_CENT}"
    unknown = UNKNOWN if row.packings <= FROM_ONE else "scatter unknown"
    if np.isfinite(ends[0]):
        return f"{unknown}; its own blocks and the coefficient give {span(*ends, 'h')}"
    if row.coefficient_error > 0.0:
        return f"{unknown}; the coefficient alone gives {span(row.coefficient_low_h, row.coefficient_high_h, 'h')}"
    return unknown


def place_words(row: pd.Series) -> str:
    """Return where the worst place is and how fast it wears; by its mass the whole part decides."""
    if row.patch == WHOLE_PART:
        return "its whole mass decides"
    place = coordinates(row)
    worn = f", {rounded(row.worn_mm_per_1000h)} mm as worn" if row.how != AS_BUILT else ""
    rate = f"{rounded(row.pristine_mm_per_1000h)} mm per 1,000 h as built{worn}"
    return f"its worst place is at ({place}) mm of its drawing and loses {rate}"


def coordinates(row: pd.Series, which: str = "") -> str:
    """Return the coordinates of a place in mm, of the columns <which>x_mm and so on."""
    return ", ".join(f"{round(row[f'{which}{axis}_mm']):,}" for axis in "xyz")


def earlier_words(row: pd.Series) -> str:
    """Return what one packing alone would have changed much earlier; nothing where there is no such place."""
    if not np.isfinite(row.earlier_h):
        return ""
    return (
        f"In packing {row.earlier_packing:g} alone the place at ({coordinates(row, 'earlier_')}) mm would be changed "
        f"after {rounded(row.earlier_h)} h: how often that happens, so few blocks cannot tell."
    )


def faster_words(row: pd.Series) -> str:
    """Return which place without a life wears faster than the one that decides, and why it has none; nothing where
    there is none.
    """
    if not np.isfinite(row.faster_mm_per_1000h):
        return ""
    rate = f"{rounded(row.faster_mm_per_1000h)} mm per 1,000 h"
    where = coordinates(row, "faster_")
    why = "its thickness is not known"
    if np.isfinite(row.faster_thickness_mm):
        why = f"the {rounded(row.faster_thickness_mm)} mm that it has as built are no more than what shall remain"
    return f"The place at ({where}) mm loses more, {rate}, and is left out, because {why}."


def how_words(row: pd.Series) -> str:
    """Return as far as which hour the shape was worn, and what goes on from there."""
    hours = rounded(row.simulated_h)
    rate = f"the last rate goes on{changed_rate_words(row)}"
    return {
        FOLLOWED: "The shape was worn until then.",
        PARTLY: f"The shape was worn for {hours} h, until then in some packings; in the others {rate}.",
        EXTRAPOLATED: f"The shape was worn for {hours} h; from there on {rate}.",
        AS_BUILT: "That is by the rate as built: the shape was not worn.",
    }[row.how]


def changed_rate_words(row: pd.Series) -> str:
    """Return how far wear has changed a rate that goes on; nothing where it was followed or hardly changed."""
    factor = row.worn_over_built
    if row.how not in (PARTLY, EXTRAPOLATED) or not np.isfinite(factor):
        return ""
    if not max(factor, 1.0 / factor if factor > 0.0 else math.inf) > LEAST_RATE_CHANGE:
        return ""
    return f", {rounded(factor)} times that as built: a further change is in no interval"


def asked_words(row: pd.Series) -> str:
    """Return whether a part lasts as long as the study asks for; nothing where it asks for no hours."""
    if not row.asked_h > 0.0:
        return ""
    asked = f"the {rounded(row.asked_h)} h that are asked for"
    known = np.isfinite(row.life_low_h)  # of one packing by its blocks, or by the coefficient alone
    ends = (row.life_low_h, row.life_high_h) if known else (row.coefficient_low_h, row.coefficient_high_h)
    if ends[0] <= row.asked_h <= ends[1]:
        return f"Whether it lasts {asked} cannot be said."
    return f"It {'lasts' if row.life_h >= row.asked_h else 'does not last'} {asked}."


def cards(life: pd.DataFrame) -> list[tuple[str, str]]:
    """Return the life of each part as a number and what it is."""
    found, several = [], life["setting"].nunique() > 1
    for _, row in life[np.isfinite(life["life_h"])].iterrows():
        of = f", design {row.setting}" if several else ""
        found.append(
            (f"{rounded(row.life_h)} h", f"until the {spoken(row.part)} is changed{of}: {interval_words(row)}")
        )
    return found


# ---------------------------------------------------------------- designs, worn shape


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
        *answers_on_first_change(tables["life"]),
        *(said for said in ratios if said not in open_),
        *answers_on_holes(summary),
        *answers_on_life(tables["life"]),
        *open_,
        *answers_on_worn_shape(tables["loads"]),
        *(answers_on_lifters(tables["lifters"]) if "lifters" in tables else []),
        *answers_on_flow(tables["flow"]),
        answer_on_balance(tables["mass_balance"]),
    ]
