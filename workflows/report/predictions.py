"""Predictions of absolute wear on a page: a row each, with the interval that joins packings and wear coefficient."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import pandas as pd

from bulkwear.postproc.statistics.intervals import UNKNOWN, Estimate
from bulkwear.postproc.wear.prediction import Prediction, predicted
from bulkwear.workflows.engine.worn_pair import COEFFICIENT_ERROR
from bulkwear.workflows.report.sections import Block, Table, Text

HEADS = {
    "low": ("interval, from", ""),
    "high": ("to", ""),
    "coefficient_low": ("by the coefficient alone, from", ""),
    "coefficient_high": ("to", ""),
    "scatter_percent": ("of its square: packings", "%"),
    "coefficient_percent": ("wear coefficient", "%"),
}
PERCENT = 100.0


class Foreseen(NamedTuple):
    """An amount that a page predicts: whose it is (columns), what, its unit, and what is known of it."""

    whose: Mapping[str, Any]
    what: str
    unit: str
    found: Prediction


def error_of(settings: Mapping[str, Any]) -> float:
    """Return the error (-) of the wear coefficient that the settings of a study give, 0 where they give none."""
    return settings["wear"].get(COEFFICIENT_ERROR) or 0.0


def foreseen(
    whose: Mapping[str, Any], what: str, unit: str, found: Estimate, error: float, inverse: bool = False
) -> Foreseen:
    """Return a row; found: with the scatter alone; error: -, of the coefficient; inverse: whether it is of hours."""
    return Foreseen(whose, what, unit, predicted(found, error, inverse))


def prediction_table(rows: Sequence[Foreseen]) -> pd.DataFrame:
    """Return the table of predictions: whose, quantity, unit, value, low, high, the ends by the coefficient alone,
    packings, and what packings and coefficient make of the interval's square (%). NaN where the scatter is unknown.
    """
    return pd.DataFrame(
        [
            {
                **row.whose,
                "quantity": row.what,
                "unit": row.unit,
                "value": row.found.value,
                "packings": row.found.packings,
                "low": row.found.low,
                "high": row.found.high,
                "coefficient_low": row.found.coefficient_low,
                "coefficient_high": row.found.coefficient_high,
                "scatter_percent": PERCENT * row.found.scatter_share,
                "coefficient_percent": PERCENT * (1.0 - row.found.scatter_share),
            }
            for row in rows
        ]
    )


def prediction_blocks(rows: Sequence[Foreseen], error: float) -> list[Block]:
    """Return the predictions of a page with what must be said of them; nothing without one."""
    if not rows:
        return []
    return [Table(prediction_table(rows), "predictions", heads=HEADS), Text(prediction_note(rows, error))]


def prediction_note(rows: Sequence[Foreseen], error: float) -> str:
    """Return what predictions take into account, and what they do not."""
    if error > 0.0:
        said = [
            f"Interval: 95 %, packings and wear coefficient ({PERCENT * error:.3g} % of it, as given) joined as squares"
            " in the logarithm. Ratios of samples leave the coefficient out, since both have it."
        ]
    else:
        said = [f"Interval: 95 %, of the packings alone, as no {COEFFICIENT_ERROR} is given."]
    if any(row.found.packings < 2 for row in rows):
        alone = "the coefficient's part alone" if error > 0.0 else "no interval"
        said.append(f"{UNKNOWN.capitalize()}: {alone}.")
    said.append("The deepest place is one triangle, so how deep hangs on their size; that is not in it.")
    return " ".join([*said, "Nor is that a shape that wears changes its own rate."])
