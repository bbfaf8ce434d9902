"""Packings that are added until an interval is narrow enough, within a budget: what a study asks, and what comes next.

    until: {width_fraction: 0.05, most_packings: 20, most_core_h: 8}

A round looks at the runs there are and says how many packings each setting shall have; the next one looks at those.
Rows of a design with a number of packings of their own keep it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.intervals import Estimate, estimates
from bulkwear.postproc.statistics.sequential import FEWEST, next_number
from bulkwear.postproc.tables.packings import BY

UNTIL = "until"  # key of the settings
GOALS = ("width_fraction", "most_packings", "most_core_h")


@dataclass(frozen=True)
class Until:
    """What a study asks of its intervals.

    width: -, of the whole 95 % interval over its mean; most_packings: of a setting; most_core_h: of the solver, all
    runs and beds together
    """

    width: float
    most_packings: int
    most_core_h: float

    def said(self, study: str) -> str:
        """Return in a sentence what will be done."""
        return (
            f"{study}: packings are added until the 95 % interval of every setting is {100.0 * self.width:g} % of its"
            f" mean wide, {self.most_packings} packings of a setting and {self.most_core_h:g} core hours at most."
        )


def until_of(settings: Mapping[str, Any]) -> Until | None:
    """Return what the settings ask of intervals, None where packings are a fixed number."""
    told = settings.get(UNTIL)
    if told is None:
        return None
    return Until(told["width_fraction"], told["most_packings"], told["most_core_h"])


def answers(summary: pd.DataFrame) -> dict[str, Estimate]:
    """Return {setting: estimate} of what a study tells: patterned over plain wear in the same bed, and where there are
    no twins the worn volume; of several surfaces the one with the widest interval.

    summary: as from `summary.summary_table`
    """
    twins = summary[(summary["surface"] != PLAIN) & summary["wear_over_plain"].notna()]
    table, column = (twins, "wear_over_plain") if len(twins) else (summary, "worn_volume_m3")
    keys = pd.MultiIndex.from_frame(table[list(BY)]).to_flat_index()
    found: dict[str, Estimate] = {}
    for (setting, _), one in estimates(keys, table[column], log=True).items():
        known = found.get(setting)
        if known is None or (known.known and (not one.known or one.width() > known.width())):
            found[setting] = one
    return found


def next_round(
    until: Until,
    found: Mapping[str, Estimate],
    packings: Mapping[str, int],
    possible: Mapping[str, int],
    finished: Mapping[str, bool],
    hours: float,
) -> dict[str, Any]:
    """Return what a round decides, JSON-able: `packings` by setting, which settings are `finished`, whether that is
    `enough`, the `widths` (-) there are, and a sentence.

    found: by setting that is looked at; packings: that there are, by number; possible: that a setting has rows for,
    which is what there is of one with a number of its own
    finished: settings whose last packings these are; hours: core hours that the solver has taken for all of them
    """
    wanted, last = dict(packings), {name: finished.get(name, False) for name in found}
    for name, one in found.items():
        if not last[name]:
            number, last[name] = next_number(one, until.width, until.most_packings)
            without_value = packings[name] - one.packings
            wanted[name] = max(min(number + without_value, until.most_packings, possible[name]), packings[name])
            last[name] |= wanted[name] == packings[name]
    added = sum(wanted[name] - packings[name] for name in packings)
    share = hours / max(sum(packings.values()), 1)
    short = added > 0 and hours + added * share > until.most_core_h
    if short:
        wanted, last = dict(packings), dict.fromkeys(last, True)
        added = 0
    widths = {name: one.width() for name, one in found.items() if one.known}
    widest = max(widths, key=widths.get, default="")
    percent = 100.0 * widths.get(widest, 0.0)
    told = f"{percent:.0f}" if percent >= 100.0 else f"{percent:.2g}"
    said = f"widest interval: {told} % of {widest}" if widest else "no interval yet"
    said += f" with {packings[widest]} packings" if widest else ""
    if short:
        said += f"; the budget of {until.most_core_h:g} core hours ends here, {hours:.2g} are used"
    said += f"; {added} packing{'s' * (added > 1)} more" if added else "; no more packings"
    enough = added == 0 or all(last.values())
    return {"packings": wanted, "finished": last, "enough": enough, "widths": widths, "said": said}


def first_packings(until: Until | None, packings: Mapping[str, int], own: Mapping[str, bool]) -> dict[str, int]:
    """Return how many packings settings have in the first round; packings: without `until`; own: whether a setting has
    a number of its own.
    """
    if until is None:
        return dict(packings)
    least = min(FEWEST, until.most_packings)
    return {name: number if own[name] else max(number, least) for name, number in packings.items()}
