"""Key numbers of a study of sliding samples, from its tables."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.tables.depths import depth_summary
from bulkwear.postproc.tables.display import in_display_units
from bulkwear.postproc.tables.summary import read_history, read_summary
from bulkwear.workflows.cases.sliding_sample.comparison import cycle_ratios, relative_wear_intervals
from bulkwear.workflows.cases.sliding_sample.screening.findings import UNSURE
from bulkwear.workflows.report.sections import Block, Cards, Table, Text
from bulkwear.workflows.report.text import number

ROUNDING_DIGITS = 9  # of a percentage: below is what sums leave of zero


def key_numbers(study: Mapping[str, Any], folder: Path) -> list[Block]:
    """Return the cards that answer a study's question, and the numbers of every run."""
    summary = read_summary(folder / "summary.csv")
    history = read_history(folder / "figures" / "wear_against_travel.csv")
    depths = depth_summary(
        pd.read_csv(folder / "figures" / "worn_surface.csv", usecols=["run", "depth_um", "area_mm2"])
    )
    settings = study["settings"]
    acceleration = settings["wear"]["acceleration"]
    results = result_table(summary, depths, history, acceleration)
    results = results.merge(relative_wear_intervals(summary, study["told"]["replicates"]), on="run", how="left")
    needless = [
        *(["carried_share_percent"] if not settings["wear"]["deform"] else []),
        *(["real_volume_per_metre_mm3_per_m"] if acceleration == 1.0 else []),
        *(["lowest_cycle_ratio", "highest_cycle_ratio"] if settings["sliding"]["cycles"] == 1 else []),
    ]
    shown = results.drop(columns=["row", "surface", *needless], errors="ignore").dropna(axis="columns", how="all")
    return [
        *([Cards(found)] if (found := cards(results, acceleration)) else []),
        Table(shown, "key_numbers"),
        Text(note(settings, len(study["design_rows"]) > 1, bool(results["interval_low"].notna().any()))),
    ]


def note(settings: Mapping[str, Any], compared: bool, repeated: bool) -> str:
    """Return what must be said of the key numbers; whether there are several rows, and rows with other packings."""
    acceleration = settings["wear"]["acceleration"]
    said = ["Wear by the study's law on the sample, without the skirt."]
    if acceleration != 1.0:
        said.append(
            "Per metre: of simulated travel, with the accelerated coefficient; real: the same over the acceleration of "
            f"{acceleration:g}."
        )
    said.append("Mean normal force: contact forces square to the faces, added up over the sample.")
    if settings["sliding"]["cycles"] != 1:
        said.append("Lowest and highest ratio: of a single wear cycle, no confidence interval.")
    if repeated:
        said.append(
            "Interval: 95 % of the mean over rows that differ in their packing alone, from one scatter for all rows."
        )
    elif compared:
        said.append(
            "No row is repeated with another packing, so how far these ratios scatter from packing to packing is not "
            "known."
        )
    if settings["wear"]["deform"]:
        said.append("Carried share: worn by the law, not applied to the shape yet, see What is simplified.")
    return " ".join(said)


def result_table(
    summary: pd.DataFrame, depths: pd.DataFrame, history: pd.DataFrame, acceleration: float
) -> pd.DataFrame:
    """Return the key numbers of each run in display units: volumes, per metre as simulated and as accelerated
    test, over plain with its range over the cycles, share of the pattern, carried share, forces and depths.
    """
    volume = summary["worn_volume_m3"]
    table = summary[["run", "row", "surface", "travel_m", "worn_volume_m3"]].assign(
        worn_volume_per_metre_m3_per_m=volume / summary["travel_m"],
        real_volume_per_metre_m3_per_m=volume / summary["travel_m"] / acceleration,
        wear_over_plain=summary["wear_over_plain"],
        pattern_share_percent=100.0 * summary["pattern_worn_volume_m3"] / volume,
        carried_share_percent=(100.0 * summary["carried_volume_m3"] / volume).round(ROUNDING_DIGITS).abs(),
        mean_normal_force_N=summary["mean_normal_force_N"],
    )
    ranges = cycle_ratios(history)
    return in_display_units(table).merge(ranges, on=["row", "surface"], how="left").merge(depths, on="run", how="left")


def cards(results: pd.DataFrame, acceleration: float) -> list[tuple[str, str]]:
    """Return (number, what it is) of the few that answer the question, lowest wear first; none without a plain twin."""
    patterned = results[(results["surface"] != PLAIN) & results["wear_over_plain"].notna()]
    if patterned.empty:
        return []
    best = patterned.sort_values("wear_over_plain", kind="stable").iloc[0]
    plain = results[(results["row"] == best["row"]) & (results["surface"] == PLAIN)].iloc[0]
    rate, unit = "worn_volume_per_metre_mm3_per_m", f"mm³/m{' (accelerated)' if acceleration != 1.0 else ''}"
    several = len(patterned) > 1
    which = f"{best['row']}, the lowest of {len(patterned)} rows" if several else best["row"]
    found = [
        (f"{best['wear_over_plain']:.3f}", f"{best['surface']} over plain wear, {which}"),
        (number(best[rate], 3), f"{unit}, {best['run'].replace('_', ' ')}"),
        (number(plain[rate], 3), f"{unit}, {plain['run'].replace('_', ' ')}"),
    ]
    if several:
        ratio = patterned["wear_over_plain"]
        near = int(((ratio < 1.0) & (ratio > 1.0 / (1.0 + UNSURE))).sum())
        little = f", {near} of them by less than {100.0 * UNSURE:.0f} %" if near else ""
        less = f"{(ratio < 1.0).sum()} of {len(patterned)}"
        found.append((less, f"patterns wear less than their plain twin{little}"))
    else:
        share = f"{best['pattern_share_percent']:.0f} %"
        found.append((share, f"of the {best['surface']} sample's wear is on its pattern"))
    return found
