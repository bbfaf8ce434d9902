"""Wear against particle scale: relative wear, straight lines, the critical scale, ratios of size (Yan 2022, 4.5.2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.reference.size_ratios import PUBLISHED_DIAMETER, PUBLISHED_PATTERN, SizeRatios, size_ratios
from bulkwear.postproc.statistics.crossing import FEWEST_PLACES, Crossing, crossing, form_table, lack_of_fit
from bulkwear.postproc.statistics.intervals import estimates, interval_table
from bulkwear.postproc.tables.summary import patterned_name

CONVEX = "convex"  # the source's pattern
PARTS = {"base": "base_worn_volume_m3", "bumps": "pattern_worn_volume_m3"}  # curves of patterned samples' parts
RATIOS = ("equivalent_radius", "projected_area", "surface_area", "volume")
LINE_COLUMNS = ("intercept", "slope", "lack_of_fit_p_value")
FEWEST_LAYERS = 2.0  # -, of particles in a bed: with fewer, some have no other one above them or below


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
    """Return the least-squares line of every curve: curve, points and LINE_COLUMNS, NaN for fewer than three scales.

    lack_of_fit_p_value: -, how probable it is that packings alone scatter the means of the scales so far off the line;
    NaN where no scale is repeated. A line that does not fit is a drawing aid; its slope has no interval.
    """
    rows = []
    for curve, one in wear.groupby("curve", sort=False):
        found = dict.fromkeys(LINE_COLUMNS, np.nan)
        if one["particle_scale"].nunique() >= FEWEST_PLACES:
            scale, wears = one["particle_scale"].to_numpy(), one["relative_wear"].to_numpy()
            intercept, slope = np.polynomial.polynomial.polyfit(scale, wears, 1)
            p_value = lack_of_fit(scale, wears, intercept + slope * scale, 2)["p_value"]
            found = dict(zip(LINE_COLUMNS, (intercept, slope, p_value), strict=True))
        rows.append({"curve": curve, "points": len(one), **found})
    return pd.DataFrame(rows)


def wear_over_plain(wear: pd.DataFrame) -> pd.DataFrame:
    """Return row, particle_scale and wear_over_plain (-), the ratio of both samples in the same bed, of every row."""
    table = wear.pivot(index=["row", "particle_scale"], columns="curve", values="relative_wear").reset_index()
    over = table[patterned_curve(wear)] / table[PLAIN]
    return table[["row", "particle_scale"]].assign(wear_over_plain=over.to_numpy()).dropna().reset_index(drop=True)


def ratio_by_scale(wear: pd.DataFrame) -> pd.DataFrame:
    """Return particle_scale, wear_over_plain (geometric mean over packings), packings, interval_low, interval_high."""
    over = wear_over_plain(wear)
    found = interval_table(estimates(over["particle_scale"], over["wear_over_plain"], log=True))
    found = found.rename(columns={"setting": "particle_scale", "mean": "wear_over_plain"})
    return found.sort_values("particle_scale", ignore_index=True)


def critical_scale(wear: pd.DataFrame) -> tuple[Crossing, pd.DataFrame]:
    """Return the particle scale at which patterned and plain samples wear alike, and the forms that tell it.

    See `postproc.statistics.crossing`: replicates are packings, and nothing is extended beyond the scales simulated.
    """
    over = wear_over_plain(wear)
    places = over["particle_scale"].to_numpy(), over["wear_over_plain"].to_numpy()
    return crossing(*places), form_table(*places)


def critical_scale_text(found: Crossing) -> str:
    """Return a phrase about the critical scale, with its interval or why there is none."""
    if found.reason:
        value = f" {found.value:.2g}" if np.isfinite(found.value) else ""
        return f"critical scale{value}: {found.reason}"
    ends = [f"{end:.3g}" if np.isfinite(end) else "beyond the scales simulated" for end in (found.low, found.high)]
    value = f"{found.value:.3g}" if np.isfinite(found.value) else "not between the scales simulated"
    forms = "1 form" if found.forms == 1 else f"{found.forms:g} forms"
    return f"critical scale {value}, 95 % interval over {forms} {' to '.join(ends)}"


def bed_sentences(plain: pd.DataFrame) -> list[str]:
    """Return how beds of one thickness press at each scale, and at which ones they have few layers; nothing of
    beds that are not.

    plain: a line per plain run: particle_scale, mean_normal_force_N, layers and bed_thickness_mm; packings are averaged
    """
    if plain["bed_thickness_mm"].nunique() != 1:
        return []
    means = plain.groupby("particle_scale")[["mean_normal_force_N", "layers"]].mean()
    over = (means["mean_normal_force_N"] / means["mean_normal_force_N"].iloc[0]).iloc[1:]
    said = [f"All beds have the mass of a level one of {plain['bed_thickness_mm'].iloc[0]:g} mm."]
    if len(over):
        shares = ", ".join(f"{100.0 * share:.0f} % at scale {scale:g}" for scale, share in over.items())
        said.append(
            f"What then presses on the plain sample, its mean normal force over that at scale {means.index[0]:g}, is"
            f" {shares}; the ratio of patterned to plain wear is of this change, too, not of the particles' size alone."
        )
    if len(thin := means.index[means["layers"] < FEWEST_LAYERS]):
        scales = ", ".join(f"{scale:g}" for scale in thin)
        said.append(f"Beds of scale {scales} have fewer than {FEWEST_LAYERS:g} layers of particles: hardly beds.")
    return said


def read_critical_scale(path: str | Path) -> Crossing:
    """Return the critical scale from critical_scale.csv."""
    told = pd.read_csv(path, keep_default_na=True).iloc[0].to_dict()
    reason = told.pop("reason")
    return Crossing(**told, reason=reason if isinstance(reason, str) else "")


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
    """Return what is published of the velocity (m/s) in every layer and in the lowest one, for `curves_by_scale`.

    published: as in config/published/particle_size_results.csv; table: as from `over_the_sample`
    """
    highest = table["height_mm"].max()
    lowest = table.groupby("run")["height_mm"].min().max()
    reach = {"velocity_every_layer": highest, "velocity_lowest_layer": lowest}
    found = published[published["quantity"].isin(list(reach))]
    return found[["surface", "relation", "value"]].assign(place_to=found["quantity"].map(reach))


def wear_by_size_ratio(wear: pd.DataFrame, ratios: Mapping[float, SizeRatios]) -> pd.DataFrame:
    """Return the patterned sample's wear over its plain twin's beside the four ratios of size (Yan 2022, Fig 4.17).

    ratios: of the scaled particles, by particle scale; scales without are left out. Columns as of `ratio_by_scale`, and
    RATIOS.
    """
    table = ratio_by_scale(wear)
    table = table[table["particle_scale"].isin(ratios)].reset_index(drop=True)
    rows = [asdict(ratios[scale]) for scale in table["particle_scale"]]
    return pd.concat([table, pd.DataFrame(rows, columns=list(RATIOS))], axis=1)


def published_by_size_ratio(lines: pd.DataFrame, scales: np.ndarray) -> pd.DataFrame:
    """Return the same of the published lines: particle_scale, wear_over_plain and RATIOS of run R5's pattern.

    lines: curve, intercept and slope, as in config/published/particle_size_lines.csv
    """
    line = lines.set_index("curve")
    value = {name: line.loc[name, "intercept"] + line.loc[name, "slope"] * scales for name in (CONVEX, PLAIN)}
    ratios = [asdict(size_ratios(scale * PUBLISHED_DIAMETER, *PUBLISHED_PATTERN)) for scale in scales]
    table = pd.DataFrame({"particle_scale": scales, "wear_over_plain": value[CONVEX] / value[PLAIN]})
    return pd.concat([table, pd.DataFrame(ratios)], axis=1)


def lines_beside(published: pd.DataFrame, same_pattern: bool) -> pd.DataFrame:
    """Return the published lines that ours can be set beside: those of patterned samples for the source's pattern only,
    see `study.has_published_pattern`.
    """
    return published if same_pattern else published[published["curve"] == PLAIN]


def points_of(published: pd.DataFrame, wear: pd.DataFrame) -> pd.DataFrame:
    """Return curve, particle_scale and relative_wear of published lines at the least and the largest scale of ours."""
    ends = wear["particle_scale"].agg(["min", "max"]).to_frame()
    points = published[["curve", "intercept", "slope"]].merge(ends, how="cross")
    wear = points["intercept"] + points["slope"] * points["particle_scale"]
    return points[["curve", "particle_scale"]].assign(relative_wear=wear)


def beside_published(lines: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Return our lines with the published ones beside them: columns published_intercept, published_slope, source."""
    names = {"intercept": "published_intercept", "slope": "published_slope"}
    theirs = published[["curve", "intercept", "slope", "source"]].rename(columns=names)
    return lines.merge(theirs, on="curve", how="left")
