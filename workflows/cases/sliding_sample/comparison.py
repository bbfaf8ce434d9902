"""Settings of a study against each other: patterned over plain, base against pattern, one law against another.

A patterned and a plain sample of the same packing share their bed: they are compared packing by packing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.tables.display import in_display_units
from bulkwear.postproc.tables.packings import BY, over_packings, relative_wear_of_settings


def plain_of_row(summary: pd.DataFrame, column: str) -> pd.Series:
    """Return, for each run, a column's value of the plain run of the same design row; NaN without one."""
    plain = summary[summary["surface"] == PLAIN].set_index("row")[column]
    return summary["row"].map(plain)


def still_designed(settings: Iterable[str], folder: Path) -> bool:
    """Return whether all of some settings, of a table that an earlier study of that name may have left, are in the
    design; folder: results/<study>.
    """
    design = pd.read_csv(folder / "design.csv", dtype=str, keep_default_na=False)
    return set(settings) <= set(design["setting"])


def wear_split(summary: pd.DataFrame) -> pd.DataFrame:
    """Return the wear on base and on pattern over the wear of the plain twin, a line per setting and surface.

    Columns setting, surface, wear_over_plain with packings and its interval, base_over_plain and pattern_over_plain,
    which add up to it.
    """
    plain = plain_of_row(summary, "worn_volume_m3")
    table = summary[[*BY, "wear_over_plain"]].assign(
        base_over_plain=summary["base_worn_volume_m3"] / plain,
        pattern_over_plain=summary["pattern_worn_volume_m3"] / plain,
    )
    return over_packings(table, "wear_over_plain", parts=("base_over_plain", "pattern_over_plain"))


def law_comparison(summary: pd.DataFrame) -> pd.DataFrame:
    """Return the volumes by Archard and by the solver's own Finnie, and Finnie's over Archard's with its interval, a
    line per setting and surface.
    """
    table = summary[[*BY, "worn_volume_m3", "finnie_volume_m3"]]
    ratio = summary["finnie_volume_m3"] / summary["worn_volume_m3"]
    return in_display_units(over_packings(table.assign(finnie_over_archard=ratio), "finnie_over_archard"))


def relative_wear_table(summary: pd.DataFrame, size_ratios: Mapping[str, float | None]) -> pd.DataFrame:
    """Return setting, surface, wear_over_plain with packings and its interval, and alpha_ER of every setting with a
    plain twin, in the order of the design; size_ratios: alpha_ER by run (Yan 2022, Eq 4.18).
    """
    table = relative_wear_of_settings(summary)
    first = summary.drop_duplicates(list(BY)).set_index(list(BY))["run"]
    runs = [first[key] for key in table[list(BY)].itertuples(index=False, name=None)]
    return table.assign(equivalent_size_ratio=np.array([size_ratios.get(run) for run in runs], dtype=float))
