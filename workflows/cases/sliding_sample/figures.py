"""Figures of every study of sliding samples; those of screenings and of particle size have folders of their own."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.sliding_sample import charts
from bulkwear.workflows.cases.sliding_sample.grain_shape import compares_shapes, shape_finding, shapes_of_study
from bulkwear.workflows.cases.sliding_sample.study import compares_surfaces, finds_regimes, published_rows
from bulkwear.workflows.report import figure_findings
from bulkwear.workflows.report.page_parameters import is_deformed
from bulkwear.workflows.report.products import Job, every_run, figure, tables

if TYPE_CHECKING:
    import pandas as pd

DESIGN, SUMMARY = "results/{study}/design.csv", "results/{study}/summary.csv"
SURFACES, WEAR = every_run("worn_surface.vtu"), every_run("wear.csv")


@figure(
    "Wear",
    "Wear against travel",
    finding=figure_findings.total_wear,
    charts=(charts.WEAR_AGAINST_TRAVEL,),
    inputs={"design": DESIGN, "wear": WEAR},
    caption="""
    Cumulative wear volume of the sample, without skirt. Full line: worn by the law from the loads. Dashed line:
    what the surface has lost by then; the difference is carried to later cycles because a cycle may move a node
    only so far. A rigid study applies nothing and has no dashed line. One point per wear cycle; the run-in is not
    counted. Where a setting has several packings, thin lines are theirs and the thick one is their mean.
    """,
)
def wear_against_travel(job: Job) -> Any:
    """Draw cumulative wear against travel."""
    from bulkwear.postproc.plots import curves
    from bulkwear.postproc.tables.history import wear_history

    history = wear_history(job.files.design, job.files.wear)
    return curves.wear_against_travel(history, job.remarks), history


@tables(inputs={"summary": SUMMARY}, tables={"intervals": "intervals.csv"}, when=compares_surfaces)
def intervals(job: Job) -> dict[str, pd.DataFrame]:
    """Tell the wear of every setting over its plain twin's, with its interval over the packings."""
    from bulkwear.postproc.tables.packings import relative_wear_of_settings
    from bulkwear.postproc.tables.summary import read_summary

    return {"intervals": relative_wear_of_settings(read_summary(job.files.summary))}


@figure(
    "Wear",
    "Wear of base and pattern",
    finding=figure_findings.share_of_pattern,
    charts=(charts.WEAR_SPLIT,),
    inputs={"summary": SUMMARY},
    when=compares_surfaces,
    caption="""
    Worn volume on the flat base and on the pattern, over the volume of the plain sample in the same packing, geometric
    mean over the packings. The plain sample is 1 by definition (dashed line).
    """,
)
def wear_split(job: Job) -> Any:
    """Draw the wear of base and pattern."""
    from bulkwear.postproc.tables.packings import packings_remark
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample import comparison
    from bulkwear.workflows.cases.sliding_sample.plots import bars

    split = comparison.wear_split(read_summary(job.files.summary))
    return bars.wear_split(split, [*job.remarks, packings_remark(split["packings"])]), split


@figure(
    "Wear",
    "Distribution of depth",
    finding=figure_findings.depth_of_half,
    charts=(charts.DEPTHS,),
    inputs={"design": DESIGN, "depths": "results/{study}/figures/worn_surface.csv"},
    told={"deformed": is_deformed},
    caption="""
    Share of the sample's area, its pattern included, that is worn deeper than the depth on the logarithmic axis.
    Where the curve starts below 100 %, the rest of the area is hardly worn or not at all; a long tail to the right
    means deep wear in few places. The axis ends where 99.9 % of every sample's area is worn less, and spans three
    decades.
    """,
)
def depth_distribution(job: Job) -> Any:
    """Draw the distribution of depth over the area."""
    import pandas as pd

    from bulkwear.postproc.plots import curves
    from bulkwear.postproc.tables import depths
    from bulkwear.postproc.tables.history import runs_of
    from bulkwear.postproc.tables.packings import first_packings, shown_remark

    shares = depths.depth_distribution(pd.read_csv(job.files.depths, usecols=["run", "depth_um", "area_mm2"]))
    table = runs_of(job.files.design).merge(shares, on="run")
    remarks = [*job.remarks, *shown_remark(table)]
    return curves.depth_distribution(first_packings(table), depths.depth_quantity(job.told.deformed), remarks), table


@figure(
    "Wear",
    "Wear and the shape of grains",
    when=compares_shapes,
    finding=shape_finding,
    inputs={"summary": SUMMARY},
    told={"of_study": shapes_of_study},
    caption="""
    Wear per metre of travel of each surface, and of the patterned over the plain sample: of spheres against their
    rolling friction, over that of the materials (line, with 95 % intervals over packings), and of clumps (levels).
    Where a level crosses the line, spheres with that rolling friction wear like the clumps.
    """,
)
def wear_by_grain_shape(job: Job) -> Any:
    """Draw wear against the rolling friction of spheres, with the level of clumps."""
    from bulkwear.postproc.tables.packings import packings_remark
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.grain_shape import shape_table
    from bulkwear.workflows.cases.sliding_sample.plots import grain_shape

    table = shape_table(read_summary(job.files.summary), job.told.of_study)
    return grain_shape.wear_by_grain_shape(table, [*job.remarks, packings_remark(table["packings"])]), table


@figure(
    "Bed",
    "Bed over the sample",
    finding=figure_findings.particle_speeds,
    inputs={"summary": SUMMARY, "surfaces": SURFACES},
    digits=6,
    caption="""
    Particles at the end of the last wear cycle, cut along the travel through the middle of the sample; the half
    towards the viewer is not drawn. Colour: speed relative to the sample. Particles are drawn at their simulated,
    coarse-grained size. In studies of several design rows the row with the lowest relative wear is shown, its first
    packing.
    """,
)
def bed(job: Job) -> Any:
    """Draw the bed over the samples of the row that is shown in detail."""
    from bulkwear.postproc.flow.bed import shown_particles
    from bulkwear.postproc.plots import pictures
    from bulkwear.postproc.tables.depths import read_worn_surfaces
    from bulkwear.postproc.tables.summary import read_summary, rows_to_show, runs_of_rows

    summary = read_summary(job.files.summary)
    shown = runs_of_rows(summary, rows_to_show(summary))
    files = dict(zip(summary["run"], job.files.surfaces, strict=True))
    meshes = read_worn_surfaces(shown, [files[run] for run in shown])
    cuts = {run: shown_particles(Path(files[run]).parent, meshes[run]) for run in shown}
    return pictures.bed(cuts, meshes, job.remarks), pictures.bed_table(cuts)


VIEWS = {
    "finding": figure_findings.particle_spins,
    "inputs": {
        "summary": SUMMARY,
        "surfaces": SURFACES,
        "regimes": lambda study: [f"results/{study.name}/flow/regimes.csv"] if finds_regimes(study) else [],
    },
    "told": {"published_rows": published_rows},
    "digits": 6,
    "caption": """
    Particles at the end of the last wear cycle, coloured by angular speed. Side view: one layer of particles along
    the travel through the middle of the sample. Bottom view: the particles next to the floor, seen from below, with
    the edge of the sample and the feet of its pattern. Cross-section: one layer across the travel through the
    middle. The bed moves to the right, so the sample goes to the left through it; in a discontinuous flow particles
    ride along and heap up before it, on the left, in a continuous one they pass and heap up over its back. The
    counterpart of Yan 2022, Fig 3.11, 3.17 and 3.18. Particles are drawn at their simulated, coarse-grained size.
    """,
}


@figure("Bed", "Views of the flow", **VIEWS)
def flow_views(job: Job) -> Any:
    """Draw the flow over the samples of the row that is shown in detail."""
    return _views(job, 0)


@figure(
    "Bed",
    "Views of the flow, second row",
    when=lambda study: finds_regimes(study) and len(study.chosen_settings) > 1,
    **VIEWS,
)
def flow_views_second(job: Job) -> Any:
    """Draw the flow over the samples of a second row, of another regime where there is one."""
    return _views(job, 1)


def _views(job: Job, place: int) -> Any:
    """Draw the flow over the samples of one of the rows that are shown in detail."""
    from bulkwear.postproc.flow.bed import last_snapshot, read_snapshot
    from bulkwear.postproc.tables.depths import read_worn_surfaces
    from bulkwear.postproc.tables.summary import read_summary, rows_to_show, runs_of_rows
    from bulkwear.workflows.cases.sliding_sample.plots import flow_views as figures
    from bulkwear.workflows.cases.sliding_sample.screening.regime_groups import published_rows_in_detail, rows_in_detail

    summary = read_summary(job.files.summary)
    rows = rows_to_show(summary)
    if job.files.regimes:
        preferred = published_rows_in_detail(job.told.published_rows)
        rows = rows_in_detail(summary, read_summary(job.files.regimes[0]), preferred)
    shown = runs_of_rows(summary, rows[place : place + 1])
    files = dict(zip(summary["run"], job.files.surfaces, strict=True))
    meshes = read_worn_surfaces(shown, [files[run] for run in shown])
    snapshots = {run: read_snapshot(last_snapshot(Path(files[run]).parent)) for run in shown}
    views = {run: figures.seen_particles(snapshots[run], meshes[run]) for run in shown}
    lines = {run: figures.sample_lines(mesh) for run, mesh in meshes.items()}
    return figures.flow_views(views, lines, job.remarks), figures.flow_views_table(views)


@figure(
    "Bed",
    "Forces on the sample",
    finding=figure_findings.mean_forces,
    charts=charts.FORCES,
    inputs={"design": DESIGN, "wear": WEAR},
    caption="""
    Force of the bed on the sample after the run-in: vertical (downwards) and drag (along the motion of the bed).
    The force includes the skirt. Studies of more than two design rows show mean values.
    """,
)
def forces(job: Job) -> Any:
    """Draw the forces on the samples: along the travel, or their means where there are many design rows."""
    from bulkwear.postproc.plots import curves
    from bulkwear.postproc.tables.history import force_history, force_summary
    from bulkwear.postproc.tables.packings import first_packings, packings_remark, shown_remark
    from bulkwear.workflows.cases.sliding_sample.plots import bars

    table = force_history(job.files.design, [Path(path).parent for path in job.files.wear])
    if table["setting"].nunique() > curves.FEW_ROWS:
        means = force_summary(table)
        return bars.mean_forces(means, [*job.remarks, packings_remark(means["packings"])]), means
    return curves.forces(first_packings(table), [*job.remarks, *shown_remark(table)]), table


@figure(
    "Wear laws",
    "The study's law and the solver's Finnie model",
    finding=figure_findings.finnie_over_law,
    charts=(charts.LAWS,),
    inputs={"summary": SUMMARY},
    caption="""
    Wear volume by the study's law (from the load ledger) and by the Finnie model that LIGGGHTS has built in, both
    with the same coefficient. They are not two estimates of one quantity. Finnie describes cutting by particles
    that hit at an angle: LIGGGHTS takes the velocity of the particle's centre without its spin, and the model tends
    to zero for pure sliding. So it stays far below Archard's law where particles slide along a flat sample, and
    comes closer where they run against a pattern.
    """,
)
def wear_law_comparison(job: Job) -> Any:
    """Draw the volumes by the study's law and by the solver's Finnie model."""
    from bulkwear.postproc.tables.packings import packings_remark
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.comparison import law_comparison
    from bulkwear.workflows.cases.sliding_sample.plots import bars

    table = law_comparison(read_summary(job.files.summary))
    return bars.wear_law_comparison(table, [*job.remarks, packings_remark(table["packings"])]), table
