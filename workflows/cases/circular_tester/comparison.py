"""Patterned or plain in the circular wear tester at equal distance, in channel and ring; patterns that wear off.

Both samples of a pair start from one bed, so a ratio is taken packing by packing; its mean over packings is geometric.
"""

from __future__ import annotations

import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.increments import BLOCKS, rate_trend
from bulkwear.postproc.statistics.intervals import Estimate, estimate
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.workflows.cases.circular_tester.packings import PACKING, interval_columns
from bulkwear.workflows.cases.circular_tester.runs import SIZE, VOLUME, WORN_OUT
from bulkwear.workflows.cases.circular_tester.volume import PATTERNED, chosen, element_increments, of_surface

MACHINE = ["shape", "particle_scale"]
WORN_OUT_SHARE = 0.05  # of the pattern's volume: what is left of it then counts as nothing
MEAN_SHARE = 20  # of a run's cycles: a twentieth of them is averaged where rates are compared
LOST = ("plain_mm3", "patterned_mm3")


def ratios_by_revolution(volumes: pd.DataFrame) -> pd.DataFrame:
    """What patterned samples lose over what plain ones lose, in each revolution of equal machine, particles, packing.

    volumes: at whole revolutions, as from `volumes`. Columns: shape, particle_scale, packing, revolution, end (of it),
    plain_mm3, patterned_mm3 (lost in it), ratio (-). Nothing for packings without a pair.
    """
    grown = element_increments(volumes)
    keys = [*MACHINE, PACKING, "revolution", "end"]
    of = {surface: of_surface(grown, surface)[[*keys, "increment_mm3"]] for surface in (PLAIN, PATTERNED)}
    both = of[PLAIN].merge(of[PATTERNED], on=keys, suffixes=("_plain", "_patterned"))
    length = both["end"] - both["revolution"]
    lost = {f"{name}_mm3": length * both[f"increment_mm3_{name}"] for name in (PLAIN, PATTERNED)}
    table = both[keys].assign(**lost)
    return table.assign(ratio=table["patterned_mm3"] / table["plain_mm3"])


def shared_ratios(ratios: pd.DataFrame) -> pd.DataFrame:
    """The rows of the revolutions that all packings of all machines of a table have."""
    if ratios.empty:
        return ratios
    return ratios[ratios["revolution"] <= ratios.groupby([*MACHINE, PACKING])["revolution"].max().min()]


def ratio_of_sums(ratios: pd.DataFrame) -> Estimate:
    """Patterned over plain, lost in all rows of a packing, over the packings of one machine."""
    sums = ratios.groupby(PACKING)[list(LOST)].sum()
    return estimate(sums["patterned_mm3"] / sums["plain_mm3"], log=True)


def mean_ratios(ratios: pd.DataFrame, shared: bool) -> pd.DataFrame:
    """Patterned over plain of each machine over the revolutions of its packings, or over those that all machines share.

    Columns: shape, particle_scale, revolutions, packings, and with their intervals (<name>_low, <name>_high; NaN of one
    packing) ratio (of the sums), reduction_percent, and change_percent: of the ratio from the first to the last
    revolution, by a straight line, over its mean.
    """
    ratios = shared_ratios(ratios) if shared else ratios
    rows = []
    for machine, each in ratios.groupby(MACHINE, sort=False):
        each = shared_ratios(each)
        found, revolutions = ratio_of_sums(each), each["revolution"].nunique()
        row = dict(zip(MACHINE, machine, strict=True)) | {"revolutions": revolutions, "packings": found.packings}
        row |= interval_columns("ratio", found)
        low, high = found.interval()
        for ending, value in {"": found.value, "_low": high, "_high": low}.items():
            row[f"reduction_percent{ending}"] = 100.0 * (1.0 - value)
        rows.append(row | interval_columns("change_percent", _change(each), 100.0))
    return pd.DataFrame(rows)


def _change(ratios: pd.DataFrame) -> Estimate:
    """Return the change (-) of the ratio from the first to the last revolution over its mean."""
    blocks = ratios.rename(columns={"revolution": "start"}).sort_values([PACKING, "start"])
    blocks["increment"] = blocks["ratio"] * (blocks["end"] - blocks["start"])
    return rate_trend(blocks.assign(cumulated=blocks.groupby(PACKING)["increment"].cumsum())[BLOCKS]).change


def pattern_left(volumes: pd.DataFrame, coefficient: float, plain_per_revolution: float) -> pd.DataFrame:
    """How much of the pattern is left against revolutions at one coefficient (1/Pa), of runs with a pattern.

    Archard's volume is coefficient times work: a revolution at a coefficient k times as large wears like k of them.
    plain_per_revolution: mm3 that the plain sample loses at it. Columns: run, packing, particle_scale, coefficient,
    revolution (as if at `coefficient`), pattern_share (-), lost_mm3, lost_per_revolution_mm3 (since the row before, per
    revolution as if at `coefficient`), mean_per_revolution_mm3 (of it, over a MEAN_SHARE of the rows),
    plain_per_revolution_mm3.
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
        same = {"run": run} | {name: rows[name] for name in (PACKING, "particle_scale", "coefficient")}
        parts.append(table.assign(**same)[[*same, *table.columns]])
    return pd.concat(parts, ignore_index=True)


def patterns_left(lost: pd.DataFrame, rates: pd.DataFrame, coefficient: float) -> pd.DataFrame | None:
    """What is left of patterns that are worn right off, and of others with equal particles, against revolutions at
    `coefficient` (1/Pa), as from `pattern_left`; None without a run for that. rates: as from `volume.rates`.
    """
    scales = chosen(lost, WORN_OUT)["particle_scale"].unique()
    beside = rates[rates["particle_scale"].isin(scales) & (rates["surface"] == PLAIN)]["rate_mm3_per_revolution"]
    if beside.empty:
        return None
    shown = chosen(lost, VOLUME, SIZE, WORN_OUT)
    return pattern_left(shown[shown["particle_scale"].isin(scales)], coefficient, float(beside.iloc[0]))


def worn_out_at(left: pd.DataFrame) -> pd.DataFrame:
    """When patterns are gone, and when their samples lose more than the plain one; NaN where that never happens.

    left: as from `pattern_left`. Columns: run, last_share (-), worn_out_revolution (less than WORN_OUT_SHARE is left),
    faster_revolution, faster_share (the mean loss per revolution first exceeds the plain sample's; what is left of the
    pattern then, -), faster_for_good_revolution (it does so from there to the end), lost_over_plain (all that is lost
    at the end over what the plain sample loses till then, -).
    """
    rows = []
    for run, of_run in left.groupby("run", sort=False):
        gone = of_run[of_run["pattern_share"] < WORN_OUT_SHARE]
        exceeds = of_run["mean_per_revolution_mm3"] > of_run["plain_per_revolution_mm3"]
        faster, for_good = of_run[exceeds], of_run[exceeds[::-1].cummin()[::-1]]
        last = of_run.iloc[-1]
        rows.append(
            {
                "run": run,
                "last_share": last["pattern_share"],
                "worn_out_revolution": _first(gone["revolution"]),
                "faster_revolution": _first(faster["revolution"]),
                "faster_share": _first(faster["pattern_share"]),
                "faster_for_good_revolution": _first(for_good["revolution"]),
                "lost_over_plain": last["lost_mm3"] / (last["revolution"] * last["plain_per_revolution_mm3"]),
            }
        )
    return pd.DataFrame(rows)


def _first(values: pd.Series) -> float:
    return float(values.iloc[0]) if len(values) else float("nan")
