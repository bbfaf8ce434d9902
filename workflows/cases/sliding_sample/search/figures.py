"""Figures and tables of a search: its record, the confirmed patterns, and the surrogate about the best of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.sliding_sample import charts
from bulkwear.workflows.cases.sliding_sample.figures import DESIGN, SUMMARY
from bulkwear.workflows.cases.sliding_sample.search import findings
from bulkwear.workflows.config.optimise import OPTIMISE, Optimise, optimise_of
from bulkwear.workflows.config.packings import PACKINGS
from bulkwear.workflows.config.rounds import rounds_of
from bulkwear.workflows.report import sensitivity
from bulkwear.workflows.report.predictions import error_of
from bulkwear.workflows.report.products import Job, every_run, figure

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.workflows.config.design import Study

INPUTS = {"summary": SUMMARY, "design": DESIGN, "surfaces": every_run("surface.vtu")}


def searches(study: Study) -> bool:
    """Return whether a study looks for the best pattern."""
    return study.optimise is not None


def reference_of(study: Study) -> str:
    """Return the setting that a search compares with: the first row of the design."""
    return study.setting_of[str(study.design_rows[0]["row"])]


TOLD = {
    "asked": lambda study: {key: study.settings[key] for key in (OPTIMISE, PACKINGS)},
    "digest": lambda study: study.search_digest,
    "reference": reference_of,
    "acceleration": lambda study: study.settings["wear"]["acceleration"],
    "error": lambda study: error_of(study.settings),
}


def _runs(job: Job) -> tuple[Optimise, pd.DataFrame, pd.DataFrame, list[dict[str, Any]]]:
    """Return a search, the summary of its study, the `run_results` of it, and what its rounds decided."""
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.search.results import run_results, volumes_of

    search, summary = optimise_of(job.told.asked), read_summary(job.files.summary)
    volumes = volumes_of(summary["run"], job.files.surfaces)
    runs = run_results(summary, volumes, search, job.told.acceleration)
    return search, summary, runs, list(rounds_of(Path(job.files.summary).parent, job.told.digest))


@figure(
    "Search",
    "Patterns that were tried",
    finding=findings.lowest_tried,
    inputs=INPUTS,
    told=TOLD,
    tables={"confirmed": "search/confirmed.csv", "excluded": "search/excluded.csv"},
    charts=(charts.SEARCH_RECORD,),
    when=searches,
    caption="""
    Wear of every tried pattern over that of its plain twins in the same packings, in the order in which they were
    simulated, with the 95 % interval of the mean over its packings. Hollow: less of the pattern than asked for is left
    after the hours of the search. Grey: what the surrogate predicted before, with its 95 % interval; patterns of the
    first ones and of the design have none. Dashed line: plain.
    """,
)
def search_record(job: Job) -> Any:
    """Draw the record of a search."""
    from bulkwear.workflows.cases.sliding_sample.search.plots import tried
    from bulkwear.workflows.cases.sliding_sample.search.record import confirmed_table, excluded_table, record_table

    (search, summary, runs, rounds), told = _runs(job), job.told
    record = record_table(summary, runs, rounds, search)
    further = {
        "confirmed": confirmed_table(runs, rounds[-1], told.reference, search, told.error),
        "excluded": excluded_table(rounds),
    }
    return tried.record(record, job.remarks), record, further


@figure(
    "Search",
    "Predicted wear about the best pattern",
    finding=findings.strongest_factor,
    inputs={**INPUTS, "confirmed": "results/{study}/search/confirmed.csv"},
    told=TOLD,
    charts=(charts.SEARCH_SLICES,),
    when=searches,
    caption="""
    Wear over plain that the surrogate of all simulated patterns predicts along each factor, the others held at the best
    confirmed pattern (vertical line), with its 95 % interval, in which the scatter of single packings is not. Dotted:
    with a chance of less than one half enough of the pattern is left after the hours of the search. Not every value can
    be made: neighbours may overlap.
    """,
)
def search_slices(job: Job) -> Any:
    """Draw the surrogate of a search along each factor through the best confirmed pattern."""
    import pandas as pd

    from bulkwear.workflows.cases.sliding_sample.search.plots import tried
    from bulkwear.workflows.cases.sliding_sample.search.record import best_confirmed
    from bulkwear.workflows.cases.sliding_sample.search.results import slices, tried_of

    search, _, runs, _ = _runs(job)
    best = best_confirmed(pd.read_csv(job.files.confirmed, dtype={"setting": str}))
    table = slices(tried_of(runs, search), best, search)
    return tried.slices(table, job.remarks), table


@figure(
    "Search",
    "Which measure decides",
    finding=sensitivity.finding,
    inputs=INPUTS,
    told=TOLD,
    charts=(sensitivity.CHART,),
    when=searches,
    digits=6,
    caption="""
    Sobol indices with 95 % intervals: the part of the response's variance that a measure of the pattern makes over the
    ranges of the search, alone and with all its interactions, where all vary evenly and independently, patterns that
    cannot be made among them. The intervals are those of draws of the surrogate of all simulated patterns, so that they
    hold what it does not know. Nothing is told of one that predicts patterns that are left out no better than their
    mean does.
    """,
)
def search_sensitivity(job: Job) -> Any:
    """Draw the Sobol indices of the surrogates of a search."""
    from bulkwear.postproc.plots.sensitivity import sensitivity_bars
    from bulkwear.workflows.cases.sliding_sample.search.results import tried_of
    from bulkwear.workflows.cases.sliding_sample.search.sensitivity import sensitivity_table

    search, _, runs, _ = _runs(job)
    table = sensitivity_table(tried_of(runs, search), search)
    return sensitivity_bars(table, job.remarks), table
