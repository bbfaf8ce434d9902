"""Blocks of the sections of a page of equipment, from the tables of its study."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd

from bulkwear.postproc.tables.summary import read_named
from bulkwear.workflows.cases.equipment import heads, life_findings
from bulkwear.workflows.cases.equipment.figures import BESIDE_PUBLISHED, LIFTERS, TABLES
from bulkwear.workflows.cases.equipment.findings import Tables
from bulkwear.workflows.cases.equipment.heads import shown
from bulkwear.workflows.cases.equipment.machine_tables import feed_table, operation_words, parts_table
from bulkwear.workflows.report.sections import Block, Cards, Listing, Points, Table, Text
from bulkwear.workflows.report.sentences import capital, listed, spoken
from bulkwear.workflows.report.text import range_text

WORDS = (  # columns of text
    *("how", "reason", "verdict", "answer", "said", "rule"),
    *("where", "setting", "unit", "note", "source", "given"),
)
LEAST_CARRIED = 0.01  # -, of the wear law's volume; less changes no digit that is shown
INTERVALS = "Intervals: 95 %, over packings; of one packing the scatter is unknown."
LIFE_NOTE = (
    "Life: with the scatter and the coefficient's error in its interval; of one packing the scatter is that of its "
    "blocks, which tells nothing of another packing. Each packing counts by the place that all others name as the "
    "worst, each block of one packing by the one that half of the blocks names. Agreement: share that name that very "
    "place. As built: by the rate before any wear. What the caps of updates hold back counts as lost."
)
WORST_NOTE = (
    "Area patches of the shortest life, by all packings and blocks: the first of many alike places is lifted by being "
    "chosen, which the life above is not. Coordinates are those of the drawing. Pressure: mean over time."
)
DESIGN_NOTE = (
    "Ratios to the first design, of packings that share nothing (Welch), of the logarithm. What both designs have, as "
    "the error of one wear coefficient, is not in them; the errors of two different ones are."
)
IMPACT_NOTE = (
    "As built. Sliding: normal force times sliding velocity. Impacts: energy of the motion against the face at the "
    "first touches of particles, over time."
)
LIFTER_NOTE = (
    "As built and after every update. Height: crest above plates. Faces: degrees from the radius through the lifter's "
    "middle, of the straight line through a face between 20 and 80 % of its height; the leading face looks ahead in "
    f"the sense of rotation. Means over lifters; hours, too, are means over packings. {INTERVALS}"
)
ANCHOR_NOTE = (
    "Difference: computed over published, less 1. Without a computed value the study has none. Given: put in by the "
    "study, so no result of it. Margin: within "
    "which both count as one on the page of all published numbers; of angles as far as two published codes differ on "
    "one mill, else 15 %."
)


def read_tables(folder: Path) -> dict[str, pd.DataFrame]:
    """Return the tables of a study by name, those of mills where it has them; empty words are ""."""
    of_mills = {name: path for name, path in LIFTERS.items() if (folder / path).exists()}
    paths = TABLES | BESIDE_PUBLISHED | of_mills
    found = {name: read_named(folder / path, "part", *WORDS) for name, path in paths.items()}
    return {
        name: table.assign(**{word: table[word].fillna("") for word in WORDS if word in table})
        for name, table in found.items()
    }


def life(found: Tables) -> list[Block]:
    """Return the lives as numbers, and their table."""
    numbers = life_findings.cards(found["life"])
    return [
        *([Cards(numbers)] if numbers else []),
        shown(found["life"], heads.LIFE_COLUMNS, "life", LIFE_NOTE),
    ]


def machine(machines: Mapping[str, Mapping[str, Any]]) -> list[Block]:
    """Return parts, feed and operation of the machines."""
    sizes = list(dict.fromkeys(run["particle"]["sizes"] for run in machines.values()))
    feed = feed_table(machines)
    return [
        Table(parts_table(machines), "parts"),
        Table(heads.readable(feed.drop(columns="setting") if len(feed) == 1 else feed), "feed"),
        Text(f"{materials_words(machines)}; sizes: {'; '.join(sizes).rstrip('.')}."),
        Points(operations(machines)),
    ]


def materials_words(machines: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the bulk material, of designs with different ones which design has which."""
    of = _designs_of({setting: spoken(run["particle"]["name"]) for setting, run in machines.items()})
    return capital(listed([name if len(of) == 1 else f"{name} in {listed(own)}" for name, own in of.items()]))


def operations(machines: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return what operation is predicted and when liners are changed; of different ones which is of which designs."""
    of = _designs_of({setting: operation_words(run) for setting, run in machines.items()})
    if len(of) == 1:
        return list(of)
    return [f"{'Designs' if len(own) > 1 else 'Design'} {listed(own)}: {said}" for said, own in of.items()]


def _designs_of(words: Mapping[str, str]) -> dict[str, list[str]]:
    """Return {words: the settings that have them} of {setting: its words}."""
    found: dict[str, list[str]] = {}
    for setting, said in words.items():
        found.setdefault(said, []).append(setting)
    return found


def flow(found: Tables) -> list[Block]:
    """Return whether the flow is steady, and its means on the shape as built and on the worn one."""
    table = found["flow"]
    said = [f"{row.run}, {row.phase}: {row.said}" for row in table.itertuples()]
    return [
        shown(table, heads.FLOW_COLUMNS, "flow", "Intervals: 95 %, of each run, over its blocks."),
        Listing("How the flow of each run was judged", "\n".join(said)),
    ]


def impacts(found: Tables) -> list[Block]:
    """Return the power of sliding and of impacts on each part as built."""
    loads = found["loads"][found["loads"]["quantity"].isin(["sliding_power_W", "impact_power_W"])]
    table = loads.pivot_table(index=["setting", "part"], columns="quantity", values="pristine", sort=False)
    table = table.reindex(columns=["sliding_power_W", "impact_power_W"]).reset_index()
    both = table["sliding_power_W"] + table["impact_power_W"]
    table = table.assign(impact_percent=100.0 * table["impact_power_W"] / both.where(both > 0.0))
    return [shown(table, heads.IMPACT_COLUMNS, "impacts", IMPACT_NOTE)]


def worn_shape(found: Tables, summary: pd.DataFrame, machines: Mapping[str, Mapping[str, Any]]) -> list[Block]:
    """Return what updates stood for, loads on the worn shape beside those as built, and the thickness that is left."""
    loads = found["loads"].assign(quantity=found["loads"]["quantity"].map(heads.LOAD_NAMES))
    note = (
        "Force and torque: length of the mean vector, force not of parts that turn for good. "
        f"Change: packing by packing. {INTERVALS}"
    )
    left = f"Without the coefficient's error; what the caps of updates hold back counts as lost. {INTERVALS}"
    return [
        Text(acceleration_words(summary, [run["sampling"]["block_s"] for run in machines.values()])),
        shown(loads, heads.LOAD_COLUMNS, "loads", note),
        *([shown(found["remaining"], heads.REMAINING_COLUMNS, "remaining", left)] if len(found["remaining"]) else []),
    ]


def lifters(found: Tables) -> list[Block]:
    """Return the lifters of a mill against hours of operation; nothing where there are none."""
    if "lifters" not in found or found["lifters"].empty:
        return []
    return [shown(found["lifters"], heads.LIFTER_COLUMNS, "lifters", LIFTER_NOTE)]


def acceleration_words(summary: pd.DataFrame, blocks_s: list[float]) -> str:
    """Return how many updates the shape had, and for how many hours a second of them stood on average."""
    worn = summary[summary["wearing_cycles"] > 0]
    if worn.empty:
        return "The shape was kept as built: nothing is told of the worn one."
    counts = worn["wearing_cycles"].tolist()
    updates = f"{range_text(counts)} update{'s' * (max(counts) > 1)}"
    worn_for, each = _hours(worn["operation_h"]), _hours(worn["operation_h"] / worn["wearing_cycles"])
    return (
        f"The shape was worn in {updates} per run, for {worn_for} h of operation. A block of "
        f"{range_text(blocks_s, 3)} s stood for {each} h there, on average.{_carried_words(worn)}"
    )


def _carried_words(worn: pd.DataFrame) -> str:
    """Return how much of the wear law's volume the caps of updates still hold back at the end of the runs."""
    share = float((worn["carried_volume_m3"] / worn["worn_volume_m3"]).max())
    if not share >= LEAST_CARRIED:
        return ""
    return (
        f" At the end caps on a step held back up to {life_findings.rounded(100.0 * share)} % of the volume that the"
        " wear law took: the worn shape lags behind its hours, most where elements are small. More updates"
        " (updates.most), or larger elements, bring it closer."
    )


def _hours(values: pd.Series) -> str:
    low, high = (life_findings.rounded(value, 3) for value in (values.min(), values.max()))
    return low if low == high else f"{low} to {high}"


def designs(found: Tables, machines: Mapping[str, Any]) -> list[Block]:
    """Return the designs side by side; nothing of a study with one."""
    if len(machines) < 2:
        return []
    table = found["designs"]
    return [Table(heads.readable(table), "designs", DESIGN_NOTE, heads=heads.DESIGN_COLUMNS)]


def balance(found: Tables) -> list[Block]:
    """Return the sums of each run over its cycles."""
    cycles = found["mass_balance"]
    runs = cycles.groupby("run", sort=False)
    table = runs.agg({"cycle": "size", "in": "sum", "out": "sum", "held": "last", "missing": "sum"}).reset_index()
    table = table.rename(columns={"cycle": "cycles"})
    return [shown(table, heads.BALANCE_COLUMNS, "balance")]


def anchors(found: Tables) -> list[Block]:
    """Return published values beside computed ones; nothing where the study has none."""
    if found["anchors"].empty:
        return []
    return [replace(shown(found["anchors"], heads.ANCHOR_COLUMNS, "anchors", ANCHOR_NOTE), beside_source=True)]
