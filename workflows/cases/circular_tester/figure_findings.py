"""What the figures of the circular wear tester show, in one sentence each, from the tables beside them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.tables.display import DEGREES, MILLIMETRES
from bulkwear.workflows.cases.circular_tester.sensitivity import most_reached
from bulkwear.workflows.report.sentences import PERCENT, listed, measured, spoken, with_interval
from bulkwear.workflows.report.text import number, range_text

MEASURES = {"velocity_m_per_s": "velocity", "bed_height_m": "bed height", "wear_rate_m3_per_s": "wear rate"}
LOW, HIGH = "interval_low", "interval_high"


def plain_and_other(table: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the rows of plain samples and those of others."""
    plain = table["surface"] == PLAIN
    return table[plain], table[~plain]


def revolutions(count: float) -> str:
    """Return a number of revolutions in words."""
    return f"{count:g} revolution{'' if count == 1 else 's'}"


def setting_words(table: pd.DataFrame, row: pd.Series) -> str:
    """Return the surface of a row, with its machine and particle scale where the table has several."""
    several = [name for name in ("shape", "particle_scale") if table[name].nunique() > 1]
    words = {"shape": str(row["shape"]), "particle_scale": f"scale {row['particle_scale']:g}"}
    told = ", ".join(words[name] for name in several)
    return f"{row['surface']} ({told})" if several else str(row["surface"])


# ---------------------------------------------------------------- volumes


def reduction(compared: pd.DataFrame) -> str:
    """Return how much less a pattern wears after hours of the test, beside what was measured.

    compared: as from `tables.comparison_table`
    """
    said = []
    for _, row in compared[compared["quantity"] == "reduction"].dropna(subset="ours").iterrows():
        known = math.isfinite(row[LOW])
        ends = f"one further packing: {row[LOW]:.0f} to {row[HIGH]:.0f} %" if known else UNKNOWN
        beside = f"; measured {row['experiment']:.0f} %" if math.isfinite(row["experiment"]) else ""
        more = "less" if row["ours"] >= 0.0 else "more"
        said.append(f"{abs(row['ours']):.0f} % {more} after {row['hours']:g} h ({ends}{beside})")
    return f"The pattern wears {listed(said)}." if said else ""


def lost(means: pd.DataFrame) -> str:
    """Return what each setting has lost in the end; means: as from `volume.mean_volumes`."""
    ends = means.loc[means.groupby(["surface", "shape", "particle_scale"], sort=False)["revolution"].idxmax()]
    said = [
        f"{setting_words(ends, row)} {measured(row['volume_mm3'], 'mm³')} in {revolutions(row['revolution'])}"
        for _, row in ends.iterrows()
    ]
    return f"Lost are by {listed(said)}."


def increments(grown: pd.DataFrame) -> str:
    """Return what each setting loses in its first and last revolution; grown: as from `volume.mean_increments`."""
    said = []
    for _, rows in grown.groupby(["surface", "shape", "particle_scale"], sort=False):
        ordered = rows.sort_values("revolution")
        first, last = ordered.iloc[0], ordered.iloc[-1]
        ends = measured(first["increment_mm3"], "mm³", 3)
        if len(rows) > 1:
            ends = f"{ends} in its first and {measured(last['increment_mm3'], 'mm³', 3)} in its last"
        said.append(f"{setting_words(grown, first)} {ends}")
    return f"A revolution takes off {'; '.join(said)}."


def reduction_by_scale(predicted: pd.DataFrame) -> str:
    """Return how much less a pattern wears after the short test by particle scale; predicted: `hours.predictions`."""
    _, patterned = plain_and_other(predicted[predicted["hours"] == predicted["hours"].min()])
    known = patterned.dropna(subset="reduction_percent")
    if known.empty:
        return ""
    said = [f"{row.reduction_percent:.0f} % at scale {row.particle_scale:g}" for row in known.itertuples()]
    return f"After {known['hours'].iloc[0]:g} h the pattern has lowered the wear by {listed(said)}."


def worn_off(left: pd.DataFrame) -> str:
    """Return when patterns are gone, or how much of them is left; left: as from `comparison.pattern_left`."""
    from bulkwear.workflows.cases.circular_tester.comparison import worn_out_at  # slow to import

    said = []
    for row in worn_out_at(left).itertuples():
        if math.isfinite(row.worn_out_revolution):
            gone = f"is gone after {measured(row.worn_out_revolution)} revolutions"
        else:
            gone = f"keeps {PERCENT * row.last_share:.3g} % in the end"
        then = f" and {often}" if (often := faster_than_plain(row, measured)) else ""
        said.append(f"the pattern of {row.run} {gone}{then}")
    shown = "; ".join(said)
    return f"{shown[0].upper()}{shown[1:]}."


def faster_than_plain(row: Any, told: Callable[[float], str]) -> str:
    """Return from when a patterned sample wears faster than the plain one, first and for good; nothing where it never
    does. row: of `comparison.worn_out_at`; told: returns a number of revolutions in words.
    """
    first, for_good = row.faster_revolution, row.faster_for_good_revolution
    if not math.isfinite(first):
        return ""
    if first == for_good:
        return f"wears faster than plain from {told(first)} on"
    then = f", for good from {told(for_good)} on" if math.isfinite(for_good) else ", but not to the end"
    return f"wears faster than plain first at {told(first)}{then}"


# ---------------------------------------------------------------- places


def share_on_pattern(columns: pd.DataFrame, unit: str) -> float:
    """Return the share (-) of the pattern in a sum over patterned samples; columns: base_<unit>, bumps_<unit>."""
    _, own = plain_and_other(columns)
    sums = own[[f"base_{unit}", f"bumps_{unit}"]].sum()
    return float(sums.iloc[1] / sums.sum()) if sums.sum() else math.nan


def columns_of(unit: str, shown: str, what: str):
    """Return the finding of a figure by column; unit: of its table's columns; shown: as read; what: is told."""

    def finding(columns: pd.DataFrame) -> str:
        share, total = share_on_pattern(columns, unit), f"total_{unit}"
        most = columns.loc[columns.groupby("surface", sort=False)[total].idxmax()]
        ends = [
            f"column {row['column']} of the {row['surface']} sample ({measured(row[total], shown)})"
            for _, row in most.iterrows()
        ]
        start = f"The pattern bears {PERCENT * share:.0f} % of its sample's {what}; m" if math.isfinite(share) else "M"
        return f"{start}ost is on {listed(ends)}."

    return finding


wear_by_column, force_by_column = columns_of("mm3", "mm³", "wear"), columns_of("N", "N", "normal force")


def most_worn(bumps: pd.DataFrame) -> str:
    """Return which shape of a pattern loses most, and whether the intervals tell it from the next one.

    bumps: bump, volume_mm3 with packings and interval
    """
    ordered = bumps.sort_values("volume_mm3", ascending=False, kind="stable")
    first = ordered.iloc[0]
    volume = with_interval(first["volume_mm3"], first[LOW], first[HIGH], first["packings"], "mm³")
    if len(ordered) == 1:
        return f"{first['bump']} loses {volume}."
    second, times = ordered.iloc[1], number(first["volume_mm3"] / bumps["volume_mm3"].mean(), 2)
    sure = first[LOW] > second[HIGH]
    doubt = "" if sure or first["packings"] < 2 else f"; {second['bump']}, the next one, may lose as much"
    return f"Of {len(bumps)} shapes {first['bump']} loses most, {volume}, {times} times their mean{doubt}."


def crests(contours: pd.DataFrame) -> pd.DataFrame:
    """Return the height (mm) of the crest of each bump in sections: index bump, columns the names of the surfaces, the
    pristine one first.

    contours: bump, name, height_mm
    """
    names = list(dict.fromkeys(contours["name"].astype(str)))
    heights = contours.assign(name=contours["name"].astype(str)).groupby(["bump", "name"])["height_mm"].max()
    return heights.unstack()[names]


def lowered_crests(contours: pd.DataFrame) -> str:
    """Return how far the crests of the bumps shown are lowered in the last section."""
    heights = crests(contours)
    last = heights.columns[-1]
    loss = (heights.iloc[:, 0] - heights[last]).items()
    said = [f"{bump} by {measured(1e3 * each, 'µm')}" for bump, each in loss]
    return f"After {last} revolutions the crests are lowered: {listed(said)}."


def crests_by_mesh(contours: pd.DataFrame) -> str:
    """Return how far the crest of a bump differs between meshes after equal revolutions."""
    heights = crests(contours)
    worn = heights.iloc[:, 1:]
    if worn.shape[1] < 2:
        return ""
    apart = float((worn.max(axis=1) - worn.min(axis=1)).max())
    return f"The crest of {listed(list(heights.index))} differs by {measured(1e3 * apart, 'µm')} between the meshes."


def change_by_mesh(effect: pd.DataFrame) -> str:
    """Return how volumes change from the finest to the coarsest elements; effect: `distribution.mesh_size_effect`."""
    said = []
    for surface, rows in effect.groupby("surface", sort=False):
        ordered = rows.sort_values("element_size_mm")
        fine, coarse = ordered.iloc[0], ordered.iloc[-1]
        if len(rows) > 1:
            change = PERCENT * (coarse["relative_percent"] / fine["relative_percent"] - 1.0)
            said.append(f"{surface} {change:+.1f} %")
    if not said:
        return ""
    sizes = effect["element_size_mm"]
    return f"From elements of {sizes.min():g} to {sizes.max():g} mm volumes change: {listed(said)}."


def by_machine(means: pd.DataFrame) -> str:
    """Return patterned over plain in each machine; means: as from `comparison.mean_ratios`."""
    said = [
        f"{with_interval(row.ratio, row.ratio_low, row.ratio_high, row.packings)} in the {row.shape}"
        + (f" at scale {row.particle_scale:g}" if means["particle_scale"].nunique() > 1 else "")
        for row in means.itertuples()
    ]
    return f"Patterned over plain wear is {listed(said)}, over {revolutions(means['revolutions'].min())}."


# ---------------------------------------------------------------- flow


def variations(table: pd.DataFrame) -> str:
    """Return by how much measures vary within the last revolution that each has.

    table: surface, measure, revolution, variation
    """
    last = table.loc[table.groupby(["surface", "measure"], sort=False)["revolution"].idxmax()]
    said = [
        f"{MEASURES.get(measure, spoken(measure))} by {range_text([PERCENT * each for each in rows['variation']])} %"
        for measure, rows in last.groupby("measure", sort=False)
    ]
    return f"Within the last revolution these vary: {listed(said)}."


def over_plain(measure: str, words: str, unit: str, factor: float = 1.0):
    """Return the finding of a figure of a measure by revolution: mean on both samples, and the one over the other.

    words: what is patterned over plain, with the ratio open; factor: of the unit that is shown
    """

    def finding(means: pd.DataFrame) -> str:
        plain, other = (factor * rows.loc[rows["measure"] == measure, "mean"].mean() for rows in plain_and_other(means))
        if not math.isfinite(plain) or not math.isfinite(other):
            return ""
        ends = f"{measured(other, unit)} against {measured(plain, unit)}"
        return f"{words.format(number(other / plain, 2))} ({ends}, mean of the revolutions)."

    return finding


spin = over_plain(
    "bottom_averaged_angular_velocity_rad_per_s",
    "Over the pattern the lowest layer turns {} times as fast as over the plain sample",
    "°/s",
    DEGREES,
)
velocity = over_plain(
    "bottom_velocity_m_per_s",
    "Over the pattern the lowest layer passes {} times as fast as over the plain sample",
    "mm/s",
    MILLIMETRES,
)
force = over_plain("normal_force_N", "The bed presses on the pattern {} times as much as on the plain sample", "N")


def relative_to_plain(column: str, verb: str):
    """Return the finding of a map of the lowest layer: mean over the pattern of a speed over the plain sample's."""

    def finding(particles: pd.DataFrame) -> str:
        _, other = plain_and_other(particles)
        if other.empty:
            return ""
        ratio = number(other[column].mean(), 2)
        return f"Of this instant, the particles over the pattern {verb} {ratio} times as fast as those over plain."

    return finding


turning, passing = relative_to_plain("relative_angular_speed", "turn"), relative_to_plain("relative_speed", "pass")


def reached(table: pd.DataFrame) -> str:
    """Return how many published numbers the reference and the settings with most of them reach; table:
    `sensitivity_table`.
    """
    counts, asked = table.groupby("pair", sort=False)["reached"].sum(), table["key"].nunique()
    said, best = f"The {counts.index[0]} reaches {counts.iloc[0]} of {asked} published numbers", most_reached(counts)
    if counts.index[0] in best:
        return f"{said}." if len(counts) == 1 else f"{said}, no setting more."
    return f"{said}; {listed(best)} {'reach' if len(best) > 1 else 'reaches'} {counts.max()}, the most."
