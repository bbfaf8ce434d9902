"""Numbers and sentences of the page of a circular wear tester, section by section, from the study's tables."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.statistics.intervals import UNKNOWN
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES, MILLIMETRES
from bulkwear.postproc.tables.summary import patterned_name, published_value, read_summary
from bulkwear.postproc.wear.prediction import Prediction, joined
from bulkwear.workflows.cases.circular_tester.comparison import worn_out_at
from bulkwear.workflows.cases.circular_tester.flow import steady_revolutions
from bulkwear.workflows.cases.circular_tester.model_numbers import fits_beside_ours, of_the_model
from bulkwear.workflows.cases.circular_tester.packings import HIGH, LOW
from bulkwear.workflows.cases.circular_tester.tables import LABORATORY, OURS, THESIS, THESIS_ALIKE
from bulkwear.workflows.cases.circular_tester.volume import (
    SETTING,
    TERMS,
    change_of_terms,
    fits_beside,
    published_terms,
    times_source,
    volume_of_terms,
)
from bulkwear.workflows.config.claims import date_of_rules
from bulkwear.workflows.engine.project import PACKAGE
from bulkwear.workflows.report.predictions import HEADS, Foreseen, error_of, prediction_note, prediction_table
from bulkwear.workflows.report.published import GIVEN
from bulkwear.workflows.report.sections import Block, Cards, Table, Text
from bulkwear.workflows.report.text import number

PUBLISHED = PACKAGE / "config" / "published" / "circular_tester.csv"
PUBLISHED_FITS = PUBLISHED.with_name("circular_tester_volume.csv")
FIT_DIGITS = 5
FIT_HEADS = {
    TERMS[0]: ("linear", "mm³ per revolution"),
    TERMS[1]: ("quadratic", "mm³ per revolution²"),
    "r_squared": ("R²", "-"),
}
INTERVAL_HEADS = {"": "", "_low": ", interval from", "_high": ", to"}
RATE = {"rate_mm3_per_revolution": ("lost per revolution", "mm³"), "change_percent": ("its change over the run", "%")}
FIT_RATE = {
    "fit_mm3_per_revolution": ("Yan 2022 per revolution", "mm³"),
    "fit_change_percent": ("Yan 2022, its change", "%"),
}
RATIO = {
    "ratio": ("patterned over plain", "-"),
    "reduction_percent": ("reduction", "%"),
    "change_percent": ("change of the ratio over the run", "%"),
}
STEADY_HEADS = {
    "start_revolutions": ("start", "revolution"),
    "mean": ("mean", "of the measure"),
    "drift_percent": ("drift", "%"),
    "drift_low_percent": ("drift, interval from", "%"),
    "drift_high_percent": ("to", "%"),
}
EXPERIMENT = "Yan 2022, section 6.2.3"
UNLIKE_ITS_SUM = "seven of them are not the volume that is printed of 56 h"
PER_REVOLUTION = "worn volume per revolution"
INTERVALS = "Intervals: 95 %, over packings; of one packing the scatter is unknown."
REDUCED = "At the reduced scale told at the top of the page: a finding that is contradicted here is not thereby wrong."
RESULTS_NOTE = (
    "Lost: removed from the sample; per revolution: what the law takes. Normal force: on the faces that wear. Sliding: "
    "of contacts on them, over the travel of the trough; wear is the product of both. Carried: worn by the law, not "
    "applied to the shape."
)
RESULT_HEADS = {
    "shape": ("machine", ""),
    "lost_volume_mm3": ("lost", "mm³"),
    "lost_per_revolution_mm3": ("lost per revolution", "mm³"),
    "pattern_share_percent": ("on pattern", "%"),
    "mean_normal_force_N": ("mean normal force", "N"),
    "sliding_over_travel": ("sliding over travel", "-"),
    "bed_over_floor_velocity": ("velocity of bed over trough", "-"),
    "carried_share_percent": ("carried", "%"),
}


def of_study(folder: Path, name: str) -> pd.DataFrame:
    """Return a table of the study."""
    return pd.read_csv(folder / "tester" / f"{name}.csv")


def heads_of(columns: Mapping[str, tuple[str, str]]) -> dict[str, tuple[str, str]]:
    """Return names and units of columns with intervals."""
    return {
        f"{column}{ending}": (f"{name}{words}", unit)
        for column, (name, unit) in columns.items()
        for ending, words in INTERVAL_HEADS.items()
    }


def beside_the_experiment(folder: Path) -> list[Block]:
    """Return the reductions, what sets the scale of time, and the comparison with the source."""
    compared = of_study(folder, "comparison")
    compared["note"] = compared["note"].fillna("")
    scale = of_study(folder, "time_scale").iloc[0]
    heads = {LOW: ("interval of ours, from", ""), HIGH: ("to", "")}
    digits = dict.fromkeys((LABORATORY, THESIS, THESIS_ALIKE, OURS, LOW, HIGH), 4)
    note = "Interval of ours: in which one further packing falls, at 95 %; of losses of bumps that of their mean."
    return [
        Cards(cards(compared, of_study(folder, "mean_ratios"), _patterned(folder))),
        Text(time_words(scale)),
        Table(compared, "comparison", note, digits, heads, beside_source=measured_beside_ours(compared)),
    ]


def measured_beside_ours(compared: pd.DataFrame) -> pd.DataFrame:
    """Return what was measured of the comparison as values beside values, volumes after hours and per weighing; the
    plain sample's are given: one sets the scale of time, and the rest follow, as far as it wears linearly, which is a
    finding of its own. Measured reductions stand among the findings, the model's numbers here.

    Intervals are those of means, as of all published numbers; compared: with those of one further packing
    """
    compared = _with_intervals_of_means(compared)
    measured = compared[compared[LABORATORY].notna() & (compared["unit"] == "mm3")]
    first = measured["hours"] == measured["hours"].min()
    said = measured.assign(
        setting=[f"experiment after {each:g} h" for each in measured["hours"]],
        published_value=measured[LABORATORY],
        **{GIVEN: np.where(measured["quantity"] == f"{PLAIN} volume", "yes", ""), "source": EXPERIMENT},
    )
    model = of_the_model(compared, pd.read_csv(PUBLISHED))
    table = pd.concat([said, _per_weighing(said[first]), model], ignore_index=True)
    names = {OURS: "computed_value", LOW: "computed_low", HIGH: "computed_high", "note": "reason"}
    columns = ["quantity", "setting", "unit", "published_value", *names, "packings", "source", GIVEN]
    return table[columns].replace({"unit": {"mm3": "mm³"}}).rename(columns=names)


def _with_intervals_of_means(compared: pd.DataFrame) -> pd.DataFrame:
    """Return the comparison with the intervals of the means of volumes and reductions, both told by a logarithm.

    One further packing falls within sqrt(packings + 1) times the reach of the mean's interval (`intervals.Estimate`).
    """
    share = 1.0 / np.sqrt(compared["packings"] + 1.0)
    ends = {}
    for name in (LOW, HIGH):
        volume = compared[OURS] * (compared[name] / compared[OURS]) ** share
        left, mean = (1.0 - compared[each] / 100.0 for each in (name, OURS))
        reduction = 100.0 * (1.0 - mean * (left / mean) ** share)
        ends[name] = volume.where(compared["unit"] == "mm3", reduction)
    return compared.assign(**ends)


def _per_weighing(measured: pd.DataFrame) -> pd.DataFrame:
    """Return what was lost between two weighings of the short test, beside as large a share of ours."""
    published = pd.read_csv(PUBLISHED)
    hours = published_value(published, "interval", "laboratory")
    quantities = [f"{row.quantity.replace(' ', '_')}_per_interval" for row in measured.itertuples()]
    values = [published_value(published, each, "laboratory") for each in quantities]
    told = measured.assign(published_value=values, setting=f"experiment per {hours:g} h", note=UNLIKE_ITS_SUM)
    ours = told[[OURS, LOW, HIGH]].mul(hours / told["hours"], axis=0)
    return told.assign(**ours)


def time_words(scale: pd.Series) -> str:
    """Return what the plain sample's short test says of hours and coefficients."""
    needed = _with_interval(scale, "revolutions_of_short_test")
    beyond = scale["revolutions_of_short_test"] > scale["simulated_revolutions"]
    mean_rate = f", by the mean rate of the {scale['simulated_revolutions']:g} simulated" if beyond else ""
    return (
        f"The plain sample's volume after 56 h sets the scale, all else is predicted: it takes {needed} revolutions"
        f"{mean_rate}, so one stands for {scale['hours_per_revolution']:.3g} h. The coefficient that makes the "
        f"source's two revolutions stand for 56 h would be {_with_interval(scale, 'wear_coefficient')} 1/Pa (simulated "
        f"{scale['simulated_coefficient']:.3g}), the laboratory's own, by its pressure and 121 km, is "
        f"{scale['laboratory_coefficient']:.3g} 1/Pa. Distance of the test over that of the revolutions: "
        f"{number(scale['distance_scale'], 3)}."
    )


def _with_interval(row: pd.Series, name: str) -> str:
    low, high = row[f"{name}_low"], row[f"{name}_high"]
    if not np.isfinite(low):
        return f"{number(row[name], 3)} ({UNKNOWN})"
    return f"{number(row[name], 3)} ({number(low, 3)} to {number(high, 3)})"


def cards(compared: pd.DataFrame, ratios: pd.DataFrame, name: str) -> list[tuple[str, str]]:
    """Return the few numbers that answer the question: reductions beside the measured ones, and patterned over plain.

    ratios: as from `comparison.mean_ratios`; name: the surface of the patterned samples
    """
    found = []
    for _, row in compared[compared["quantity"] == "reduction"].dropna(subset=OURS).iterrows():
        interval = f"one further packing: {row[LOW]:.3g} to {row[HIGH]:.3g} %" if np.isfinite(row[LOW]) else UNKNOWN
        words = f"less wear of the {name} sample after {row['hours']:g} h, {interval}{_beside(row)}"
        found.append((f"{row[OURS]:.3g} %", words))
    for _, row in ratios.iterrows():
        words = (
            f"{name} over plain, {row['shape']}, scale {row['particle_scale']:g}, {row['revolutions']:g} revolutions"
        )
        interval = f"{row['ratio_low']:.3g} to {row['ratio_high']:.3g}" if np.isfinite(row["ratio_low"]) else UNKNOWN
        found.append((f"{row['ratio']:.3g}", f"{words}: {interval}"))
    return found


def _beside(row: pd.Series) -> str:
    """Return what experiment and thesis have of a reduction; nothing of a surface that they did not have."""
    if np.isnan(row[LABORATORY]):
        return ""
    return f"; measured {row[LABORATORY]:.3g} %, thesis' model {row[THESIS]:.3g} %"


def _patterned(folder: Path) -> str:
    """Return the name of the surfaces of a study that are not plain."""
    return patterned_name(of_study(folder, "rates")["surface"])


def findings(study: Mapping[str, Any], folder: Path) -> list[Block]:
    """Return the source's findings with their verdicts."""
    table = of_study(folder, "findings").fillna({"reason": "", "found": ""})
    counts = ", ".join(f"{count} {verdict}" for verdict, count in table["verdict"].value_counts().items())
    said = [
        f"Of {len(table)} claims: {counts}. Margins and rules are those of {date_of_rules('circular_tester')};"
        " both, and why, stand in config/published/verdicts.yaml. Factor: found over published size.",
        *([REDUCED] if study["remarks"] else []),
    ]
    shown = ["verdict", "finding", "claim", "found", "reason", "factor", "source"]
    return [Text(" ".join(said)), Table(table[shown], "findings", beside_source=True)]


def rates(study: Mapping[str, Any], folder: Path) -> list[Block]:
    """Return what each setting loses per revolution and how that changes, beside the fits of the source."""
    theirs = pd.read_csv(PUBLISHED_FITS)[["surface", "particle_scale", *TERMS, "r_squared", "source"]]
    coefficient = of_study(folder, "time_scale")["simulated_coefficient"].iloc[0]
    times = times_source(coefficient, pd.read_csv(PUBLISHED))
    fits = fits_beside(theirs, study["told"]["foreign"], times)
    scaled = "" if times == 1.0 else f", times {times:.3g} for the wear coefficient"
    note = (
        "Change: from the first to the last revolution, by a straight line through the increments; the source's is that"
        f" of its fit over as many revolutions{scaled}. {INTERVALS}"
    )
    ours = with_fits(of_study(folder, "rates"), fits)
    beside = fits_beside_ours(ours if times == 1.0 else ours[:0])  # else the source prints no such numbers
    return [
        Table(ours, "rates", note, heads=heads_of(RATE) | FIT_RATE, beside_source=beside),
        Table(theirs, digits=dict.fromkeys([*TERMS, "r_squared"], FIT_DIGITS), heads=FIT_HEADS),
        *predicted_rates(of_study(folder, "rates"), error_of(study["settings"])),
    ]


def predicted_rates(found: pd.DataFrame, error: float) -> list[Block]:
    """Return what each setting loses per revolution with the error (-) of its coefficient; nothing where none is given.

    found: as from `volume.rates`. Hours of the test need none: the plain sample's measured volume sets them.
    """
    if not error > 0.0:
        return []
    rows = [
        Foreseen({name: getattr(row, name) for name in SETTING}, PER_REVOLUTION, "mm³", _joined(row, error))
        for row in found.itertuples()
    ]
    note = f"{prediction_note(rows, error)} Hours of the test do without: the plain sample's measured volume sets them."
    return [Table(prediction_table(rows), "predictions", note, heads=HEADS)]


def _joined(row: Any, error: float) -> Prediction:
    rate, high = row.rate_mm3_per_revolution, row.rate_mm3_per_revolution_high
    return joined(rate, high / rate - 1.0 if rate > 0.0 else math.nan, error, row.packings)


def with_fits(rates: pd.DataFrame, fits: pd.DataFrame) -> pd.DataFrame:
    """Return the rates with what the source's fits lose per revolution, and how that changes, over as many of them.

    fits: as from `volume.fits_beside`
    """
    terms = [published_terms(fits, row.surface, row.particle_scale) for row in rates.itertuples()]
    over = rates["revolutions"].tolist()
    return rates.assign(
        fit_mm3_per_revolution=[float(volume_of_terms(of, n)) / n for of, n in zip(terms, over, strict=True)],
        fit_change_percent=[float(change_of_terms(of, n)) for of, n in zip(terms, over, strict=True)],
    )


def ratios(folder: Path) -> list[Block]:
    """Return patterned over plain of each machine and particle scale with its interval."""
    note = f"Over the revolutions that all packings have; both samples of a packing share its bed. {INTERVALS}"
    return [Table(of_study(folder, "mean_ratios"), "patterned_over_plain", note, heads=heads_of(RATIO))]


def every_run(folder: Path) -> list[Block]:
    """Return the key numbers of every run."""
    results = result_table(read_summary(folder / "summary.csv"))
    digits = {"lost_volume_mm3": 4, "lost_per_revolution_mm3": 4}
    return [Table(results, "key_numbers", RESULTS_NOTE, digits, RESULT_HEADS)]


def sliding_over_travel(summary: Any) -> Any:
    """Return how far contacts slide over how far the trough goes (-), from sliding work and normal force.

    summary: rows of a summary, or one of them
    """
    return summary["sliding_work_J"] / (summary["mean_normal_force_N"] * summary["travel_m"])


def result_table(summary: pd.DataFrame) -> pd.DataFrame:
    """Return the key numbers of each run in display units."""
    names = ["run", "series", "surface", "shape", "particle_scale", "element_size_mm", "wear_coefficient_per_pa"]
    volume = summary["worn_volume_m3"]
    return summary[[*names, "revolutions"]].assign(
        lost_volume_mm3=summary["applied_volume_m3"] * CUBIC_MILLIMETRES,
        lost_per_revolution_mm3=volume * CUBIC_MILLIMETRES / summary["revolutions"],
        pattern_share_percent=100.0 * summary["pattern_worn_volume_m3"] / volume,
        mean_normal_force_N=summary["mean_normal_force_N"],
        sliding_over_travel=sliding_over_travel(summary),
        bed_over_floor_velocity=summary["bed_over_floor_velocity"],
        carried_share_percent=100.0 * (summary["carried_volume_m3"] / volume).abs(),
    )


def steadiness(folder: Path) -> list[Block]:
    """Return from which revolution of the bed each measure of each run is steady."""
    words = "Interval of the drift: of that run, for values that are correlated with their neighbours."
    return [Table(steady_revolutions(of_study(folder, "series")), "steadiness", words, heads=STEADY_HEADS)]


def by_column(folder: Path) -> list[Block]:
    """Return wear by column."""
    table = pd.read_csv(folder / "figures" / "tester_columns.csv")
    heads = {LOW: ("total, interval from", "mm³"), HIGH: ("to", "mm³")}
    return [Table(table, "wear_by_column", INTERVALS, heads=heads)]


def until_worn_out(folder: Path, thickness_mm: float) -> list[Block]:
    """Return when less than a twentieth of the pattern is left, run by run, and from when on a sample is worn deeper
    than it is thick, of a study with rows for that. thickness_mm: of sample and holder
    """
    left = pd.read_csv(folder / "figures" / "tester_worn_out.csv")
    histories = {run: pd.read_csv(folder / run / "wear.csv") for run in left["run"].unique()}
    said = [deeper_than_sample(left[left["run"] == run], history, thickness_mm) for run, history in histories.items()]
    return [Table(worn_out_at(left)), *(Text(each) for each in said if each)]


def deeper_than_sample(left: pd.DataFrame, history: pd.DataFrame, thickness_mm: float) -> str | None:
    """Return a sentence on a run that is somewhere worn deeper than sample and holder are thick; None of another.

    left: of the run, as from `comparison.pattern_left`; history: its wear.csv
    """
    deepest = MILLIMETRES * history["largest_depth_m"]
    if not (deepest > thickness_mm).any():
        return None
    share = history["revolution"][deepest > thickness_mm].iloc[0] / history["revolution"].iloc[-1]
    return (
        f"From revolution {number(share * left['revolution'].iloc[-1], 2)} on {left['run'].iloc[0]} is somewhere worn "
        f"deeper than sample and holder are thick, {thickness_mm:g} mm; at its end by {number(deepest.iloc[-1], 2)} mm."
        " What it loses there and then is that of a thicker one."
    )


def by_elements(folder: Path) -> list[Block]:
    """Return what the size of elements changes, of a study with rows for that."""
    heads = {LOW: ("interval from", "%"), HIGH: ("to", "%")}
    return [Table(pd.read_csv(folder / "figures" / "tester_mesh.csv"), note=INTERVALS, heads=heads)]
