"""Tables of the circular wear tester, and its figures of volumes.

Others are in `place_figures` and `flow_figures`. Counterparts are those of Yan 2022, chapter 6.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.circular_tester import charts, figure_findings
from bulkwear.workflows.cases.circular_tester.runs import (
    SIZE,
    VOLUME,
    WORN_OUT,
    TesterRun,
    has_pairs,
    has_series,
    runs_of_values,
    shown_pair,
    values_of_pairs,
    values_of_runs,
)
from bulkwear.workflows.cases.circular_tester.source import unlike_source
from bulkwear.workflows.report.products import Job, every_run, figure, tables

if TYPE_CHECKING:
    import pandas as pd

PUBLISHED = {"published": "config/published/circular_tester.csv"}
PUBLISHED_FITS = {"published_fits": "config/published/circular_tester_volume.csv"}
CLAIMS = {"claims": "config/published/verdicts.yaml"}
WEAR = {"wear": every_run("wear.csv")}  # with the surfaces of the cycles beside it
FOREIGN = {"foreign": unlike_source}  # surfaces beside which no published number stands
ALL_RUNS, PAIRS = {"runs": values_of_runs}, {"runs": values_of_pairs}
DIGITS = 9
BEDS_IN_USE = "tester/beds_in_use.csv"
OF_PAIRS = {"when": has_pairs, "digits": DIGITS}
TABLES = {
    name: f"tester/{name}.csv"
    for name in (
        *("lost_volumes", "rates", "time_scale", "predictions", "comparison"),
        *("ratios", "mean_ratios", "series", "findings"),
    )
}


def of_study(*names: str) -> dict[str, str]:
    """Return inputs: tables of a study by name."""
    return {name: f"results/{{study}}/{TABLES[name]}" for name in names}


def read(job: Job, *names: str) -> list[pd.DataFrame]:
    """Return tables by the names of a job's inputs."""
    import pandas as pd

    return [pd.read_csv(getattr(job.files, name)) for name in names]


def runs_of(job: Job) -> list[TesterRun]:
    """Return the runs that a job is told of; one of its inputs is the wear.csv of every run."""
    return runs_of_values(job.told.runs, Path(job.files.wear[0]).parents[1])


@tables(
    inputs={**PUBLISHED, **PUBLISHED_FITS, **CLAIMS, **WEAR},
    told={**ALL_RUNS, **FOREIGN},
    tables=TABLES,
    **OF_PAIRS,
)
def tester_runs(job: Job) -> dict[str, pd.DataFrame]:
    """Make the tables of all runs, of which most figures are drawn."""
    from bulkwear.workflows.cases.circular_tester.tables import tables_of_runs
    from bulkwear.workflows.config.claims import claims_of

    claims = claims_of("circular_tester", job.files.claims)
    return tables_of_runs(runs_of(job), *read(job, "published", "published_fits"), claims, job.told.foreign)


@tables(inputs=WEAR, told=ALL_RUNS, tables={"beds_in_use": BEDS_IN_USE}, digits=DIGITS)
def beds_in_use(job: Job) -> dict[str, pd.DataFrame]:
    """Make the table of the beds once more, with the samples in them."""
    import pandas as pd

    from bulkwear.workflows.cases.circular_tester.flow import bed_in_use

    return {"beds_in_use": pd.DataFrame([bed_in_use(run) for run in runs_of(job)])}


# ---------------------------------------------------------------- volumes


@figure(
    "Volume",
    "Volume against hours of the test",
    finding=figure_findings.reduction,
    charts=(charts.HOURS,),
    inputs={**of_study("lost_volumes", "time_scale", "comparison"), **PUBLISHED},
    **OF_PAIRS,
    caption="""
    Counterpart of Fig 6.4 (Yan 2022). Marks: measured; bands: measured per interval of 8 hours. Lines: ours, mean
    over packings with its 95 % interval, as far as they are simulated. The plain sample's 145.2 mm³ after 56 hours
    set how many hours a revolution stands for; everything else is predicted. The table above compares experiment, the
    thesis' model and ours; beyond the run ours goes on as its increments do, up to twice the run. The thesis' text
    swaps experiment and model at 184 hours.
    """,
)
def tester_hours(job: Job) -> Any:
    """Draw volumes against hours beside the experiment (Fig 6.4)."""
    from bulkwear.workflows.cases.circular_tester.plots.volume import volume_by_hours
    from bulkwear.workflows.cases.circular_tester.volume import chosen, mean_volumes

    lost, scale, compared, published = read(job, "lost_volumes", "time_scale", "comparison", "published")
    compared["note"] = compared["note"].fillna("")
    curves, hours = mean_volumes(chosen(lost, VOLUME)), scale["hours_per_revolution"].iloc[0]
    return volume_by_hours(curves, hours, published, job.remarks), compared


@figure(
    "Volume",
    "Volume by revolution",
    finding=figure_findings.lost,
    charts=(charts.VOLUME,),
    inputs={**of_study("lost_volumes"), **PUBLISHED, **PUBLISHED_FITS},
    told=FOREIGN,
    **OF_PAIRS,
    caption="""
    Counterpart of Fig 6.11 and Eq 6.2 to 6.6 (Yan 2022). Marks: removed from the sample, mean over packings with its
    95 % interval. Dashed: the thesis' fits at this wear coefficient, grey where we have no run of that particle scale.
    """,
)
def tester_volume(job: Job) -> Any:
    """Draw volumes by revolution (Fig 6.11)."""
    from bulkwear.workflows.cases.circular_tester import volume
    from bulkwear.workflows.cases.circular_tester.plots.volume import volume_by_revolution

    lost, published, published_fits = read(job, "lost_volumes", "published", "published_fits")
    times = volume.times_source(volume.chosen(lost, VOLUME)["coefficient"].iloc[0], published)
    fits = volume.fits_beside(published_fits, job.told.foreign, times)
    means = volume.mean_volumes(volume.whole_revolutions(volume.chosen(lost, VOLUME, SIZE)))
    return volume_by_revolution(means, fits, job.remarks), volume.beside_fits(means, fits)


@figure(
    "Volume",
    "What an element and a sample lose per revolution",
    finding=figure_findings.increments,
    charts=(charts.INCREMENTS,),
    inputs={**of_study("lost_volumes", "mean_ratios"), **PUBLISHED},
    **OF_PAIRS,
    caption="""
    Counterpart of Fig 6.12 and Eq 6.7 (Yan 2022): mean over packings with its 95 % interval. A mean over elements hangs
    on how many there are, so the sample's own increment stands beside it. Above: patterned over plain, and how that
    ratio changes over the run. Upright, left: where the thesis' increments cross at particle scale 4.
    """,
)
def tester_increments(job: Job) -> Any:
    """Draw what is lost per revolution (Fig 6.12)."""
    from bulkwear.workflows.cases.circular_tester.plots.volume import element_increments as draw
    from bulkwear.workflows.cases.circular_tester.volume import chosen, mean_increments, whole_revolutions

    lost, ratios, published = read(job, "lost_volumes", "mean_ratios", "published")
    grown = mean_increments(whole_revolutions(chosen(lost, VOLUME, SIZE)))
    ratios = ratios[ratios["shape"].isin(grown["shape"])]
    return draw(grown, ratios, published, job.remarks), grown


@figure(
    "Volume",
    "Volume after 56 hours by particle scale",
    finding=figure_findings.reduction_by_scale,
    charts=(charts.BENCHMARK,),
    inputs={**of_study("predictions"), **PUBLISHED, **PUBLISHED_FITS},
    **OF_PAIRS,
    caption="""
    Counterpart of Fig 6.10 (Yan 2022). The plain sample of the study sets the scale of time, so its own bar is the
    measured one; all others follow from it, each with the interval in which one further packing falls. Thesis: its
    fits at its two revolutions.
    """,
)
def tester_benchmark(job: Job) -> Any:
    """Draw volumes after the short test by particle scale (Fig 6.10)."""
    from bulkwear.workflows.cases.circular_tester.plots.volume import benchmark

    predicted, published, published_fits = read(job, "predictions", "published", "published_fits")
    return benchmark(predicted, published, published_fits, job.remarks), predicted


@figure(
    "Volume",
    "Until the pattern is gone",
    finding=figure_findings.worn_off,
    charts=(charts.WORN_OUT,),
    inputs={**of_study("lost_volumes", "rates"), **WEAR},
    told=ALL_RUNS,
    when=has_series(WORN_OUT),
    digits=DIGITS,
    caption="""
    The thesis had to stop at its revolution 17. Here a row of the design has a larger wear coefficient; its revolutions
    are told as those of the study's coefficient, as Archard's law is linear in it. Left: volume of the pattern over its
    feet; right: what the law takes per revolution. Wear does not follow the flow as closely there, because the shape
    changes more between two passes of the bed; where both runs overlap they show how much that matters.
    """,
)
def tester_worn_out(job: Job) -> Any:
    """Draw a pattern that is worn right off, beside the one of the study's coefficient."""
    from bulkwear.workflows.cases.circular_tester.comparison import patterns_left, worn_out_at
    from bulkwear.workflows.cases.circular_tester.plots.volume import worn_out

    runs = runs_of(job)
    _, plain = shown_pair(runs)
    left = patterns_left(*read(job, "lost_volumes", "rates"), plain.coefficient)
    patches = "; ".join(f"{run.name}: {run.patch}" for run in runs if run.name in set(left["run"]))
    remarks = [*job.remarks, f"a contact wears over: {patches}"]
    return worn_out(left, worn_out_at(left), remarks), left
