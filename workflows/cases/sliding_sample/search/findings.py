"""What the figures of a search show, in one sentence each, from the tables beside them."""

from __future__ import annotations

import pandas as pd

from bulkwear.workflows.report.sentences import with_interval
from bulkwear.workflows.report.text import name_and_unit, number

DIGITS = 2  # significant, of ratios in words


def lowest_tried(record: pd.DataFrame) -> str:
    """Return the lowest of the patterns in the most packings of which enough is left, and how many were tried: one in
    fewer packings may be the lowest by luck; record: `record.record_table`.
    """
    sound = record[record["enough_left"] == "yes"]
    tried = f"{len(record)} patterns were tried"
    if sound.empty:
        return f"{tried}; of none is enough left."
    sound = sound[sound["packings"] == sound["packings"].max()]
    best = sound.loc[sound["wear_over_plain"].idxmin()]
    ratio = with_interval(best["wear_over_plain"], best["interval_low"], best["interval_high"], best["packings"])
    return (
        f"{tried}; of those in the most packings of which enough is left {best['setting']} wears least,"
        f" {ratio} of plain."
    )


def strongest_factor(table: pd.DataFrame) -> str:
    """Return along which factor the predicted wear changes most; table: as from `results.slices`."""
    ends = table.groupby("factor", sort=False)["predicted"].agg(["min", "max"])
    name = (ends["max"] / ends["min"]).idxmax()
    low, high = (number(ends.loc[name, end], DIGITS) for end in ("min", "max"))
    return f"About the best pattern wear over plain changes most with {name_and_unit(name)[0]}: {low} to {high}."
