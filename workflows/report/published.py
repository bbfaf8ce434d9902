"""Every published number beside ours: taken from the tables of a page that are marked so, in one set of columns.

Three kinds of tables are: claims with their verdicts (finding, of what, claim, found, verdict, reason, factor, source),
numbers with a relation (quantity, surface, scales, relation, value, unit, and the same from found on), and values
beside values (published_value, computed_value with its interval, packings, source), which are judged here unless they
are `given`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pandas as pd

from bulkwear.postproc.statistics.intervals import Ends
from bulkwear.postproc.statistics.verdicts import Claim, Verdict, judged, not_said
from bulkwear.workflows.config.claims import about
from bulkwear.workflows.report.sections import DIGITS, Block, Section, Table

COLUMNS = ["finding", "published", "found", "factor", "verdict", "reason", "source"]
FOLDER = "published"  # in docs
NOT_COMPUTED = "the study computes no such number"
COMPUTED = "computed_value"  # column of values beside values
GIVEN = "given"  # column of what is put in and no result of ours, and what stands there instead of a verdict


def published_file(page: str) -> str:
    """Return the path in docs of the table that a page of results leaves."""
    return f"{FOLDER}/{Path(page).stem}.csv"


def write_published_numbers(docs: Path, page: str, sections: Iterable[Section]) -> None:
    """Leave the published numbers of a page of results in docs; nothing, not even an earlier table, for a page without
    any.
    """
    table, path = published_numbers(sections), docs / published_file(page)
    if len(table):
        path.parent.mkdir(exist_ok=True)
        table.to_csv(path, index=False, float_format="%.4g")
    else:
        path.unlink(missing_ok=True)


def published_numbers(sections: Iterable[Section]) -> pd.DataFrame:
    """Return COLUMNS of all tables of a page's sections that are marked as beside the source, in their order."""
    blocks = [block for section in sections for block in section.blocks]
    tables = [_alike(each) for block in blocks if (each := _beside_source(block)) is not None]
    return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame(columns=COLUMNS)


def _beside_source(block: Block) -> pd.DataFrame | None:
    """Return the published numbers of a block beside ours, None where it has none."""
    beside = block.beside_source if isinstance(block, Table) else False
    if isinstance(beside, pd.DataFrame):
        return beside if len(beside) else None
    return block.data if beside else None


def _alike(table: pd.DataFrame) -> pd.DataFrame:
    if COMPUTED in table:
        return pd.DataFrame([_judged_value(row) for row in table.to_dict("records")], columns=COLUMNS)
    if "relation" in table:
        finding = [_words(row, "quantity", "surface") for row in table.to_dict("records")]
        published = [_number_words(row) for row in table.to_dict("records")]
        table = table.assign(finding=finding, published=published)
    else:
        finding = [_words(row, "finding", "of") for row in table.to_dict("records")]
        table = table.rename(columns={"claim": "published", "claimed": "published"}).assign(finding=finding)
    return table.reindex(columns=COLUMNS).fillna({"found": "", "reason": ""})


def _judged_value(row: dict[str, Any]) -> dict[str, Any]:
    """Return a published value beside the computed one; its margin is that of the row, else that of what is about.

    Where a range is published the range is claimed, also beside a value; the factor is over the value, without one over
    the end that ours is beyond.
    """
    value, low, high = (_number(row, f"published_{name}") for name in ("value", "low", "high"))
    computed, ends = row[COMPUTED], [_number(row, f"computed_{end}") for end in ("low", "high")]
    unit = "" if row["unit"] == "-" else row["unit"]
    ranged = not (math.isnan(low) and math.isnan(high))
    between = _open_ended(low, high) if ranged else (value, value)
    margin = _number(row, "margin")
    claim = about(row["quantity"], *between, unit, margin=None if math.isnan(margin) else margin)
    if _text(row.get(GIVEN)) and math.isfinite(computed):
        verdict = Verdict(f"{computed:.{DIGITS}g} {unit}".strip(), GIVEN)
    else:
        verdict = _verdict(claim, computed, ends, _number(row, "packings"))
    return {
        "finding": _words(row, "quantity", "setting"),
        "published": f"{_range(value, low, high)} {unit}".strip(),
        "found": verdict.found,
        "factor": verdict.factor if math.isnan(value) else computed / value if value else math.nan,
        "verdict": verdict.verdict,
        "reason": "; ".join(filter(None, (verdict.reason, _text(row.get("reason"))))),
        "source": row["source"],
    }


def _verdict(claim: Claim, computed: float, ends: list[float], packings: float) -> Verdict:
    """Return the verdict on a value; packings: NaN where what has the interval is no mean over packings."""
    if not math.isfinite(computed):
        return not_said(NOT_COMPUTED)
    if packings == 1.0:  # ends, if any, are those of its blocks
        ends = [math.nan, math.nan]
    return judged(claim, Ends(computed, *ends, packings=0 if math.isnan(packings) else int(packings)))


def _open_ended(low: float, high: float) -> tuple[float, float]:
    """Return the ends of a published range, infinite where none is told."""
    return (-math.inf if math.isnan(low) else low), (math.inf if math.isnan(high) else high)


def _range(value: float, low: float, high: float) -> str:
    """Return a published value, its range where it has one, or both."""
    if math.isnan(low):
        between = "" if math.isnan(high) else f"up to {high:g}"
    else:
        between = f"{low:g} or more" if math.isnan(high) else f"{low:g} to {high:g}"
    if math.isnan(value):
        return between
    return f"{value:g} ({between})" if between else f"{value:g}"


def _number_words(row: dict[str, Any]) -> str:
    unit, scales = ("" if row["unit"] == "-" else f" {row['unit']}"), _text(row.get("scales"))
    return f"{row['relation']} {row['value']:g}{unit}{f' at scale {scales}' if scales else ''}"


def _words(row: dict[str, Any], *names: str) -> str:
    return ", ".join(filter(None, (_text(row.get(name)).replace("_", " ") for name in names)))


def _text(value: Any) -> str:
    return "" if value is None or value != value else str(value)


def _number(row: dict[str, Any], name: str) -> float:
    """Return a number of a row, NaN where it has none."""
    value = row.get(name)
    return math.nan if value is None else float(value)
