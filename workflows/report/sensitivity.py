"""Sobol indices on a page: the table of several responses, and what is said of it.

A row per response and factor: `response`, `factor`, first and total index with their intervals, `reason` why a response
has none, in a row without a factor.
"""

from __future__ import annotations

import math
from pathlib import Path

import pandas as pd

from bulkwear.postproc.plots.chart import BARS, Axis, Layer, one_panel
from bulkwear.postproc.statistics.sensitivity import COLUMNS
from bulkwear.workflows.report.sections import Block, Points, Table
from bulkwear.workflows.report.sentences import PERCENT, capital

RESPONSE, REASON = "response", "reason"
WIDEST = 0.8  # -, interval of a share of the variance beyond which it tells nothing
HEADS = {
    "first": ("alone", "-"),
    "first_low": ("alone, from", "-"),
    "first_high": ("to", "-"),
    "total": ("with interactions", "-"),
    "total_low": ("with interactions, from", "-"),
    "total_high": ("to", "-"),
}
KINDS = {"first": "alone", "total": "with interactions"}  # of an index: entries of the legend
CHART = one_panel(
    Axis("Factor"),
    Axis("Part of the variance", "-"),
    *(
        Layer(BARS, kind, "factor", low=f"{kind}_low", high=f"{kind}_high", name=name, said=f"Index {name}")
        for kind, name in KINDS.items()
    ),
    split=RESPONSE,
    colours={KINDS["first"]: "BLUE", KINDS["total"]: "ORANGE"},
)
NOTE = (
    "Sobol indices: part of the response's variance that a factor makes over the range of the design, alone (first "
    "order) and with all its interactions (total). All factors vary evenly and independently over their ranges; the "
    "95 % intervals hold the error of the surrogate and that of the sample."
)


def refused(response: str, reason: str) -> pd.DataFrame:
    """Return the row of a response without indices."""
    return pd.DataFrame([{RESPONSE: response, **dict.fromkeys(COLUMNS[1:], math.nan), "factor": "", REASON: reason}])


def read_indices(path: Path) -> pd.DataFrame:
    """Return a table of indices; cells of words that are empty are empty words."""
    return pd.read_csv(path, dtype={RESPONSE: str, "factor": str, REASON: str}).fillna({"factor": "", REASON: ""})


def finding(table: pd.DataFrame) -> str:
    """Return of each response which factor decides most and whether factors act together, or why that is not told."""
    said = []
    for response, rows in table.groupby(RESPONSE, sort=False):
        known = rows.dropna(subset="total")
        if known.empty:
            said.append(f"Of {response} no index is told: {rows[REASON].iloc[0]}.")
            continue
        most = known.loc[known["total"].idxmax()]
        if len(known) > 1 and (known["total"] > 0.0).sum() == 1:
            said.append(f"Of {response} the model holds {most['factor']} alone, so that there are no shares to tell.")
            continue
        ends = f"{PERCENT * most['first_low']:.0f} to {PERCENT * most['first_high']:.0f} %"
        if most["first_high"] - most["first_low"] > WIDEST:
            said.append(
                f"Which factor decides {response} cannot be said: {most['factor']} alone makes {ends} of its variance"
                " (95 % interval)."
            )
            continue
        together = PERCENT * max(1.0 - known["first"].sum(), 0.0)
        said.append(
            f"Of the variance of {response} over the design {most['factor']} alone makes"
            f" {PERCENT * most['first']:.0f} % (95 % interval {ends}), with its interactions"
            f" {PERCENT * most['total']:.0f} %; factors together make {together:.0f} %."
        )
    return capital(" ".join(said))


def sensitivity_blocks(table: pd.DataFrame) -> list[Block]:
    """Return the indices of a page and what is said of them."""
    shown = table.dropna(subset="total")[[RESPONSE, *COLUMNS]]
    rows = [Table(shown, "sensitivity", NOTE, heads=HEADS)] if len(shown) else []
    return [Points([finding(table[table[RESPONSE] == each]) for each in table[RESPONSE].unique()]), *rows]
