"""Designs of a study side by side."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import UNKNOWN, Estimate, difference, estimate
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.postproc.wear.prediction import coefficient_reaches
from bulkwear.workflows.cases.equipment.life import WHOLE_PART, PartLife
from bulkwear.workflows.cases.equipment.phases import PRISTINE
from bulkwear.workflows.cases.equipment.tables import HOURS, Runs, with_ends

LIFE, POWER = "life", "power"
OF_LAW = ("law", "wear_coefficient_per_pa", "law_parameters")  # of a part: what one coefficient's error is of
COMPARED = {  # quantity: unit, and whether more of it is better; None: neither
    LIFE: ("h", True),
    "worst_recession": ("mm per 1,000 h", False),
    "steel_lost": ("kg/h", False),
    POWER: ("W", None),
}
DESIGNS = [
    *("quantity", "part", "setting", "unit", "packings", "value", "value_low", "value_high"),
    *("ratio", "ratio_low", "ratio_high", "verdict"),
]
FIRST, UNSAID = "first design", "cannot be said"


# ---------------------------------------------------------------- designs side by side


def designs_table(runs: Runs, lives: Mapping[tuple[str, str], PartLife]) -> pd.DataFrame:
    """Return a row per quantity, part and setting: its value and its ratio to that of the study's first setting.

    The packings of two settings share nothing, so ratios are of logarithms by Welch. verdict: whether the interval of
    the ratio says which is better. The error of a wear coefficient that both have is not in it; those of different
    coefficients or laws are, but for power.
    """
    rows, settings = [], runs.settings
    parts = dict.fromkeys(part for _, part in lives)
    for quantity, (unit, more_is_better) in COMPARED.items():
        for part in parts:
            found = {name: _between_packings(_compared(runs, lives, quantity, name, part)) for name in settings}
            first = found[settings[0]]
            for name, value in found.items():
                if value is None or not np.isfinite(value.value):
                    continue
                row = {"quantity": quantity, "part": part, "setting": name, "unit": unit, "packings": value.packings}
                row |= with_ends("value", value)
                alone = name == settings[0] or first is None or not np.isfinite(first.value)
                ratio = Estimate(np.nan, np.nan, 0, value.packings, log=True) if alone else difference(value, first)
                errors = () if alone or quantity == POWER else coefficient_errors(runs, part, name)
                low, high = ratio_ends(ratio, errors)
                said = FIRST if name == settings[0] else "" if alone else verdict(ratio, low, high, more_is_better)
                rows.append(row | {"ratio": ratio.value, "ratio_low": low, "ratio_high": high, "verdict": said})
    return pd.DataFrame(rows, columns=DESIGNS)


def coefficient_errors(runs: Runs, part: str, setting: str) -> tuple[float, ...]:
    """Return the errors (-, half widths over the coefficient) of the wear coefficients of a part in the first setting
    and in another one; none where both have one law, with equal parameters, and coefficient.
    """
    first, other = (runs.first(name)["parts"][part] for name in (runs.settings[0], setting))
    if all(first.get(key) == other.get(key) for key in OF_LAW):
        return ()
    return tuple(each["wear_coefficient_error"] or 0.0 for each in (first, other))


def ratio_ends(ratio: Estimate, errors: Sequence[float]) -> tuple[float, float]:
    """Return the 95 % interval of a ratio, its reaches joined with those of errors of coefficients as squares, in the
    logarithm; NaN where the scatter is not known. errors: as from `coefficient_errors`
    """
    further = sum(max(coefficient_reaches(error)) ** 2 for error in errors)
    low, high = (math.hypot(math.log(end / ratio.value), math.sqrt(further)) for end in ratio.interval())
    return ratio.value * math.exp(-low), ratio.value * math.exp(high)


def verdict(ratio: Estimate, low: float, high: float, more_is_better: bool | None) -> str:
    """Return whether a ratio to the first design says better or worse, larger or smaller where neither is better.

    low, high: ends of its interval
    """
    if not ratio.known:
        return UNKNOWN if ratio.packings < 2 else UNSAID
    if low <= 1.0 <= high:
        return UNSAID
    if more_is_better is None:
        return "larger" if low > 1.0 else "smaller"
    return "better" if (low > 1.0) == more_is_better else "worse"


def _compared(
    runs: Runs, lives: Mapping[tuple[str, str], PartLife], quantity: str, setting: str, part: str
) -> Estimate | None:
    """Return what is compared of a part of a setting, of the logarithm; None where the setting has no such part."""
    if (setting, part) not in lives:
        return None
    life = lives[setting, part]
    if quantity == LIFE:
        return life.life
    if quantity == "worst_recession" and life.patch == WHOLE_PART:
        return None
    if quantity == "worst_recession":
        return _times(life.recession, MILLIMETRES * HOURS)
    column = "worn_mass_kg_per_h" if quantity == "steel_lost" else "power_W"
    blocks = runs.parts[(runs.parts["setting"] == setting) & (runs.parts["part"] == part)]
    blocks = blocks[blocks["phase"] == PRISTINE]
    return estimate(blocks[column].abs().to_numpy(), blocks["packing"].to_numpy(), log=True)


def _between_packings(found: Estimate | None) -> Estimate | None:
    """Return an estimate with the scatter of packings alone: that of the blocks of one packing compares no designs."""
    if found is None or found.packings > 1:
        return found
    return Estimate(found.value, math.nan, 0, found.packings, found.log)


def _times(found: Estimate, factor: float) -> Estimate:
    """Return an estimate of the logarithm in another unit."""
    return Estimate(factor * found.value, found.error, found.freedom, found.packings, log=True)
