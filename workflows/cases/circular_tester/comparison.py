"""Patterned or plain in the circular wear tester at equal distance, in channel and ring; patterns that wear off."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.workflows.cases.circular_tester.runs import SIZE, VOLUME, WORN_OUT
from bulkwear.workflows.cases.circular_tester.volume import (
    PATTERNED,
    chosen,
    chosen_fit,
    element_increments,
    of_surface,
)

MACHINE = ["shape", "particle_scale"]
WORN_OUT_SHARE = 0.05  # of the pattern's volume: what is left of it then counts as nothing
MEAN_SHARE = 20  # of a run's cycles: a twentieth of them is averaged where rates are compared


def ratios_by_revolution(volumes: pd.DataFrame) -> pd.DataFrame:
    """What patterned samples lose over what plain ones lose, in each revolution of equal machine and particles.

    volumes: at whole revolutions, as from `volumes`. Columns: shape, particle_scale, revolution (the
    earlier of both ends), plain_mm3, convex_mm3 (lost in it), ratio (-). Nothing for machines without a pair.
    """
    parts = []
    for machine, rows in volumes.groupby(MACHINE, sort=False):
        grown = element_increments(rows)
        of = {surface: of_surface(grown, surface) for surface in (PLAIN, PATTERNED)}
        both = of[PLAIN].merge(of[PATTERNED], on="revolution", suffixes=("_plain", "_patterned"))
        table = pd.DataFrame(
            {
                "revolution": both["revolution"],
                "plain_mm3": both["increment_mm3_plain"],
                "convex_mm3": both["increment_mm3_patterned"],
            }
        )
        table["ratio"] = table["convex_mm3"] / table["plain_mm3"]
        parts.append(table.assign(**dict(zip(MACHINE, machine, strict=True)))[[*MACHINE, *table.columns]])
    return pd.concat(parts, ignore_index=True)


def mean_ratios(ratios: pd.DataFrame, shared: bool) -> pd.DataFrame:
    """Patterned over plain of each machine over all its revolutions, or over those that all machines share.

    Columns: shape, particle_scale, revolutions, ratio (of the sums), deviation and standard_error (of the revolutions'
    ratios), reduction_percent.
    """
    count = ratios.groupby(MACHINE).size().min() if shared else len(ratios)
    grouped = ratios[ratios.groupby(MACHINE).cumcount() < count].groupby(MACHINE, sort=False)
    sums = grouped[["plain_mm3", "convex_mm3"]].sum()
    table = pd.DataFrame({"revolutions": grouped.size(), "ratio": sums["convex_mm3"] / sums["plain_mm3"]})
    table["deviation"] = grouped["ratio"].std()
    table["standard_error"] = table["deviation"] / np.sqrt(table["revolutions"])
    return table.assign(reduction_percent=100.0 * (1.0 - table["ratio"])).reset_index()


def pattern_left(volumes: pd.DataFrame, coefficient: float, plain_per_revolution: float) -> pd.DataFrame:
    """How much of the pattern is left against revolutions at one coefficient (1/Pa), of runs with a pattern.

    Archard's volume is coefficient times work: a revolution at a coefficient k times as large wears like k of them.
    plain_per_revolution: mm3 that the plain sample loses at it. Columns: run, particle_scale, coefficient, revolution
    (as if at `coefficient`), pattern_share (-), lost_mm3, lost_per_revolution_mm3 (since the row before, per revolution
    as if at `coefficient`), mean_per_revolution_mm3 (of it, over a MEAN_SHARE of the rows), plain_per_revolution_mm3.
    """
    patterned = of_surface(volumes, PATTERNED)
    parts = []
    for run, rows in patterned.groupby("run", sort=False):
        revolution = rows["revolution"] * rows["coefficient"] / coefficient
        lost = CUBIC_MILLIMETRES * rows["law_volume_m3"]
        table = pd.DataFrame({"revolution": revolution, "lost_mm3": lost})
        table["pattern_share"] = rows["pattern_volume_m3"] / rows["pattern_volume_m3"].iloc[0]
        table["lost_per_revolution_mm3"] = lost.diff() / revolution.diff()
        window = table["lost_per_revolution_mm3"].rolling(max(len(rows) // MEAN_SHARE, 1), center=True, min_periods=1)
        table["mean_per_revolution_mm3"] = window.mean()
        table["plain_per_revolution_mm3"] = plain_per_revolution
        same = {"run": run, "particle_scale": rows["particle_scale"], "coefficient": rows["coefficient"]}
        parts.append(table.assign(**same)[[*same, *table.columns]])
    return pd.concat(parts, ignore_index=True)


def patterns_left(lost: pd.DataFrame, fits: pd.DataFrame, coefficient: float) -> pd.DataFrame | None:
    """What is left of patterns that are worn right off, and of others in equal beds, against revolutions at
    `coefficient` (1/Pa), as from `pattern_left`; None without a run for that.
    """
    scales = chosen(lost, WORN_OUT)["particle_scale"].unique()
    beside = fits[fits["particle_scale"].isin(scales) & (fits["surface"] == PLAIN)]["run"]
    if beside.empty:
        return None
    shown = chosen(lost, VOLUME, SIZE, WORN_OUT)
    rate = float(chosen_fit(fits, beside.iloc[0])[0])
    return pattern_left(shown[shown["particle_scale"].isin(scales)], coefficient, rate)


def worn_out_at(left: pd.DataFrame) -> pd.DataFrame:
    """When patterns are gone, and when their samples lose more than the plain one; NaN where that never happens.

    left: as from `pattern_left`. Columns: run, last_share (-), worn_out_revolution (less than WORN_OUT_SHARE is left),
    faster_revolution, faster_share (the mean loss per revolution first exceeds the plain sample's; what is left of the
    pattern then, -), lost_over_plain (all that is lost at the end over what the plain sample loses till then, -).
    """
    rows = []
    for run, of_run in left.groupby("run", sort=False):
        gone = of_run[of_run["pattern_share"] < WORN_OUT_SHARE]
        faster = of_run[of_run["mean_per_revolution_mm3"] > of_run["plain_per_revolution_mm3"]]
        last = of_run.iloc[-1]
        rows.append(
            {
                "run": run,
                "last_share": last["pattern_share"],
                "worn_out_revolution": _first(gone["revolution"]),
                "faster_revolution": _first(faster["revolution"]),
                "faster_share": _first(faster["pattern_share"]),
                "lost_over_plain": last["lost_mm3"] / (last["revolution"] * last["plain_per_revolution_mm3"]),
            }
        )
    return pd.DataFrame(rows)


def _first(values: pd.Series) -> float:
    return float(values.iloc[0]) if len(values) else float("nan")
