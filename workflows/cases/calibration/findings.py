"""What a finished calibration says, in sections of its page: numbers as tables and in words."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.inference.posterior import FAMILY_SHARE
from bulkwear.postproc.inference.told import told_table
from bulkwear.postproc.statistics.intervals import CONFIDENCE, Estimate
from bulkwear.workflows.cases.calibration.case import PUBLISHED, published
from bulkwear.workflows.cases.calibration.checked_pairs import CHECKED, checked_means
from bulkwear.workflows.cases.calibration.outcome import Calibrated, read_calibrated
from bulkwear.workflows.cases.calibration.responses import (
    FOUND_FIRST,
    PARAMETER_NAMES,
    RECOMMENDED,
    information_table,
    interval_table,
    parameter_name,
    response_name,
)
from bulkwear.workflows.cases.calibration.simulations import BLOCKED, FOLDERS, cost_table, used_folders
from bulkwear.workflows.cases.calibration.told import told_sentences
from bulkwear.workflows.engine.project import current_project
from bulkwear.workflows.report.fillings import NOTE, fillings_of, fillings_table
from bulkwear.workflows.report.sections import Block, Cards, Listing, Pictures, Points, Section, Table, Text
from bulkwear.workflows.report.sensitivity import read_indices, sensitivity_blocks

INSIDE = (
    "Inside: at most one standard deviation of the measurement away; within its uncertainty: closer than that and the "
    "simulated mean's own uncertainty together. Deviations: simulated minus measured, in standard deviations of the "
    "measurement. Denser share: of the posterior in pairs that fit better; a pair belongs to the family when it is at "
    "most 0.95."
)
DISCHARGE = "discharge_time_s"  # response
MARGIN_DEVIATIONS = 2.0  # -, standard deviations of the measurement that a pair's response may be off
NORMAL = NormalDist().inv_cdf(0.5 + 0.5 * CONFIDENCE)  # -, standard deviations to each side
AT_PUBLISHED = (
    "Computed: mean of the surrogate, low and high its 95 % interval; margin: two standard deviations of the source's "
    "measurement of that response."
)
LEFT_NOTE = (
    "Low to high: 95 % of the posterior, with measurement, model and surrogate all in doubt. Left: of the range's 95 % "
    "interval; left, others known: the same with all other parameters held. Told: at most 0.8 is left."
)
INFORMATION = (
    "What measuring a response once more is expected to tell about the parameters; 1 bit halves the family. Responses "
    "that were not simulated are missing."
)


def read_finished(study: Mapping[str, Any], folder: Path) -> Calibrated:
    """Return the finished calibration of a study's folder; study as told to its page."""
    parameters = study["told"]["parameters"]
    names = (parameters["calibration"][key] for key in ("measured", "simulated_before"))
    return read_calibrated(parameters, *(current_project().file(f"{PUBLISHED}/{name}") for name in names), folder)


def sections_of(done: Calibrated, study: str) -> list[Section]:
    """Return the sections of a calibration's page; checked pairs only where there are some."""
    intervals = interval_table(done.problem, done.known, done.pairs[done.compared])
    checked = (done.folder / CHECKED).is_file()
    return [
        Section(
            "The family and the recommended pair",
            [Cards(cards(done, intervals)), *_intervals(done, intervals), Pictures(["family"])],
        ),
        Section("Against what was measured", against_measured(done)),
        Section("What to measure next", next_measurement(done)),
        Section("Responses over both frictions", [*simulations(done), Pictures(["response_maps"])]),
        Section("Which parameter decides", [*deciding(done.folder), Pictures(["calibration_sensitivity"])]),
        Section("At the pairs that others simulated", [at_published(done)]),
        Section("Size and width of the box", [sizes(done.folder), Pictures(["box_sizes"])]),
        *([Section("Pairs in tests that the calibration did not use", checked_pairs(done))] if checked else []),
        Section("The heap of the recommended pair", [Pictures(["heaps"])]),
        Section("Use of the result", use(done.folder, study)),
        Section("Fillings", [filled(done.folder)]),
        Section("Cost of the simulations", cost(done.folder)),
    ]


def _intervals(done: Calibrated, intervals: pd.DataFrame) -> list[Block]:
    """Return the intervals with what they leave of the ranges, and in words which parameters are not told."""
    table = intervals.merge(told_table(done.problem, done.known), on="parameter")
    return [Table(_named(table), note=LEFT_NOTE), Points(told_sentences(done.problem, done.known))]


def _named(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table with responses and parameters as people call them, in its cells and its columns of parameters."""
    names = {"response": response_name, "parameter": parameter_name}
    cells = {column: table[column].map(name) for column, name in names.items() if column in table}
    return table.assign(**cells).rename(columns=PARAMETER_NAMES)


# ---------------------------------------------------------------- pairs


def cards(done: Calibrated, intervals: pd.DataFrame) -> list[tuple[str, str]]:
    """Return the few numbers that answer the question."""
    share = float(done.statements.set_index("pair").loc[[done.compared], "denser_share"].iloc[0])
    other = ", ".join(f"{value:g}" for value in done.pairs[done.compared].values())
    place = "in" if share <= FAMILY_SHARE else "outside"
    fits = (f"{100.0 * share:.3g} %", f"of the posterior fits better than ({other}): {place} the family")
    searched = fits if np.isfinite(share) else ("not searched", f"where ({other}) lies, outside of the range")
    return [
        *(
            (
                f"{row.recommended:.2f}",
                f"{parameter_name(row.parameter)}, 95 % between {row.low:.2f} and {row.high:.2f}",
            )
            for row in intervals.itertuples()
        ),
        (str(len(done.simulations)), "simulations until the stopping rule or the limit"),
        searched,
    ]


def against_measured(done: Calibrated) -> list[Block]:
    """Return both pairs beside the measured bands, as a table and in words."""
    table = done.statements.drop(columns=done.problem.names)
    return [
        Table(_named(table), "statements", INSIDE, beside_source=measured_beside(done.statements, _sources(done))),
        Points([*(_pair_sentence(done, pair) for pair in (RECOMMENDED, done.compared)), *sentences(done)]),
        Pictures(["pairs_against_bands"]),
    ]


def measured_beside(statements: pd.DataFrame, sources: Mapping[str, str]) -> pd.DataFrame:
    """Return measured responses as published values beside the means of the pairs that were simulated over packings.

    statements: as from `responses.statement_table`; sources: of the measurements, by response
    """
    rows = []
    for row in statements[(statements["seeds"] > 0) & statements["measured"].notna()].to_dict("records"):
        name, _, unit = response_name(row["response"]).removesuffix(")").rpartition(" (")
        low, high = Estimate(row["simulated"], row["simulated_uncertainty"], row["seeds"] - 1, row["seeds"]).interval()
        rows.append(
            {"quantity": f"{name}, measured", "setting": f"{row['pair'].replace('_', ' ')} pair", "unit": unit}
            | {"published_value": row["measured"], "margin": MARGIN_DEVIATIONS * row["measured_deviation"]}
            | {"computed_value": row["simulated"], "computed_low": low, "computed_high": high}
            | {"packings": row["seeds"], "source": sources.get(row["response"], "")}
        )
    return pd.DataFrame(rows)


def _sources(done: Calibrated) -> dict[str, str]:
    """Return the sources of the measurements, by response."""
    table = pd.read_csv(current_project().file(f"{PUBLISHED}/{done.parameters['calibration']['measured']}"))
    return dict(zip(table["response"], table["source"], strict=True)) if "source" in table else {}


def _pair_sentence(done: Calibrated, pair: str) -> str:
    part = done.statements[done.statements["pair"] == pair]
    values = ", ".join(f"{value:.2f}" for value in done.pairs[pair].values())
    told = "; ".join(beside_measured(row) for row in part[part["seeds"] > 0].itertuples())
    return f"The {pair.replace('_', ' ')} pair ({values}) gives: {told}."


def beside_measured(row: Any) -> str:
    """Return a response of a pair, beside what was measured where it was; row: of `responses.statement_table`."""
    said = f"{response_name(row.response)} {row.simulated:.2f} ± {row.simulated_uncertainty:.2f}"
    if np.isnan(row.measured):
        return f"{said}, not measured"
    return (
        f"{said} against {row.measured:g} ± {row.measured_deviation:g}, {row.inside} ({row.deviations:+.1f} standard"
        " deviations)"
    )


def sentences(done: Calibrated) -> list[str]:
    """Return what else is to be said of the responses: their scatter, blocked packings, what was not simulated."""
    scatter = "; ".join(
        f"{response_name(name)} {surrogate.seed_deviation:.2g}" for name, surrogate in done.known.surrogates.items()
    )
    said = [f"Standard deviation between packings, as the surrogates find it: {scatter}."]
    first = done.repeats[done.repeats["pair"] == FOUND_FIRST]
    if len(first):
        values = ", ".join(f"{first[name].iloc[0]:.2f}" for name in done.problem.names)
        said.append(
            f"Before any pair was repeated the simulations led to ({values}); with its repeats and those of the"
            f" {done.compared} pair they lead to the recommended one."
        )
    blocked = int(done.everything[BLOCKED].sum()) if BLOCKED in done.everything else 0
    if blocked:
        said.append(
            f"An arch blocked the opening in {blocked} packing(s), whose test was done again with another packing;"
            f" {len(done.everything)} tests gave an answer."
        )
    unknown = [response_name(name) for name in done.problem.measured if name not in done.known.predicted]
    if unknown:
        names = ", ".join(unknown)
        said.append(f"Measured but not simulated at this fidelity, so not part of the posterior: {names}.")
    return said


def at_published(done: Calibrated) -> Block:
    """Return what the surrogates say about the pairs that others simulated, where the parameters are the same."""
    names = done.problem.names
    if not set(names) <= set(done.published):
        return Text("The published pairs have other parameters.")
    points = done.problem.to_unit(done.published[names].to_numpy(float))
    rows = []
    for response in (name for name in done.known.surrogates if name in done.published):
        mean, variance = done.known.surrogates[response].predict(points)
        reach = NORMAL * np.sqrt(variance)
        name, _, unit = response_name(response).removesuffix(")").rpartition(" (")
        measured = done.problem.measured.get(response)
        margin = MARGIN_DEVIATIONS * measured.deviation if measured else np.nan
        for number, pair in enumerate(done.published.to_dict("records")):
            if np.isfinite(pair[response]):
                words = ", ".join(f"{parameter_name(each).removesuffix(' (-)')} {pair[each]:g}" for each in names)
                row = {"quantity": name, "setting": words, "unit": unit, "published_value": pair[response]}
                ends = {"computed_low": mean[number] - reach[number], "computed_high": mean[number] + reach[number]}
                row |= {"computed_value": mean[number], **ends, "margin": margin, "source": pair["source"]}
                row["reason"] = _discharge_words(done, mean, number) if response == DISCHARGE else ""
                rows.append(row)
    return Table(pd.DataFrame(rows), "published_pairs", AT_PUBLISHED, beside_source=True)


def _discharge_words(done: Calibrated, mean: np.ndarray, number: int) -> str:
    """Return why the discharge time of a published pair may be off, and how many times that of the compared pair it is
    here and there; mean: ours (s) of all published pairs.
    """
    told, theirs = opening_words(done.parameters["draw_down"]), done.published[DISCHARGE].to_numpy(float)
    compared = np.flatnonzero(done.published["row"] == done.compared)
    if not len(compared) or compared[0] == number:
        return told
    ours, published = (each[number] / each[compared[0]] for each in (mean, theirs))
    return f"{told}; over that of the {done.compared} pair it is {ours:.2f}, published {published:.2f}"


def opening_words(draw_down: Mapping[str, Any]) -> str:
    """Return why discharge times may be off; draw_down: parameters of the box."""
    told = f"{draw_down['opening']} of {1e3 * draw_down['opening_m']:g} mm"
    return f"the size of the opening is not published: with the {told} that is assumed the level tells nothing"


def checked_pairs(done: Calibrated) -> list[Block]:
    """Return pairs simulated in tests that the calibration did not use, and their means beside the measured bands."""
    rows = pd.read_csv(done.folder / CHECKED)
    return [
        Table(
            _named(rows.drop(columns=FOLDERS, errors="ignore").astype({"seed": str})),
            note="Each pair has the scale and width that its row names.",
        ),
        Table(_named(checked_means(rows, done.problem))),
    ]


# ---------------------------------------------------------------- simulations


def next_measurement(done: Calibrated) -> list[Block]:
    """Return how the calibration stopped, the scatter between packings, and what each measurement would still tell."""
    looks = pd.read_csv(done.folder / "looks.csv").groupby("test", sort=False).last()
    stopped = [_stop(str(name), row, done.problem.surrogate_share) for name, row in looks.iterrows()]
    return [
        Text(f"{'; '.join(stopped)}."),
        Table(_named(information_table(done.problem, done.known)), "information", INFORMATION),
        Table(_named(done.repeat_means[["pair", "response", "seeds", "mean", "deviation"]])),
        Pictures(["calibration_progress"]),
    ]


def _stop(test: str, look: pd.Series, most: float) -> str:
    """Return by what a test's simulations were stopped."""
    share, count = look["surrogate_share"], int(look["simulations"])
    why = "by the stopping rule" if share <= most else "by the limit"
    return (
        f"The {test.replace('_', ' ')} stopped {why} after {count} simulations, with {share:.2f} of the variance the "
        f"surrogate's (rule: at most {most:g})"
    )


def simulations(done: Calibrated) -> list[Block]:
    """Return how many simulations there were and why, and all of them."""
    counts = done.simulations.groupby(["test", "why"], sort=False).size()
    told = ", ".join(f"{number} {test.replace('_', ' ')} ({why})" for (test, why), number in counts.items())
    table = done.simulations.drop(columns=FOLDERS, errors="ignore").astype({"seed": str})
    return [Text(f"Simulations: {told}."), Table(_named(table), "simulations")]


def deciding(folder: Path) -> list[Block]:
    """Return the Sobol indices of every response over the parameters."""
    return sensitivity_blocks(read_indices(folder / "figures" / "calibration_sensitivity.csv"))


def sizes(folder: Path) -> Block:
    """Return the shear angle in boxes of other sizes, ours and the published ones."""
    ours = pd.read_csv(folder / "box_sizes.csv").drop(columns=["row", FOLDERS], errors="ignore")
    theirs = published("shear_box_sizes.csv").rename(
        columns={"shear_angle_deg": "mean", "deviation_deg": "deviation", "source": "varied"}
    )
    return Table(pd.concat([ours, theirs], ignore_index=True), beside_source=sizes_beside_source(folder))


def sizes_beside_source(folder: Path) -> pd.DataFrame:
    """Return the published shear angles in shorter boxes beside ours, whose slice has the width of the longest one's;
    that of the longest box is a pair's, see `at_published`.
    """
    ours, theirs = pd.read_csv(folder / "box_sizes.csv"), published("shear_box_sizes.csv")
    widest = ours.loc[ours["length_mm"].idxmax(), "width_mm"]
    ours = ours[ours["width_mm"] == widest].drop_duplicates("length_mm").set_index("length_mm")
    rows = []
    for line in theirs[theirs["length_mm"] < theirs["length_mm"].max()].to_dict("records"):
        found = ours.reindex([line["length_mm"]]).iloc[0]
        count = 0 if np.isnan(found["seeds"]) else int(found["seeds"])
        error = found["deviation"] / np.sqrt(count) if count else np.nan
        low, high = Estimate(found["mean"], error, max(count - 1, 0), count).interval()
        rows.append(
            {
                **{"quantity": "Shear angle, shear box", "setting": f"box of {line['length_mm']:g} mm", "unit": "°"},
                **{"published_value": line["shear_angle_deg"], "computed_value": found["mean"]},
                **{"computed_low": low, "computed_high": high, "packings": count, "source": line["source"]},
                "margin": MARGIN_DEVIATIONS * line["deviation_deg"],
            }
        )
    return pd.DataFrame(rows)


def use(folder: Path, study: str) -> list[Block]:
    """Return how another study uses the recommended values, and the file with them."""
    file = f"results/{study}/materials.yaml"
    return [
        Text(
            f"The recommended values stand in {file}, with their provenance. Another study uses them with --config "
            f"materials={file}; its rolling friction model and convention must be the same, which is checked."
        ),
        Listing("materials.yaml", (folder / "materials.yaml").read_text(encoding="utf-8")),
    ]


def filled(folder: Path) -> Block:
    """Return mass and level of the boxes as they were filled, asked and found."""
    return Table(fillings_table(fillings_of(used_folders(folder))), "fillings", NOTE)


def cost(folder: Path) -> list[Block]:
    """Return what the simulations took, and what was forecast if all that are allowed were needed."""
    table, forecast = cost_table(used_folders(folder)), pd.read_csv(folder / "forecast.csv")
    note = (
        f"LIGGGHTS took {table['solver_s'].sum():.4g} s by the clock, on whatever else the machine was doing. Forecast "
        f"for the most simulations allowed, their time until rest estimated: {forecast['solver_s'].sum():.4g} s of "
        f"processor time ({forecast['by'].iloc[0]})."
    )
    return [Table(table, note=note, digits=dict.fromkeys(("solver_s", "mean_steps"), 4))]
