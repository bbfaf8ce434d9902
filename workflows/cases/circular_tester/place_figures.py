"""Figures of where samples in the circular wear tester wear, of elements and of machines."""

from __future__ import annotations

from typing import Any

from bulkwear.workflows.cases.circular_tester import figure_findings
from bulkwear.workflows.cases.circular_tester.figures import (
    ALL_RUNS,
    DIGITS,
    FOREIGN,
    OF_PAIRS,
    PAIRS,
    PUBLISHED,
    WEAR,
    of_study,
    read,
    runs_of,
)
from bulkwear.workflows.cases.circular_tester.runs import (
    MESH,
    RING,
    SIZE,
    SURFACE,
    VOLUME,
    has_series,
    pairs_of,
    shown_pair,
)
from bulkwear.workflows.report.products import Job, figure

OF_PLACES = {"inputs": {**WEAR, **PUBLISHED}, "told": {**PAIRS, **FOREIGN}, **OF_PAIRS}


@figure(
    "Distribution",
    "Wear by column",
    finding=figure_findings.wear_by_column,
    caption="""
    Counterpart of Fig 6.13 (Yan 2022): volume of base and pattern by column of the sample, after the last revolution
    that all runs have. Bars: 95 % interval of the column over packings. Column 1 meets the bed first. In a straight
    channel inside and outside of a column are alike.
    """,
    **OF_PLACES,
)
def tester_columns(job: Job) -> Any:
    """Draw wear by column, after as many revolutions as both samples have (Fig 6.13)."""
    from bulkwear.postproc.tables.summary import published_value
    from bulkwear.workflows.cases.circular_tester import distribution
    from bulkwear.workflows.cases.circular_tester.plots.distribution import by_column

    runs = [run for pair in pairs_of(runs_of(job)) for run in pair]
    shared, worn = distribution.surfaces_alike(runs)
    each = distribution.of_runs(distribution.wear_by_column(worn, distribution.borders_of(runs[0])), runs)
    table, share = distribution.columns_over_packings(each, "mm3"), distribution.share_of_bumps(each)
    theirs = published_value(*read(job, "published"), "share_of_bumps", "simulation")
    own = f"pattern {share.text(factor=100.0, unit='%')}"
    said = own if runs[0].surface in job.told.foreign else f"{own}; Yan 2022: {theirs:g} %"
    remarks = [f"after {shared:g} revolutions", *job.remarks]
    return by_column(table, "mm3", "Worn volume (mm³)", said, remarks), table


@figure(
    "Distribution",
    "Wear of every shape of the pattern",
    finding=figure_findings.most_worn,
    caption="""
    Counterpart of Fig 6.14 (Yan 2022), mean over packings with its 95 % interval. C15 is the fifth one from the inner
    side in the first column. Volumes are over the revolutions that they took. Grey: the range that the thesis gives for
    odd and even columns after its last revolution.
    """,
    **OF_PLACES,
)
def tester_bumps(job: Job) -> Any:
    """Draw wear by shape of the pattern (Fig 6.14)."""
    from bulkwear.postproc.tables.summary import published_value
    from bulkwear.workflows.cases.circular_tester.distribution import surfaces_alike, wear_by_bump
    from bulkwear.workflows.cases.circular_tester.packings import over_packings
    from bulkwear.workflows.cases.circular_tester.plots.distribution import by_bump
    from bulkwear.workflows.cases.circular_tester.volume import times_source

    patterned = {run.name: run for run, _ in pairs_of(runs_of(job))}
    last, worn = surfaces_alike(list(patterned.values()))
    bumps = wear_by_bump({run.packing: worn[name] for name, run in patterned.items()})
    bumps = over_packings(bumps, ["bump", "row"], "volume_mm3")
    (published,), shown = read(job, "published"), next(iter(patterned.values()))
    theirs = published_value(published, "last_revolution", "simulation") / times_source(shown.coefficient, published)
    beside = None if shown.surface in job.told.foreign else published
    return by_bump(bumps, beside, (last, theirs), job.remarks), bumps


@figure(
    "Distribution",
    "Contours by revolution",
    finding=figure_findings.lowered_crests,
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
    finding=figure_findings.force_by_column,
    caption="""
    Counterpart of Fig 6.22 (Yan 2022): mean normal force on base and pattern, from all contacts of all steps. Bars:
    95 % interval of the column over packings.
    """,
    **OF_PLACES,
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
    borders = distribution.borders_of(runs[0])
    each = pd.concat([distribution.mean_force_by_column(run, borders) for run in runs], ignore_index=True)
    each = distribution.of_runs(each, runs)
    first = of_surface(each[each["column"] == 1], PATTERNED)
    share = estimate(first["bumps_N"] / (first["bumps_N"] + first["base_N"]))
    theirs = published_value(*read(job, "published"), "first_column_force_share", "simulation")
    own = f"pattern in column 1 {share.text(factor=100.0, unit='%')}"
    said = own if runs[0].surface in job.told.foreign else f"{own}; Yan 2022: over {theirs:g} %"
    table = distribution.columns_over_packings(each, "N")
    return by_column(table, "N", "Normal force (N)", said, job.remarks), table


# ---------------------------------------------------------------- elements and machines


@figure(
    "Elements",
    "Volume by mesh size",
    finding=figure_findings.change_by_mesh,
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
    finding=figure_findings.crests_by_mesh,
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
    finding=figure_findings.by_machine,
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
