"""What a study of equipment found on lives, in sentences: when each part is changed, why, which is changed first."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import CONFIDENCE, UNKNOWN
from bulkwear.workflows.cases.equipment.life import AS_BUILT, EXTRAPOLATED, FOLLOWED, NO_WEAR, PARTLY, WHOLE_PART
from bulkwear.workflows.report.sentences import listed, spoken

TOO_WIDE = 100.0  # -, of the ends of an interval that tells nothing
DIGITS = 2  # significant ones of an answer, whose interval is wide
LEAST_RATE_CHANGE = 1.1  # -, factor of a rate by wear of the shape, from which on its further change is asked for
FROM_ONE = 1.0  # number of packings of which the scatter is unknown
OF_ONE_COEFFICIENT = ("material", "law", "wear_coefficient_per_pa")  # parts alike in them have one error of it
PER_CENT = f"{100.0 * CONFIDENCE:.0f} %"
RUNNING = "the wear is not spread along the way that it goes round, so that its life is too short"


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


def answers_on_first_change(life: pd.DataFrame, steel: pd.DataFrame) -> list[str]:
    """Return of each setting which part has the shortest life, and whether it is surely changed first; nothing where
    each has one part alone. Parts that wear and whose life cannot be said may be changed earlier.

    steel: with OF_ONE_COEFFICIENT of each part: parts alike in them share the error of their coefficient, which decides
        nothing then
    """
    known = life[np.isfinite(life["life_h"])].merge(steel[["setting", "part", *OF_ONE_COEFFICIENT]], how="left")
    if not known.duplicated("setting").any():
        return []
    several, said = life["setting"].nunique() > 1, []
    for setting, rows in known.groupby("setting", sort=False):
        first, *others = (row for _, row in rows.sort_values("life_h", kind="stable").iterrows())
        who = f"{f'Design {first.setting}: the' if several else 'The'} {spoken(first.part)}"
        after = f"{rounded(first.life_h)} h ({interval_words(first)})"
        unknown = without_life(life[life["setting"] == setting])
        if open_ := [f"the {spoken(row.part)}" for row in others if not lasts_longer(row, first)]:
            before = f"whether {' or '.join([*open_, *unknown])} is changed before it cannot be said"
            said.append(f"{who} has the shortest life, {after}; {before}.")
        else:
            said.append(f"{who} is changed first, after {after}{unless_words(unknown)}.")
    return said


def lasts_longer(row: pd.Series, first: pd.Series) -> bool:
    """Return whether a part surely lasts longer than another one, by the interval of the ratio of their lives: the
    reaches of both towards each other joined as squares, in the logarithm. Never by one packing.
    """
    if not min(row.packings, first.packings) > FROM_ONE:
        return False
    one = all(row[name] == first[name] for name in OF_ONE_COEFFICIENT)
    interval = "scatter" if one else "life"
    reaches = (math.log(row.life_h / row[f"{interval}_low_h"]), math.log(first[f"{interval}_high_h"] / first.life_h))
    return math.log(row.life_h / first.life_h) > math.hypot(*reaches)


def without_life(life: pd.DataFrame) -> list[str]:
    """Return the names of parts that wear and whose life cannot be said."""
    open_ = life[~np.isfinite(life["life_h"]) & (life["reason"] != NO_WEAR)]
    return [f"the {spoken(part)}" for part in open_["part"]]


def unless_words(parts: Sequence[str]) -> str:
    """Return that parts whose life cannot be said may be changed earlier; nothing without such parts."""
    if not parts:
        return ""
    several = len(parts) > 1
    verb, they = ("are", "they last") if several else ("is", "it lasts")
    return f", unless {listed(parts)} {verb}: how long {they} is open"


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
    unknown = UNKNOWN if row.packings <= FROM_ONE else "scatter unknown"
    if ends[1] > TOO_WIDE * ends[0]:
        too_few = f"do not tell it within a factor of {TOO_WIDE:g}"
        return f"{row.packings} packings {too_few}" if row.packings > FROM_ONE else f"{unknown}; its blocks {too_few}"
    if row.packings > FROM_ONE and np.isfinite(ends[0]):
        return f"{span(*ends, 'h')}, {PER_CENT}"
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
    """Return whether a part lasts as long as the study asks for, of one packing for that one alone; nothing where it
    asks for no hours.
    """
    if not row.asked_h > 0.0:
        return ""
    asked = f"the {rounded(row.asked_h)} h that are asked for"
    known = np.isfinite(row.life_low_h)  # of one packing by its blocks, or by the coefficient alone
    ends = (row.life_low_h, row.life_high_h) if known else (row.coefficient_low_h, row.coefficient_high_h)
    if ends[0] <= row.asked_h <= ends[1]:
        return f"Whether it lasts {asked} cannot be said."
    it = "It" if row.packings > FROM_ONE else "By this one packing it"
    return f"{it} {'lasts' if row.life_h >= row.asked_h else 'does not last'} {asked}."


def cards(life: pd.DataFrame) -> list[tuple[str, str]]:
    """Return the life of each part as a number and what it is."""
    found, several = [], life["setting"].nunique() > 1
    for _, row in life[np.isfinite(life["life_h"])].iterrows():
        of = f", design {row.setting}" if several else ""
        found.append(
            (f"{rounded(row.life_h)} h", f"until the {spoken(row.part)} is changed{of}: {interval_words(row)}")
        )
    return found
