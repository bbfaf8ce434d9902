"""What the shape of grains does to the wear, and which rolling friction of spheres does the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.tables.display import in_display_units
from bulkwear.postproc.tables.packings import BY, over_packings
from bulkwear.workflows.cases.sliding_sample.comparison import still_designed
from bulkwear.workflows.config.clumps import ROUND
from bulkwear.workflows.report.sections import Block, Pictures, Points, Table
from bulkwear.workflows.report.text import number

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study

SHAPE, FACTOR = "shape", "rolling_friction_factor"  # columns of the design
PER_METRE, OVER_PLAIN = "worn_volume_per_metre_m3_per_m", "wear_over_plain"
FIGURE = "wear_by_grain_shape"
FEWEST_FACTORS = 2  # of spheres, between which clumps can be placed
ROUND_DIGITS = 2  # significant ones of factors and ratios in words
NONE = "none"
NOTE = (
    "Same as: the rolling friction of spheres, over that of the materials, with which straight lines between the means"
    " of the spheres' rows pass this value; none where no row of spheres lies beyond it. Over round: over the value of"
    " spheres with the least rolling friction."
)


def shapes_of_study(study: Study) -> dict[str, Any]:
    """Return {column: setting of the study} of SHAPE and FACTOR, which rows without a value of their own have."""
    return {name: study.settings["bed"][name] for name in (SHAPE, FACTOR)}


def compares_shapes(study: Study) -> bool:
    """Return whether a study sets clumps beside spheres of several rolling frictions."""
    rows = [shapes_of_study(study) | row for row in study.design_rows if row.keys() & {SHAPE, FACTOR}]
    factors = {row[FACTOR] for row in rows if row[SHAPE] == ROUND}
    return len(factors) >= FEWEST_FACTORS and any(row[SHAPE] != ROUND for row in rows)


def shape_table(summary: pd.DataFrame, of_study: Mapping[str, Any]) -> pd.DataFrame:
    """Return a line per measure and setting: wear per metre of each surface (mm3/m), and patterned over plain (-).

    summary: as from `summary.summary_table`, with the columns SHAPE and FACTOR of the design; of_study: what stands for
    their empty cells, as from `shapes_of_study`
    Columns measure, setting, shape, FACTOR, value, packings, interval_low, interval_high, over_round (-), and of clumps
    same_as: the factors of spheres that give the same value, as text.
    """
    summary = summary.fillna(dict(of_study))
    wear = summary[[*BY, SHAPE, FACTOR, PER_METRE]]
    measures = {
        f"{surface} sample": in_display_units(rows).rename(columns=lambda name: _value(name, PER_METRE))
        for surface, rows in wear.groupby("surface", sort=False)
    }
    twins = summary[summary["surface"] != PLAIN][[*BY, SHAPE, FACTOR, OVER_PLAIN]].dropna()
    if len(twins):
        measures["patterned over plain"] = twins.rename(columns={OVER_PLAIN: "value"})
    return pd.concat([_with_equal_factors(rows).assign(measure=name) for name, rows in measures.items()])[
        [
            "measure",
            "setting",
            SHAPE,
            FACTOR,
            "value",
            "packings",
            "interval_low",
            "interval_high",
            "over_round",
            "same_as",
        ]
    ].reset_index(drop=True)


def _value(name: str, measure: str) -> str:
    """Return the name `value` for the column of a measure in whatever unit."""
    return "value" if name.startswith(measure.removesuffix("_m3_per_m")) else name


def _with_equal_factors(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the means over packings of one measure, with what of the spheres each is like."""
    means = over_packings(rows, "value")
    spheres = means[means[SHAPE] == ROUND].sort_values(FACTOR)
    factors, values = spheres[FACTOR].to_numpy(), spheres["value"].to_numpy()
    same = [
        "" if row[SHAPE] == ROUND else factors_text(equal_factors(factors, values, row["value"]), factors)
        for _, row in means.iterrows()
    ]
    return means.assign(over_round=means["value"] / values[0], same_as=same)


def equal_factors(factors: np.ndarray, values: np.ndarray, value: float) -> list[float]:
    """Return where straight lines between points (factors, values) (k,), factors increasing, pass a value."""
    beyond = np.asarray(values, float) - value
    found = [float(factor) for factor, rest in zip(factors, beyond, strict=True) if rest == 0.0]
    for left in np.flatnonzero(beyond[:-1] * beyond[1:] < 0.0):
        share = beyond[left] / (beyond[left] - beyond[left + 1])
        found.append(float(factors[left] + share * (factors[left + 1] - factors[left])))
    return sorted(found)


def factors_text(found: Sequence[float], factors: np.ndarray) -> str:
    """Return the factors that were found in words; factors: (k,) of the spheres."""
    if not found:
        return f"{NONE} from {factors[0]:g} to {factors[-1]:g}"
    return " and ".join(number(factor, ROUND_DIGITS) for factor in found)


def answers(folder: Path) -> list[str]:
    """Return in sentences what each clump does, beside spheres; nothing of a study of other things."""
    path = folder / "figures" / f"{FIGURE}.csv"
    if not path.is_file():
        return []
    table = pd.read_csv(path, keep_default_na=False, na_values=[""], dtype={"setting": str})
    return shape_sentences(table) if still_designed(table["setting"], folder) else []


def shape_sentences(table: pd.DataFrame) -> list[str]:
    """Return a sentence per measure and one on their scatter; table: as from `shape_table`."""
    said = []
    for measure, rows in table.groupby("measure", sort=False):
        clumps = rows[rows[SHAPE] != ROUND]
        least = rows.loc[rows[SHAPE] == ROUND, FACTOR].min()
        told = [f"{row.setting} {_ratio_text(row)}" for row in clumps.itertuples()]
        said.append(f"{measure.capitalize()}, over spheres with {least:g} of the rolling friction: {'; '.join(told)}.")
    return [*said, f"{UNKNOWN.capitalize()}."] if (table["packings"] < 2).all() else said


def shape_finding(table: pd.DataFrame) -> str:
    """Return what the figure shows, the last measure's sentence; table: as from `shape_table`."""
    last = table["measure"].iloc[-1]
    return shape_sentences(table[table["measure"] == last])[0]


def _ratio_text(row) -> str:
    """Return the ratio of a clump and the rolling friction of spheres that is like it."""
    none = str(row.same_as).startswith(NONE)
    like = f"no spheres{row.same_as.removeprefix(NONE)} of it" if none else f"spheres with {row.same_as} of it"
    return f"{number(row.over_round, ROUND_DIGITS)} ({like} wear the same)"


def blocks(folder: Path) -> list[Block]:
    """Return what the page tells of shapes; folder: results/<study>."""
    table = pd.read_csv(folder / "figures" / f"{FIGURE}.csv")
    return [Points(answers(folder)), Table(table, FIGURE, NOTE), Pictures([FIGURE])]
