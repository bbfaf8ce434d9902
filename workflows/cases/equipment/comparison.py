"""Designs of a study side by side."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

from bulkwear.postproc.statistics.intervals import UNKNOWN, Estimate, difference, estimate
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.workflows.cases.equipment.life import WHOLE_PART, PartLife
from bulkwear.workflows.cases.equipment.phases import PRISTINE
from bulkwear.workflows.cases.equipment.tables import HOURS, Runs, with_ends

LIFE = "life"
COMPARED = {  # quantity: unit, and whether more of it is better; None: neither
    LIFE: ("h", True),
    "worst_recession": ("mm per 1,000 h", False),
    "steel_lost": ("kg/h", False),
    "power": ("W", None),
}
FIRST, UNSAID = "first design", "cannot be said"


# ---------------------------------------------------------------- designs side by side


def designs_table(runs: Runs, lives: Mapping[tuple[str, str], PartLife]) -> pd.DataFrame:
    """Return a row per quantity, part and setting: its value and its ratio to that of the study's first setting.

    The packings of two settings share nothing, so ratios are of logarithms by Welch. verdict: whether the interval of
    the ratio says which is better. The coefficient's own error, which both have, is not in them.
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
                said = FIRST if name == settings[0] else "" if alone else verdict(ratio, more_is_better)
                rows.append(row | with_ends("ratio", ratio) | {"verdict": said})
    return pd.DataFrame(rows)


def verdict(ratio: Estimate, more_is_better: bool | None) -> str:
    """Return whether a ratio to the first design says better or worse, larger or smaller where neither is better."""
    if not ratio.known:
        return UNKNOWN if ratio.packings < 2 else UNSAID
    low, high = ratio.interval()
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
