"""Key numbers of a study of sliding samples, from its tables."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.intervals import UNKNOWN, Estimate, estimate, estimates
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES, in_display_units
from bulkwear.postproc.tables.packings import BY, over_packings
from bulkwear.postproc.tables.summary import read_summary
from bulkwear.postproc.wear.prediction import Prediction, predicted, shares_words
from bulkwear.workflows.engine.job import duration_text
from bulkwear.workflows.report.predictions import Foreseen, error_of, foreseen, prediction_blocks
from bulkwear.workflows.report.sections import Block, Cards, Table, Text
from bulkwear.workflows.report.sentences import INTERVAL, less_or_more, side
from bulkwear.workflows.report.text import number

ROUNDING_DIGITS = 9  # of a percentage: below is what sums leave of zero
DIGITS = 2  # significant ones of a ratio in words
PERCENT = 100.0
SECONDS_PER_HOUR, MICROMETRES_PER_MM = 3600.0, 1000.0
DEPTH_RATES = ("largest_depth", "depth_of_99_percent")  # of the table of depths
PER_METRE = "worn_volume_per_metre_m3_per_m"


def depths_of(folder: Path) -> pd.DataFrame:
    """Return the `depth_summary` of every run of a study."""
    from bulkwear.postproc.tables.depths import depth_summary  # slow to import, and every start reads this module

    columns = ["run", "depth_um", "area_mm2"]
    return depth_summary(pd.read_csv(folder / "figures" / "worn_surface.csv", usecols=columns, dtype={"run": str}))


def key_numbers(study: Mapping[str, Any], folder: Path) -> list[Block]:
    """Return the answer to a study's question in cards, and the numbers of every setting."""
    from bulkwear.workflows.cases.sliding_sample.search.page import of_best

    summary, settings, depths = read_summary(folder / "summary.csv"), study["settings"], depths_of(folder)
    acceleration = settings["wear"]["acceleration"]
    results = result_table(summary, depths, acceleration)
    needless = [
        *(["carried_share_percent"] if not settings["wear"]["deform"] else []),
        *(["real_volume_per_metre_mm3_per_m"] if acceleration == 1.0 else []),
    ]
    shown, best = results.drop(columns=needless).dropna(axis="columns", how="all"), of_best(summary, folder)
    return [
        *([Cards(found)] if (found := cards(best, acceleration)) else []),
        Table(shown, "key_numbers"),
        Text(note(settings, results["packings"])),
        *prediction_blocks(predictions(best, depths, acceleration, error_of(settings)), error_of(settings)),
    ]


def wear_over_plain(summary: pd.DataFrame) -> dict[tuple[str, str], Estimate]:
    """Return the wear over plain (-) by setting and surface, lowest first; those without a plain twin are left out."""
    twins = summary[(summary["surface"] != PLAIN) & summary["wear_over_plain"].notna()]
    keys = pd.MultiIndex.from_frame(twins[list(BY)]).to_flat_index()
    found = estimates(keys, twins["wear_over_plain"].to_numpy(), log=True)
    return dict(sorted(found.items(), key=lambda item: item[1].value))


def answers(summary: pd.DataFrame) -> list[str]:
    """Return what a study's patterns do to the wear: the lowest in numbers, and how many wear less and more.

    More or less is said only where the interval excludes 1; of how many others the interval reaches down to that of the
    lowest is told, as of all without one.
    """
    found = wear_over_plain(summary)
    if not found:
        return []
    (setting, surface), best = next(iter(found.items()))
    change = less_or_more(best.value, *best.interval())
    said = f"The {surface} sample of {setting} wears {best.text(DIGITS)} of the plain sample's volume{change}."
    if len(found) == 1:
        return [said]
    less, more = (sum(side(*each.interval()) == where for each in found.values()) for where in (-1, 1))
    open_ = len(found) - less - more
    counts = (
        f"{less} of {len(found)} patterns wear less than their plain twin, {more} more; of {open_} it cannot be said."
    )
    alike = sum(not each.interval()[0] > best.interval()[1] for each in found.values()) - 1  # also without an interval
    return [counts, f"Lowest: {said[0].lower()}{said[1:]}{_others_words(alike, len(found) - 1)}"]


def _others_words(alike: int, others: int) -> str:
    """Return of how many others it is open whether they wear more than the lowest; nothing where of none."""
    if not alike:
        return ""
    who = f"{alike} of the {others} others" if alike < others else "the others" if others > 1 else "the other"
    return f" Whether {who} wear{'' if others > 1 else 's'} more cannot be said."


def facts(summary: pd.DataFrame, depths: pd.DataFrame, acceleration: float, error: float = 0.0) -> list[str]:
    """Return how fast the deepest places of the lowest setting wear, and for how long its runs stand.

    depths: of every run, as from `depths.depth_summary`; error: -, of the wear coefficient
    """
    shown = lowest_runs(summary, depths, acceleration)
    said = []
    for surface, runs in shown.groupby("surface", sort=False):
        deepest, hundredth = (estimate(runs[f"{name}_mm_per_h"]) for name in DEPTH_RATES)
        ends = _ends_in_words(predicted(deepest, error))
        said.append(
            f"The deepest place of the {surface} sample of {shown['setting'].iloc[0]} wears"
            f" {number(deepest.value, DIGITS)} mm per hour{ends}, a hundredth of its area at least"
            f" {number(hundredth.value, DIGITS)} mm."
        )
    time, hours = float(shown["time_s"].mean()), float(shown["hours"].mean())
    stands = f", which stand for {duration_text(SECONDS_PER_HOUR * hours)} of wear" if acceleration != 1.0 else ""
    return [*said, f"Its runs slide for {time:.3g} s{stands}."]


def _ends_in_words(found: Prediction) -> str:
    """Return the interval of a rate in mm per hour and what makes it wide, in brackets; "" where neither is known."""
    if found.known:
        low, high = (number(end, DIGITS) for end in (found.low, found.high))
        shares = f"; {shares_words(found.scatter_share)}" if found.coefficient_reach > 0.0 else ""
        return f" ({INTERVAL} {low} to {high} mm, {found.packings} packings{shares})"
    if not found.coefficient_reach > 0.0:
        return ""
    low, high = (number(end, DIGITS) for end in (found.coefficient_low, found.coefficient_high))
    return f" ({UNKNOWN}; the wear coefficient alone gives {low} to {high} mm)"


def lowest_runs(summary: pd.DataFrame, depths: pd.DataFrame, acceleration: float) -> pd.DataFrame:
    """Return the runs of the setting with the lowest wear over plain, else of the first one, with the hours that they
    stand for and DEPTH_RATES in mm per hour; arguments as for `facts`.
    """
    settings = [setting for setting, _ in wear_over_plain(summary)] or summary["setting"].tolist()
    shown = summary[summary["setting"] == settings[0]].merge(depths, on="run")
    hours = shown["time_s"] * acceleration / SECONDS_PER_HOUR
    rates = {f"{name}_mm_per_h": shown[f"{name}_um"] / MICROMETRES_PER_MM / hours for name in DEPTH_RATES}
    return shown.assign(hours=hours, **rates)


def predictions(summary: pd.DataFrame, depths: pd.DataFrame, acceleration: float, error: float) -> list[Foreseen]:
    """Return what the samples of the lowest setting lose by the true coefficient, per metre and hour, and in how many
    hours their deepest place loses a millimetre; arguments as for `facts`.
    """
    shown, found = lowest_runs(summary, depths, acceleration), []
    for (setting, surface), runs in shown.groupby(list(BY), sort=False):
        whose = {"setting": setting, "surface": surface}
        volume = CUBIC_MILLIMETRES * runs["worn_volume_m3"]
        deepest = runs[f"{DEPTH_RATES[0]}_mm_per_h"]
        rows = (
            ("worn volume per metre of travel", "mm³/m", estimate(volume / runs["travel_m"] / acceleration, log=True)),
            ("worn volume per hour", "mm³/h", estimate(volume / runs["hours"], log=True)),
            ("depth of the deepest place per hour", "mm/h", estimate(deepest)),
        )
        found += [foreseen(whose, what, unit, each, error) for what, unit, each in rows]
        hours = estimate(1.0 / deepest[deepest > 0.0], log=True)
        found.append(foreseen(whose, "until the deepest place has lost 1 mm", "h", hours, error, inverse=True))
    return found


def note(settings: Mapping[str, Any], packings: pd.Series) -> str:
    """Return what must be said of the key numbers; packings: of every line."""
    acceleration = settings["wear"]["acceleration"]
    said = ["Wear by the study's law on the sample, without the skirt."]
    if acceleration != 1.0:
        said.append(
            "Per metre: of simulated travel, with the accelerated coefficient; real: the same over the acceleration of "
            f"{acceleration:g}."
        )
    said.append("Mean normal force: contact forces square to the faces, added up over the sample.")
    if (packings > 1).any():
        said.append(
            f"Means over the packings, of wear and its ratios geometric; low and high: {INTERVAL} of the mean, over "
            "plain from ratios of the two samples in the same packing."
        )
    if (packings < 2).any():
        said.append(f"{UNKNOWN.capitalize()}: numbers without an interval.")
    if settings["wear"]["deform"]:
        said.append("Carried share: worn by the law, not applied to the shape yet, see What is simplified.")
    return " ".join(said)


def result_table(summary: pd.DataFrame, depths: pd.DataFrame, acceleration: float) -> pd.DataFrame:
    """Return the key numbers of each setting and surface, in display units: wear over plain and per metre, as simulated
    and as accelerated test, with intervals over the packings; means of the share of the pattern, the carried share,
    forces and depths.
    """
    volume = summary["worn_volume_m3"]
    table = summary[[*BY, "travel_m", "worn_volume_m3", "wear_over_plain"]].assign(
        **{PER_METRE: volume / summary["travel_m"]},
        real_volume_per_metre_m3_per_m=volume / summary["travel_m"] / acceleration,
        pattern_share_percent=PERCENT * summary["pattern_worn_volume_m3"] / volume,
        carried_share_percent=(PERCENT * summary["carried_volume_m3"] / volume).round(ROUNDING_DIGITS).abs(),
        mean_normal_force_N=summary["mean_normal_force_N"],
        **depths.set_index("run").reindex(summary["run"]).reset_index(drop=True),
    )
    ends = ["interval_low", "interval_high"]
    over_plain = over_packings(table, "wear_over_plain")
    over_plain.loc[over_plain["surface"] == PLAIN, ends] = float("nan")  # 1 by definition
    wear = over_packings(table, PER_METRE, parts=("worn_volume_m3", "real_volume_per_metre_m3_per_m"))
    wear = wear.rename(columns={end: f"{PER_METRE.removesuffix('_m3_per_m')}_{end[9:]}_m3_per_m" for end in ends})
    first = [*BY, "packings", "wear_over_plain", *ends]
    named = wear.assign(**over_plain[["wear_over_plain", *ends]])
    low_high = [name for name in wear if name.endswith(("low_m3_per_m", "high_m3_per_m"))]
    others = [name for name in wear if name not in (*first, PER_METRE, *low_high)]
    return in_display_units(named[[*first, PER_METRE, *low_high, *others]])


def cards(summary: pd.DataFrame, acceleration: float) -> list[tuple[str, str]]:
    """Return (number, what it is) of the few that answer the question, lowest wear first; none without a plain twin."""
    found = wear_over_plain(summary)
    if not found:
        return []
    (setting, surface), best = next(iter(found.items()))
    several = len(found) > 1
    which = f"{setting}, the lowest of {len(found)}" if several else setting
    text, _, interval = best.text(DIGITS).partition(" (")
    ends = f": {interval.removesuffix(')')}" if interval else ""
    told = [(text, f"{surface} over plain wear, {which}{ends}")]
    unit = f"mm³/m{' (accelerated)' if acceleration != 1.0 else ''}"
    wear = in_display_units(over_packings(summary[[*BY, PER_METRE]], PER_METRE))
    for name in (surface, PLAIN):
        row = wear[(wear["setting"] == setting) & (wear["surface"] == name)].iloc[0]
        told.append((number(row["worn_volume_per_metre_mm3_per_m"], 3), f"{unit}, {setting} {name}"))
    if not several:
        of_best = summary[(summary["setting"] == setting) & (summary["surface"] == surface)]
        share = PERCENT * (of_best["pattern_worn_volume_m3"] / of_best["worn_volume_m3"]).mean()
        told.append((f"{share:.0f} %", f"of the {surface} sample's wear is on its pattern"))
    return told
