"""Tables of runs with a line per setting instead of per run: means over its packings, with intervals.

A design table, and a study's summary with it, has the setting and the packing of every run, see
`workflows.config.packings`; runs of a setting differ in nothing but their random bed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.intervals import CONFIDENCE, UNKNOWN, estimates, interval_table

SETTING, PACKING = "setting", "packing"
BY = (SETTING, "surface")
MIXED = "mixed"  # what words are that differ between packings
NOT_MEANS = ("run", "row", PACKING)


def over_packings(
    table: pd.DataFrame, column: str, log: bool = True, parts: Sequence[str] = (), by: Sequence[str] = BY
) -> pd.DataFrame:
    """Return a line per setting and surface, or whatever else `by` names, in their order.

    table: a line per run with the columns `by`
    column: what has an interval, by `intervals.estimate`: its mean, packings, interval_low and interval_high, NaN where
        one packing leaves the scatter unknown; log: whether it scatters by a factor, as volumes do
    parts: columns that add up to it; they are scaled with it, so that they still do
    Other numbers are means over the packings, other words those that all packings have, or MIXED.
    """
    keys = pd.MultiIndex.from_frame(table[list(by)]).to_flat_index()
    found = interval_table(estimates(keys, table[column].to_numpy(dtype=float), log=log))
    numbers = [name for name in table.select_dtypes("number") if name not in (*by, *NOT_MEANS)]
    words = [name for name in table if name not in (*by, *NOT_MEANS, *numbers)]
    groups = table.groupby(list(by), sort=False, dropna=False)
    means = groups.agg(dict.fromkeys(numbers, "mean") | dict.fromkeys(words, _shared)).reset_index()
    scale = found["mean"] / means[column].where(means[column] != 0.0)
    scaled = {name: means[name] * scale for name in parts}
    means = means.assign(**{column: found["mean"]}, **scaled)[[*by, *words, *numbers]]
    return means.join(found.drop(columns=[SETTING, "mean"]))


def _shared(values: pd.Series) -> object:
    return values.iloc[0] if values.nunique(dropna=False) == 1 else MIXED


def relative_wear_of_settings(summary: pd.DataFrame) -> pd.DataFrame:
    """Return setting, surface, wear_over_plain, packings, interval_low and interval_high of every setting that has a
    plain twin; of each packing the patterned run is set over the plain one in the same bed.

    summary: as from `summary.summary_table`
    """
    twins = summary[(summary["surface"] != PLAIN) & summary["wear_over_plain"].notna()]
    return over_packings(twins[[*BY, "wear_over_plain"]], "wear_over_plain")


def first_packings(table: pd.DataFrame) -> pd.DataFrame:
    """Return the runs of a table of runs that stand for their setting where not all can be shown: its first packing."""
    first = table.groupby(SETTING)[PACKING].transform("min")
    return table[table[PACKING] == first].reset_index(drop=True)


def mean_along(table: pd.DataFrame, travel: str, column: str) -> pd.DataFrame:
    """Return a measure along the travel with one curve per setting and surface: its mean over the packings.

    table: run, row, SETTING, PACKING, surface, travel and column; a curve is called as its first packing, and has the
    travel of that; others are interpolated
    """
    curves = []
    for _, packings in table.groupby(list(BY), sort=False):
        first, *others = (one for _, one in packings.groupby("run", sort=False))
        values = [first[column], *(np.interp(first[travel], one[travel], one[column]) for one in others)]
        curves.append(first.assign(**{column: np.mean(values, axis=0)}))
    return pd.concat(curves, ignore_index=True)


def mean_profiles(profiles: pd.DataFrame, settings: Mapping[str, str], rows: Sequence[str]) -> pd.DataFrame:
    """Return the profiles of some rows, each the mean over the packings of its setting.

    profiles: row, surface, zone, layer and numbers; settings: {row: setting}; rows: names that the profiles then have
    """
    by = ["surface", "zone", "layer"]
    found = []
    for row in rows:
        packings = profiles[profiles["row"].map(settings) == settings[row]]
        means = packings.groupby(by, sort=False).mean(numeric_only=True).reset_index()
        found.append(means.assign(row=row, packings=packings["row"].nunique())[["row", *means, "packings"]])
    return pd.concat(found, ignore_index=True)


def packings_remark(packings: pd.Series) -> str:
    """Return what a figure with a line per setting must say of its bars; packings: of every line."""
    alone = int((packings < 2).sum())
    if alone == len(packings):
        return UNKNOWN
    least, most = packings[packings > 1].min(), packings.max()
    counts = f"{most:g}" if least == most else f"{least:g} to {most:g}"
    said = f"bars of error: {100.0 * CONFIDENCE:g} % intervals of the mean over {counts} packings"
    return f"{said}; without one: {UNKNOWN}" if alone else said


def shown_remark(table: pd.DataFrame) -> list[str]:
    """Return what a figure of `first_packings` must say where there are others; table: of all runs."""
    most = int(table.groupby(SETTING)[PACKING].nunique().max())
    return [f"the first of {most} packings is shown"] if most > 1 else []
