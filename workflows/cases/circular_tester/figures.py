"""Tables of the circular wear tester, and its figures of volumes, places of wear, elements and machines.

Those of the flow are in `flow_figures`. Counterparts are those of Yan 2022, chapter 6.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.circular_tester.runs import (
    MESH,
    RING,
    SIZE,
    SURFACE,
    VOLUME,
    WORN_OUT,
    WORN_SURFACE,
    TesterRun,
    has_pairs,
    has_series,
    pairs_of,
    runs_of_values,
    shown_pair,
    values_of_pairs,
    values_of_runs,
)
from bulkwear.workflows.report.products import Job, every_run, figure, tables

if TYPE_CHECKING:
    import pandas as pd

PUBLISHED = {"published": "config/published/circular_tester.csv"}
PUBLISHED_FITS = {"published_fits": "config/published/circular_tester_volume.csv"}
CLAIMS = {"claims": "config/published/verdicts.yaml"}
WEAR = {"wear": every_run("wear.csv")}  # with the surfaces of the cycles beside it
ALL_RUNS, PAIRS = {"runs": values_of_runs}, {"runs": values_of_pairs}
DIGITS = 9
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
    inputs={**PUBLISHED, **PUBLISHED_FITS, **CLAIMS, **WEAR, "worn": every_run(WORN_SURFACE)},
    told=ALL_RUNS,
    tables=TABLES,
    **OF_PAIRS,
)
def tester_runs(job: Job) -> dict[str, pd.DataFrame]:
    """Make the tables of all runs, of which most figures are drawn."""
    from bulkwear.workflows.cases.circular_tester.tables import tables_of_runs
    from bulkwear.workflows.config.claims import claims_of

    claims = claims_of("circular_tester", job.files.claims)
    return tables_of_runs(runs_of(job), *read(job, "published", "published_fits"), claims)


# ---------------------------------------------------------------- volumes


@figure(
    "Volume",
    "Volume against hours of the test",
    inputs={**of_study("lost_volumes", "time_scale", "comparison"), **PUBLISHED},
    **OF_PAIRS,
    caption="""
    Counterpart of Fig 6.4 (Yan 2022). Marks: measured; bands: measured per interval of 8 hours. Lines: ours, mean over
    packings with its 95 % interval, as far as they are simulated. The plain sample's 145.2 mm³ after 56 hours set how
    many hours a revolution stands for; everything else is predicted. Below: experiment, the thesis' model at its
    particle scale 1 and at ours, and ours with the interval in which one further packing falls. Beyond the run it goes
    on as its increments do, up to twice the run. The thesis' text swaps experiment and model at 184 hours.
    """,
)
def tester_hours(job: Job) -> Any:
    """Draw volumes against hours beside the experiment (Fig 6.4)."""
    from bulkwear.workflows.cases.circular_tester.plots.volume import volume_by_hours
    from bulkwear.workflows.cases.circular_tester.volume import chosen, mean_volumes

    lost, scale, compared, published = read(job, "lost_volumes", "time_scale", "comparison", "published")
    compared["note"] = compared["note"].fillna("")
    curves, hours = mean_volumes(chosen(lost, VOLUME)), scale["hours_per_revolution"].iloc[0]
    return volume_by_hours(curves, hours, compared, published, job.remarks), compared


@figure(
    "Volume",
    "Volume by revolution",
    inputs={**of_study("lost_volumes", "rates"), **PUBLISHED_FITS},
    **OF_PAIRS,
    caption="""
    Counterpart of Fig 6.11 and Eq 6.2 to 6.6 (Yan 2022). Marks: removed from the sample, mean over packings with its
    95 % interval. Dashed: the thesis' fits, grey where we have no run of that particle scale. Below: what is lost per
    revolution, and how that changes from the first to the last revolution of the run by a straight line through the
    increments; the thesis' change is that of its fit over as many revolutions.
    """,
)
def tester_volume(job: Job) -> Any:
    """Draw volumes by revolution (Fig 6.11)."""
    from bulkwear.workflows.cases.circular_tester.plots.volume import volume_by_revolution
    from bulkwear.workflows.cases.circular_tester.volume import chosen, mean_volumes, whole_revolutions

    lost, rates, published = read(job, "lost_volumes", "rates", "published_fits")
    means = mean_volumes(whole_revolutions(chosen(lost, VOLUME, SIZE)))
    return volume_by_revolution(means, rates, published, job.remarks), means


@figure(
    "Volume",
    "What an element and a sample lose per revolution",
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


# ---------------------------------------------------------------- where it wears


@figure(
    "Distribution",
    "Wear by column",
    inputs={**WEAR, **PUBLISHED},
    told=PAIRS,
    **OF_PAIRS,
    caption="""
    Counterpart of Fig 6.13 (Yan 2022): volume of base and pattern by column of the sample, after the last revolution
    that all runs have. Bars: 95 % interval of the column over packings. Column 1 meets the bed first. In a straight
    channel inside and outside of a column are alike.
    """,
)
def tester_columns(job: Job) -> Any:
    """Draw wear by column, after as many revolutions as both samples have (Fig 6.13)."""
    from bulkwear.postproc.tables.summary import published_value
    from bulkwear.workflows.cases.circular_tester import distribution
    from bulkwear.workflows.cases.circular_tester.plots.distribution import by_column

    runs = [run for pair in pairs_of(runs_of(job)) for run in pair]
    shared, worn = distribution.surfaces_alike(runs)
    each = distribution.of_runs(distribution.wear_by_column(worn), runs)
    table, share = distribution.columns_over_packings(each, "mm3"), distribution.share_of_bumps(each)
    theirs = published_value(*read(job, "published"), "share_of_bumps", "simulation")
    said = f"pattern {share.text(factor=100.0, unit='%')}; Yan 2022: {theirs:g} %"
    remarks = [f"after {shared:g} revolutions", *job.remarks]
    return by_column(table, "mm3", "Worn volume (mm³)", said, remarks), table


@figure(
    "Distribution",
    "Wear of every shape of the pattern",
    inputs={**WEAR, **PUBLISHED},
    told=PAIRS,
    **OF_PAIRS,
    caption="""
    Counterpart of Fig 6.14 (Yan 2022), mean over packings with its 95 % interval. C15 is the fifth one from the inner
    side in the first column. Grey: the range that the thesis gives for odd and even columns after its last revolution.
    """,
)
def tester_bumps(job: Job) -> Any:
    """Draw wear by shape of the pattern (Fig 6.14)."""
    from bulkwear.postproc.tables.summary import published_value
    from bulkwear.workflows.cases.circular_tester.distribution import surfaces_alike, wear_by_bump
    from bulkwear.workflows.cases.circular_tester.packings import over_packings
    from bulkwear.workflows.cases.circular_tester.plots.distribution import by_bump

    patterned = {run.name: run for run, _ in pairs_of(runs_of(job))}
    last, worn = surfaces_alike(list(patterned.values()))
    bumps = wear_by_bump({run.packing: worn[name] for name, run in patterned.items()})
    bumps = over_packings(bumps, ["bump", "row"], "volume_mm3")
    (published,) = read(job, "published")
    theirs = published_value(published, "last_revolution", "simulation")
    said = f"ours after {last:.3g} revolutions, Yan 2022 after {theirs:g}"
    return by_bump(bumps, published, said, job.remarks), bumps


@figure(
    "Distribution",
    "Contours by revolution",
    inputs=WEAR,
    told=PAIRS,
    **OF_PAIRS,
    caption="""
    Counterpart of Fig 6.16 (Yan 2022): sections through the pattern in the first column, along the travel (side) and
    across it (front), in the sample's own frame, which the machine inclines; of the first packing.
    """,
)
def tester_contours(job: Job) -> Any:
    """Draw sections of the pattern after several revolutions (Fig 6.16)."""
    from bulkwear.postproc.mesh import read_surface
    from bulkwear.workflows.cases.circular_tester.distribution import SHOWN_BUMPS, cycle_surfaces, top_of, worn_contours
    from bulkwear.workflows.cases.circular_tester.plots.distribution import worn_contours as draw

    patterned, _ = shown_pair(runs_of(job))
    pristine = top_of(read_surface(patterned.folder / SURFACE))
    contours = worn_contours(pristine, cycle_surfaces(patterned), SHOWN_BUMPS)
    return draw(contours, "revolution", job.remarks), contours


@figure(
    "Distribution",
    "Normal force by column",
    inputs={**WEAR, **PUBLISHED},
    told=PAIRS,
    **OF_PAIRS,
    caption="""
    Counterpart of Fig 6.22 (Yan 2022): mean normal force on base and pattern, from all contacts of all steps. Bars:
    95 % interval of the column over packings.
    """,
)
def tester_force_columns(job: Job) -> Any:
    """Draw normal force by column (Fig 6.22)."""
    import pandas as pd

    from bulkwear.postproc.statistics.intervals import estimate
    from bulkwear.postproc.tables.summary import published_value
    from bulkwear.workflows.cases.circular_tester import distribution
    from bulkwear.workflows.cases.circular_tester.plots.distribution import by_column
    from bulkwear.workflows.cases.circular_tester.volume import PATTERNED, of_surface

    runs = [run for pair in pairs_of(runs_of(job)) for run in pair]
    each = pd.concat([distribution.mean_force_by_column(run) for run in runs], ignore_index=True)
    each = distribution.of_runs(each, runs)
    first = of_surface(each[each["column"] == 1], PATTERNED)
    share = estimate(first["bumps_N"] / (first["bumps_N"] + first["base_N"]))
    theirs = published_value(*read(job, "published"), "first_column_force_share", "simulation")
    said = f"pattern in column 1 {share.text(factor=100.0, unit='%')}; Yan 2022: over {theirs:g} %"
    table = distribution.columns_over_packings(each, "N")
    return by_column(table, "N", "Normal force (N)", said, job.remarks), table


# ---------------------------------------------------------------- elements and machines


@figure(
    "Elements",
    "Volume by mesh size",
    inputs={**of_study("lost_volumes"), **PUBLISHED},
    when=has_series(MESH),
    digits=DIGITS,
    caption="""
    Counterpart of Fig 6.8 (Yan 2022): lost volume after equal revolutions over that of the plain sample on its finest
    mesh in the same packing, with its 95 % interval over packings. Bands: mean and standard deviation that the thesis
    gives over meshes of 0.1 to 1 mm. All rows of a packing start from the same bed in motion.
    """,
)
def tester_mesh(job: Job) -> Any:
    """Draw what the size of the elements changes in volumes (Fig 6.8)."""
    from bulkwear.workflows.cases.circular_tester.distribution import mesh_size_effect, volumes_of_meshes
    from bulkwear.workflows.cases.circular_tester.plots.distribution import mesh_size

    lost, published = read(job, "lost_volumes", "published")
    at = volumes_of_meshes(lost)
    effect, remarks = mesh_size_effect(at), [f"after {at['revolution'].iloc[0]:g} revolutions", *job.remarks]
    return mesh_size(effect, published, remarks), effect


@figure(
    "Elements",
    "Contours by mesh size",
    inputs={**of_study("lost_volumes"), **WEAR},
    told=ALL_RUNS,
    when=has_series(MESH),
    digits=DIGITS,
    caption="Counterpart of Fig 6.9 (Yan 2022): sections of C15 after equal revolutions, of the first packing.",
)
def tester_mesh_contours(job: Job) -> Any:
    """Draw what the size of the elements changes in sections (Fig 6.9)."""
    from bulkwear.workflows.cases.circular_tester.distribution import contours_by_mesh, volumes_of_meshes
    from bulkwear.workflows.cases.circular_tester.plots.distribution import worn_contours as draw

    at = volumes_of_meshes(*read(job, "lost_volumes"))
    at = at[at["packing"] == at["packing"].min()]
    same = at["revolution"].iloc[0]
    contours = contours_by_mesh([run for run in runs_of(job) if run.name in set(at["run"])], same)
    return draw(contours, "elements", [f"after {same:g} revolutions", *job.remarks]), contours


@figure(
    "Machine",
    "Channel and ring",
    inputs=of_study("lost_volumes", "ratios"),
    when=has_series(RING),
    digits=DIGITS,
    caption="""
    What the straight channel does to the results: the same particles in the whole annular trough, whose bed is slower
    inside and faster outside and goes round the curve. Left: lost volume; right: patterned over plain in each
    revolution, and over all revolutions that both machines have; means over packings with their 95 % intervals.
    """,
)
def tester_ring(job: Job) -> Any:
    """Draw what the straight channel changes against the whole ring."""
    from bulkwear.workflows.cases.circular_tester.comparison import MACHINE, mean_ratios
    from bulkwear.workflows.cases.circular_tester.packings import over_packings
    from bulkwear.workflows.cases.circular_tester.plots.volume import channel_and_ring
    from bulkwear.workflows.cases.circular_tester.volume import chosen, mean_volumes, whole_revolutions

    lost, ratios = read(job, "lost_volumes", "ratios")
    scales = chosen(lost, RING)["particle_scale"].unique()
    lost = chosen(lost, VOLUME, SIZE, RING)
    lost, ratios = (table[table["particle_scale"].isin(scales)] for table in (lost, ratios))
    means = mean_ratios(ratios, shared=True)
    by_revolution = over_packings(ratios, [*MACHINE, "revolution"], "ratio", log=True)
    return channel_and_ring(mean_volumes(whole_revolutions(lost)), means, by_revolution, job.remarks), means
