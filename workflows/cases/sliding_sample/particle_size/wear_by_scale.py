"""Wear against particle scale: relative wear, straight lines, the critical scale, ratios of size (Yan 2022, 4.5.2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.reference.size_ratios import PUBLISHED_DIAMETER, PUBLISHED_PATTERN, SizeRatios, size_ratios
from bulkwear.postproc.statistics.lines import FEWEST_POINTS, Crossing, crossing, fitted_line
from bulkwear.postproc.tables.summary import patterned_name

CONVEX = "convex"  # the source's pattern
PARTS = {"base": "base_worn_volume_m3", "bumps": "pattern_worn_volume_m3"}  # curves of patterned samples' parts
RATIOS = ("equivalent_radius", "projected_area", "surface_area", "volume")
LINE_COLUMNS = ("intercept", "intercept_error", "slope", "slope_error", "r_squared")


def wear_by_scale(summary: pd.DataFrame) -> pd.DataFrame:
    """Return the wear of every run, whole and by part, over that of the plain sample with the smallest particles.

    summary: row, surface, particle_scale and the Archard volumes of every run, all over the same travel
    Columns row, particle_scale, curve (surfaces, and PARTS of patterned ones; Eq 4.14 to 4.17), relative_wear (-, Yan
    2022, Eq 4.13) and reference_scale, that of the plain sample that it is relative to (the source's is 1); rows that
    repeat the smallest scale are averaged.
    """
    plain, patterned = (summary[(summary["surface"] == PLAIN) == which] for which in (True, False))
    smallest = plain["particle_scale"].min()
    reference = plain.loc[plain["particle_scale"] == smallest, "worn_volume_m3"].mean()
    tables = []
    whole = {PLAIN: (plain, "worn_volume_m3"), patterned_name(summary["surface"]): (patterned, "worn_volume_m3")}
    for curve, (runs, column) in (whole | {part: (patterned, column) for part, column in PARTS.items()}).items():
        one = runs[["row", "particle_scale", column]].rename(columns={column: "relative_wear"})
        tables.append(one.assign(relative_wear=one["relative_wear"] / reference, curve=curve))
    return pd.concat(tables, ignore_index=True).assign(reference_scale=smallest)


def patterned_curve(wear: pd.DataFrame) -> str:
    """Return the curve of the samples that are not plain, of a table as from `wear_by_scale`."""
    return patterned_name(set(wear["curve"]) - set(PARTS))


def wear_lines(wear: pd.DataFrame) -> pd.DataFrame:
    """Return the least-squares line of every curve: curve, points and LINE_COLUMNS, NaN for fewer than three points."""
    rows = []
    for curve, one in wear.groupby("curve", sort=False):
        found = dict.fromkeys(LINE_COLUMNS, np.nan)
        if len(one) >= FEWEST_POINTS and one["particle_scale"].nunique() > 1:
            line = fitted_line(one["particle_scale"], one["relative_wear"])
            found = {name: getattr(line, name) for name in LINE_COLUMNS}
        rows.append({"curve": curve, "points": len(one), **found})
    return pd.DataFrame(rows)


def critical_scale(wear: pd.DataFrame) -> Crossing | None:
    """Return the particle scale at which patterned and plain samples wear alike, None from fewer than three rows.

    Both samples of a row have the same bed, so what is fitted is their difference, row by row.
    """
    table = wear.pivot(index="row", columns="curve", values="relative_wear")
    scale = wear.drop_duplicates("row").set_index("row")["particle_scale"].loc[table.index]
    both = [patterned_curve(wear), PLAIN]
    table, scale = table.dropna(subset=both), scale[table[both].notna().all(axis=1)]
    if len(table) < FEWEST_POINTS or scale.nunique() < 2:
        return None
    return crossing(scale.to_numpy(), *(table[curve].to_numpy() for curve in both))


def critical_scale_text(found: Crossing | None) -> str:
    """Return a phrase about the critical scale for figures."""
    if found is None:
        return "too few scales for a critical one"
    if not found.bounded:
        return "the scales simulated do not tell a critical one: patterned and plain wear may be parallel"
    return f"critical scale {found.value:.2g}, 95 % interval {found.low:.2g} to {found.high:.2g}"


def read_critical_scale(path: str | Path) -> Crossing | None:
    """Return the critical scale from critical_scale.csv, which is empty where too few scales tell one."""
    table = pd.read_csv(path)
    return None if table.empty else Crossing(**table.iloc[0].to_dict())


def smallest_and_largest(summary: pd.DataFrame) -> pd.DataFrame:
    """Return run, row, surface and particle_scale of the first rows of the smallest and of the largest particles."""
    table = summary[["run", "row", "surface", "particle_scale"]].sort_values("particle_scale", kind="stable")
    rows = list(dict.fromkeys([table["row"].iloc[0], table.loc[table["particle_scale"].idxmax(), "row"]]))
    return table[table["row"].isin(rows)].reset_index(drop=True)


def over_the_sample(profiles: pd.DataFrame, scales: Mapping[str, float]) -> pd.DataFrame:
    """Return the layers over the samples with particle_scale, sideways_m_per_s and upward_m_per_s.

    profiles: as from `flow_history.row_profiles`; scales: by run
    """
    table = profiles[profiles["zone"] == "central"]
    return table.assign(
        particle_scale=table["run"].map(scales),
        sideways_m_per_s=table["sideways_ratio"] * table["velocity_m_per_s"],
        upward_m_per_s=table["upward_ratio"] * table["velocity_m_per_s"],
    ).reset_index(drop=True)


def velocity_bounds(published: pd.DataFrame, table: pd.DataFrame) -> pd.DataFrame:
    """Return what is published of the velocity (m/s) in every layer and in the lowest one, for `spider_charts`.

    published: as in config/published/particle_size_results.csv; table: as from `over_the_sample`
    """
    highest = table["height_mm"].max()
    lowest = table.groupby("run")["height_mm"].min().max()
    reach = {"velocity_every_layer": highest, "velocity_lowest_layer": lowest}
    found = published[published["quantity"].isin(list(reach))]
    return found[["surface", "relation", "value"]].assign(place_to=found["quantity"].map(reach))


def wear_by_size_ratio(wear: pd.DataFrame, ratios: Mapping[str, SizeRatios]) -> pd.DataFrame:
    """Return the patterned sample's wear over its plain twin's beside the four ratios of size (Yan 2022, Fig 4.17).

    ratios: of the scaled particles, by row; rows without are left out. Columns row, particle_scale, wear_over_plain and
    RATIOS.
    """
    table = wear.pivot(index=["row", "particle_scale"], columns="curve", values="relative_wear").reset_index()
    table = table[table["row"].isin(ratios)].reset_index(drop=True)
    rows = [asdict(ratios[row]) for row in table["row"]]
    over = (table[patterned_curve(wear)] / table[PLAIN]).rename("wear_over_plain")
    return pd.concat([table[["row", "particle_scale"]], over, pd.DataFrame(rows, columns=list(RATIOS))], axis=1)


def published_by_size_ratio(lines: pd.DataFrame, scales: np.ndarray) -> pd.DataFrame:
    """Return the same of the published lines: particle_scale, wear_over_plain and RATIOS of run R5's pattern.

    lines: curve, intercept and slope, as in config/published/particle_size_lines.csv
    """
    line = lines.set_index("curve")
    value = {name: line.loc[name, "intercept"] + line.loc[name, "slope"] * scales for name in (CONVEX, PLAIN)}
    ratios = [asdict(size_ratios(scale * PUBLISHED_DIAMETER, *PUBLISHED_PATTERN)) for scale in scales]
    table = pd.DataFrame({"particle_scale": scales, "wear_over_plain": value[CONVEX] / value[PLAIN]})
    return pd.concat([table, pd.DataFrame(ratios)], axis=1)


def lines_beside(published: pd.DataFrame, wear: pd.DataFrame) -> pd.DataFrame:
    """Return the published lines that ours can be set beside: those of patterned samples for the source's pattern only.

    wear: as from `wear_by_scale`
    """
    return published if patterned_curve(wear) == CONVEX else published[published["curve"] == PLAIN]


def beside_published(lines: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Return our lines with the published ones beside them: columns published_intercept, published_slope, source."""
    names = {"intercept": "published_intercept", "slope": "published_slope"}
    theirs = published[["curve", "intercept", "slope", "source"]].rename(columns=names)
    return lines.merge(theirs, on="curve", how="left")
