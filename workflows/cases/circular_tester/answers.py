"""What a study of the circular wear tester answers, in sentences: the pattern against the plain sample, hours of the
test, what of the published numbers is reached, and where it wears most. One packing gives numbers without intervals.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from pathlib import Path

import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.intervals import UNKNOWN, estimates
from bulkwear.postproc.statistics.verdicts import AGREES, VERDICTS
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES
from bulkwear.postproc.tables.summary import patterned_name, published_value
from bulkwear.workflows.cases.circular_tester.comparison import worn_out_at
from bulkwear.workflows.cases.circular_tester.figure_findings import (
    faster_than_plain,
    most_worn,
    revolutions,
    share_on_pattern,
)
from bulkwear.workflows.cases.circular_tester.key_numbers import PUBLISHED_FITS, of_study
from bulkwear.workflows.cases.circular_tester.packings import HIGH, LOW
from bulkwear.workflows.cases.circular_tester.sensitivity_figures import SETTINGS_SAID
from bulkwear.workflows.cases.circular_tester.tables import BEYOND, LABORATORY, OURS
from bulkwear.workflows.cases.circular_tester.volume import TERMS, of_surface, times_source
from bulkwear.workflows.report.sentences import PERCENT, less_or_more, measured, with_interval
from bulkwear.workflows.report.text import number

PUBLISHED = PUBLISHED_FITS.with_name("circular_tester.csv")
RATE = "rate_mm3_per_revolution"
PLACES = ("tester_columns", "tester_bumps", "tester_force")  # figures: where it wears, and what presses on it
WORN_OUT, SENSITIVITY = "tester_worn_out", "tester_sensitivity"  # figures that not every study has


def all_answers(folder: Path, figures: Collection[str], foreign: Mapping[str, str]) -> list[str]:
    """Return the answers of a study with a pair, from its tables; folder: results/<study>; figures: that it has.

    foreign: {surface: why it is not the source's}, whose numbers no published ones stand beside
    """
    published = pd.read_csv(PUBLISHED)
    rates, scale = of_study(folder, "rates"), of_study(folder, "time_scale").iloc[0]
    name = patterned_name(rates["surface"])
    columns, bumps, force = (pd.read_csv(folder / "figures" / f"{each}.csv") for each in PLACES)
    worn_out, said = folder / "figures" / f"{WORN_OUT}.csv", folder / SETTINGS_SAID
    return [
        *ratios(of_study(folder, "mean_ratios"), name),
        hours(scale),
        *beside_experiment(of_study(folder, "comparison"), name),
        *plain_rates(rates, pd.read_csv(PUBLISHED_FITS), published, scale["simulated_coefficient"], foreign),
        *forces(force, published, name, foreign),
        *places(columns, bumps, name),
        *(gone(pd.read_csv(worn_out), scale["hours_per_revolution"]) if WORN_OUT in figures else []),
        claims(of_study(folder, "findings")),
        *(said.read_text(encoding="utf-8").splitlines()[:1] if SENSITIVITY in figures else []),
    ]


def each_setting(summary: pd.DataFrame) -> list[str]:
    """Return what a revolution takes off each sample, the force on it and how far the bed slides over it: of runs that
    are not compared. summary: a row per run
    """
    summary = summary[summary["mean_normal_force_N"] > 0.0]  # without any nothing has worn or slid
    per_revolution = CUBIC_MILLIMETRES * summary["worn_volume_m3"] / summary["revolutions"]
    slid = summary["sliding_work_J"] / summary["mean_normal_force_N"] / summary["travel_m"]
    of = {
        "rate": estimates(summary["setting"], per_revolution),
        "force": estimates(summary["setting"], summary["mean_normal_force_N"]),
        "slid": estimates(summary["setting"], PERCENT * slid),
    }
    surfaces = summary.drop_duplicates("setting").set_index("setting")["surface"]

    def told(what: str, setting: str, unit: str) -> str:
        found = of[what][setting]
        return with_interval(found.value, *found.interval(), found.packings, unit)

    return [
        f"A revolution takes {told('rate', name, 'mm³')} off the {surface} sample of {name}; the bed presses on it with"
        f" {told('force', name, 'N')} and slides over it by {told('slid', name, '%')} of the travel."
        for name, surface in surfaces.items()
    ]


def ratios(means: pd.DataFrame, name: str) -> list[str]:
    """Return what the patterned sample loses over the plain one, by machine; means: as from `comparison.mean_ratios`;
    name: of the patterned surface.
    """
    several, said = len(means) > 1, []
    for row in means.itertuples():
        ends = (row.ratio_low, row.ratio_high)
        where = f" in the {row.shape}, with particles at scale {row.particle_scale:g}," if several else ""
        ratio, change = with_interval(row.ratio, *ends, row.packings), less_or_more(row.ratio, *ends)
        of = f"of the plain one's volume over {revolutions(row.revolutions)}"
        said.append(f"The {name} sample loses{where} {ratio} {of}{change}.")
    return said


def hours(scale: pd.Series) -> str:
    """Return how many hours of the test a revolution and the run stand for; scale: a row of `TimeScale.table`."""
    needed = scale["revolutions_of_short_test"]
    each = scale["hours_per_revolution"]
    ends = (each * needed / scale[f"revolutions_of_short_test_{end}"] for end in ("high", "low"))
    told = with_interval(each, *ends, scale["packings"], "h")
    count = scale["simulated_revolutions"]
    return (
        f"A revolution stands for {told} of the real test, by the plain sample's volume; the {revolutions(count)} that"
        f" are simulated stand for {measured(each * count, 'h')}."
    )


def beside_experiment(compared: pd.DataFrame, name: str) -> list[str]:
    """Return the patterned sample's volume over the measured one; nothing of hours that either has not.

    compared: as from `tables.comparison_table`. The plain sample's volume sets the scale of time, so is no result.
    """
    said = []
    for _, row in compared[compared["quantity"] == f"{name} volume"].dropna(subset=[LABORATORY, OURS]).iterrows():
        known = math.isfinite(row[LOW])
        ends = f"one further packing: {measured(row[LOW])} to {measured(row[HIGH])}" if known else UNKNOWN
        inside = known and row[LOW] <= row[LABORATORY] <= row[HIGH]
        how = ", extrapolated" if BEYOND in str(row["note"]) else ""
        said.append(
            f"After {row['hours']:g} h the {name} sample has lost {measured(row[OURS], 'mm³')} ({ends}{how}),"
            f" {number(row[OURS] / row[LABORATORY], 2)} times the measured {measured(row[LABORATORY], 'mm³')}"
            f"{', which is within the interval' if inside else ', which is outside the interval' if known else ''}."
        )
    return said


def plain_rates(
    rates: pd.DataFrame,
    fits: pd.DataFrame,
    published: pd.DataFrame,
    coefficient: float,
    foreign: Collection[str] = (),
) -> list[str]:
    """Return what a revolution takes off the plain sample over what the source has at the same wear coefficient (1/Pa).

    rates: as from `volume.rates`; fits, published: as in config/published; foreign: surfaces that are not the source's
    """
    linear = fits.loc[fits["surface"] == PLAIN, TERMS[0]]
    factor = times_source(coefficient, published)
    theirs = (factor * linear.min(), factor * linear.max())
    said = []
    for _, row in of_surface(rates, PLAIN).iterrows():
        rate = with_interval(row[RATE], row[f"{RATE}_low"], row[f"{RATE}_high"], row["packings"], "mm³")
        known = "" if PLAIN in foreign else f", {beside(row[RATE], *theirs, 'mm³')} at this wear coefficient"
        scale = f"{row['particle_scale']:g}"
        said.append(f"A revolution takes {rate} off the plain sample at particle scale {scale}{known}.")
    return said


def forces(force: pd.DataFrame, published: pd.DataFrame, name: str, foreign: Collection[str] = ()) -> list[str]:
    """Return the normal force on both samples beside the published ones: of the plain sample over all revolutions, of
    the patterned one in the first, as the source's falls from there on.

    force: surface, revolution, mean (N); foreign: surfaces that are not the source's, told alone
    """
    plain, patterned = (of_surface(force, surface) for surface in (PLAIN, name))
    said = []
    if len(plain):
        ends = (published_value(published, f"plain_{end}_normal_force", "simulation") for end in ("least", "largest"))
        mean = plain["mean"].mean()
        known = "" if PLAIN in foreign else f", {beside(mean, *ends, 'N')}"
        said.append(f"The bed presses on the plain sample with {measured(mean, 'N')}{known}.")
    if len(patterned):
        first = patterned.loc[patterned["revolution"].idxmin(), "mean"]
        theirs = published_value(published, "convex_first_normal_force", "simulation")
        known = "" if name in foreign else f", {beside(first, theirs, theirs, 'N')}"
        said.append(f"In the first revolution it presses on the {name} one with {measured(first, 'N')}{known}.")
    return said


def beside(value: float, low: float, high: float, unit: str) -> str:
    """Return a value over the nearest published one, or that it is within these."""
    ends = measured(high, unit) if low == high else f"{measured(low)} to {measured(high, unit)}"
    if low <= value <= high:
        return f"within the published {ends}" if low < high else f"as the published {ends}"
    nearest = low if value < low else high
    which = "" if low == high else "least " if value < low else "largest "
    of = f" ({ends})" if low < high else f" {ends}"
    return f"{number(value / nearest, 2)} times the {which}published{of}"


def places(columns: pd.DataFrame, bumps: pd.DataFrame, name: str) -> list[str]:
    """Return the share of the pattern, and which of its shapes loses most.

    columns: surface, base_mm3, bumps_mm3; bumps: bump, volume_mm3 with packings and interval
    """
    share = PERCENT * share_on_pattern(columns, "mm3")
    said = [f"{share:.0f} % of the {name} sample's wear is on its pattern."]
    return [*said, most_worn(bumps)] if len(bumps) > 1 else said


def gone(left: pd.DataFrame, hours_per_revolution: float) -> list[str]:
    """Return after how many hours a pattern that is worn right off is gone, and from when its sample loses more.

    Nothing of patterns that stay. left: as from `comparison.pattern_left`
    """

    def told(revolution: float) -> str:
        of_test = measured(revolution * hours_per_revolution, "h")
        return f"{number(float(f'{revolution:.2g}'), 2)} revolutions ({of_test})"

    said = []
    for row in worn_out_at(left).itertuples():
        if not math.isfinite(row.worn_out_revolution):
            continue
        faster = faster_than_plain(row, told)
        said.append(f"The pattern of {row.run} is gone after {told(row.worn_out_revolution)}")
        said[-1] += f"; its sample {faster}." if faster else "."
    return said


def claims(findings: pd.DataFrame) -> str:
    """Return how the source's findings stand; findings: as from `findings.findings_table`."""
    counts = findings["verdict"].value_counts().reindex(VERDICTS, fill_value=0)
    others = ", ".join(f"{verdict} {count}" for verdict, count in counts.items() if verdict != AGREES and count)
    return f"Of the source's findings {counts[AGREES]} of {len(findings)} agree{f' ({others})' if others else ''}."
