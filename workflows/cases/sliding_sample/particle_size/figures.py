"""Figures and tables of studies of particle size: wear against scale, flow by layer, all of it beside the source."""

from __future__ import annotations

import math
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.sliding_sample import charts
from bulkwear.workflows.cases.sliding_sample.particle_size import figure_findings
from bulkwear.workflows.cases.sliding_sample.particle_size.study import (
    bumps_and_particles,
    has_published_pattern,
)
from bulkwear.workflows.cases.sliding_sample.study import compares_sizes, flow_runs, varies_scale
from bulkwear.workflows.report.figure_findings import deepest_run
from bulkwear.workflows.report.page_parameters import is_deformed
from bulkwear.workflows.report.products import Job, every_run, figure, tables

if TYPE_CHECKING:
    pass

SUMMARY, PROFILES = "results/{study}/summary.csv", "results/{study}/flow/profiles.csv"
PUBLISHED_LINES = "config/published/particle_size_lines.csv"
PUBLISHED_SIZES = "config/published/particle_size_results.csv"
PUBLISHED_PACKING = "config/published/packing.csv"
PUBLISHED_SCALES = (1.0, 8.0)  # of the source
OF_WEAR = {"lines": "lines", "critical": "critical_scale", "forms": "critical_scale_forms", "ratios": "wear_over_plain"}
WEAR_TABLES = {name: f"particle_size/{file}.csv" for name, file in OF_WEAR.items()}
size_figure = partial(figure, "Particle size", when=varies_scale)


# ---------------------------------------------------------------- wear


@size_figure(
    "Wear against particle scale",
    finding=figure_findings.ratios_by_scale,
    inputs={"summary": SUMMARY, "published": PUBLISHED_LINES},
    told={"same_pattern": has_published_pattern},
    tables=WEAR_TABLES | {"published_lines": "particle_size/published_lines.csv"},
    charts=(charts.WEAR_AGAINST_SCALE,),
    when=compares_sizes,
    caption="""
    Worn volume of the plain sample, of the patterned sample, its base and its pattern, over that of the plain sample
    with the smallest particles simulated: small marks are packings, large ones their means with 95 % intervals. Thin
    lines: least squares, to be held against the source's straight ones (dotted; Yan 2022, Eq 4.14 to 4.16, bumps as
    their difference), which are relative to scale 1. Dashed with grey: the scale at which both samples wear alike, and
    its 95 % interval over all forms that the packings do not reject, from the ratio of patterned to plain sample in the
    same bed. The counterpart of Yan 2022, Fig 4.14.
    """,
)
def wear_against_scale(job: Job) -> Any:
    """Draw wear against particle scale with fitted lines and the critical scale."""
    import pandas as pd

    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.particle_size import wear_by_scale as by_scale
    from bulkwear.workflows.cases.sliding_sample.particle_size.plots import wear_by_scale as drawn

    wear = by_scale.wear_by_scale(read_summary(job.files.summary))
    published = by_scale.lines_beside(pd.read_csv(job.files.published), job.told.same_pattern)
    critical, forms = by_scale.critical_scale(wear)
    reference = f"relative to the plain sample at particle scale {wear['reference_scale'].iloc[0]:g}"
    remarks = [*job.remarks, reference, by_scale.critical_scale_text(critical)]
    lines = by_scale.beside_published(by_scale.wear_lines(wear), published)
    told = (lines, pd.DataFrame([asdict(critical)]), forms, by_scale.ratio_by_scale(wear))
    further = dict(zip(WEAR_TABLES, told, strict=True)) | {"published_lines": by_scale.points_of(published, wear)}
    return drawn.wear_against_scale(wear, published, critical, remarks), wear, further


@size_figure(
    "Wear against ratios of size",
    finding=figure_findings.ratios_by_size,
    inputs={"wear": "results/{study}/figures/wear_against_scale.csv", "published": PUBLISHED_LINES},
    told={"rows": bumps_and_particles},
    when=lambda study: compares_sizes(study) and bool(bumps_and_particles(study)),
    tables={"guidance": "particle_size/guidance.csv"},
    caption="""
    Wear of the patterned over that of the plain sample against four ratios of the median particle to a bump (Yan 2022,
    Eq 4.18 to 4.21); bars: 95 % intervals over packings. Dotted: the source's lines. With one pattern all four ratios
    grow together, so the figure cannot tell which of them decides; the source holds that it is the equivalent radius,
    with wear reduced below 1. The table in `particle_size/guidance.csv` has the ratios of real particles, the largest
    scale that they allow, and how many times the wear at real size that at the scale simulated is, by the study's line
    and by the source's. The counterpart of Yan 2022, Fig 4.17.
    """,
)
def wear_against_size_ratios(job: Job) -> Any:
    """Draw patterned over plain wear against ratios of particle to bump; tell what these let expect."""
    import numpy as np
    import pandas as pd

    from bulkwear.postproc.reference.size_ratios import size_ratios
    from bulkwear.workflows.cases.sliding_sample.particle_size import wear_by_scale as by_scale
    from bulkwear.workflows.cases.sliding_sample.particle_size.guidance import guidance_table, simulated
    from bulkwear.workflows.cases.sliding_sample.particle_size.plots import wear_by_scale as drawn

    wear, lines = pd.read_csv(job.files.wear, dtype={"row": str}), pd.read_csv(job.files.published)
    patterns, real, scales = simulated(job.told.rows)
    ratios = {scales[row]: size_ratios(scales[row] * real.median_diameter, *patterns[row].bump) for row in scales}
    table = by_scale.wear_by_size_ratio(wear, ratios)
    published = by_scale.published_by_size_ratio(lines, np.linspace(*PUBLISHED_SCALES, 71))
    picture = drawn.wear_against_size_ratios(table, published, job.remarks)
    patterned = wear[wear["curve"] == by_scale.patterned_curve(wear)]
    return picture, table, {"guidance": guidance_table(patterns, real, scales, lines, patterned)}


@size_figure(
    "Relative velocity and wear rate by particle scale",
    finding=figure_findings.steady_ends,
    charts=(charts.STEADY_BY_SCALE,),
    inputs={"summary": SUMMARY, "steady": "results/{study}/flow/steady.csv", "published": PUBLISHED_SIZES},
    caption="""
    Relative velocity of the particles (Yan 2022, Eq 4.10) and wear rate over the largest of all runs (Eq 4.12) in the
    steady window: packings small, their means with 95 % intervals large. Thin lines: standard deviations over a window,
    of 10 mm of travel each. Hollow where a window is not steady by the study's own criterion and what comes nearest
    stands for it. Dotted: what the source's text gives. The counterpart of Yan 2022, Fig 4.13.
    """,
)
def steady_by_scale(job: Job) -> Any:
    """Draw relative velocity and wear rate in their steady windows against particle scale."""
    import pandas as pd

    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.particle_size import published_sizes
    from bulkwear.workflows.cases.sliding_sample.particle_size.plots import wear_by_scale as drawn

    scales = read_summary(job.files.summary).set_index("run")["particle_scale"].to_dict()
    table = published_sizes.steady_by_scale(read_summary(job.files.steady), scales)
    return drawn.steady_by_scale(table, pd.read_csv(job.files.published), job.remarks), table


@size_figure(
    "Wear of the smallest and the largest particles",
    finding=deepest_run,
    inputs={"summary": SUMMARY, "surfaces": every_run("worn_surface.vtu")},
    told={"deformed": is_deformed},
    digits=6,
    caption="""
    The worn samples from above, by the smallest and by the largest particles simulated, all on one colour scale. The
    source's text: scratches along the travel and paths between the bumps by small particles, wear all over the convex
    sample by large ones. The counterpart of Yan 2022, Fig 4.15 and 4.16.
    """,
)
def wear_maps(job: Job) -> Any:
    """Draw the worn surfaces of the smallest and the largest particle scale side by side."""
    from bulkwear.postproc.plots import pictures
    from bulkwear.postproc.tables.depths import carried_remark, depth_quantity, depth_table, read_worn_surfaces
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.particle_size.wear_by_scale import smallest_and_largest

    summary, deformed = read_summary(job.files.summary), job.told.deformed
    every = dict(zip(summary["run"], job.files.surfaces, strict=True))
    runs = smallest_and_largest(summary)
    meshes = read_worn_surfaces(runs["run"], [every[run] for run in runs["run"]])
    depths = depth_table(meshes, deformed)
    remarks = [*job.remarks, carried_remark(meshes, deformed)]
    return pictures.wear_maps(meshes, runs, deformed, depths, depth_quantity(deformed), remarks), depths


# ---------------------------------------------------------------- flow


@size_figure(
    "Velocity by layer and particle scale",
    finding=figure_findings.velocity,
    charts=(charts.VELOCITY,),
    inputs={"summary": SUMMARY, "profiles": PROFILES, "published": PUBLISHED_SIZES},
    caption="""
    Mean velocity of the particles over the sample in the direction in which it moves, seen from the bed at rest,
    against the height of the layer. Layers are 5 mm high times the particle scale. Dotted: what the source's text
    gives, an upper bound over the plain sample in every layer, a lower one over the convex sample in the lowest
    layer, both for all its scales. The counterpart of Yan 2022, Fig 4.18.
    """,
)
def velocity_by_layer(job: Job) -> Any:
    """Draw the velocity with the sample by the height of layers, a curve per particle scale."""
    return _by_layer(job, "velocity_m_per_s", "Velocity with the sample")


@size_figure(
    "Upward velocity by layer and particle scale",
    finding=figure_findings.upward,
    charts=(charts.UPWARDS,),
    inputs={"summary": SUMMARY, "profiles": PROFILES},
    caption="""
    Mean upward velocity of the particles over the sample against the height of the layer; below zero they go down.
    The source's text: much smaller over the plain sample than over the convex one, over which it rises to a maximum
    above the lowest layer and falls to the top. The counterpart of Yan 2022, Fig 4.19.
    """,
)
def upward_velocity_by_layer(job: Job) -> Any:
    """Draw the upward velocity by the height of layers, a curve per particle scale."""
    return _by_layer(job, "upward_m_per_s", "Velocity upwards")


@size_figure(
    "Sideways velocity by layer and particle scale",
    finding=figure_findings.sideways,
    charts=(charts.SIDEWAYS,),
    inputs={"summary": SUMMARY, "profiles": PROFILES},
    caption="""
    Mean velocity of the particles over the sample across the travel, to +x above zero, against the height of the
    layer. The source's text: no tendency sideways at any scale. The counterpart of Yan 2022, Fig 4.20.
    """,
)
def sideways_velocity_by_layer(job: Job) -> Any:
    """Draw the velocity across the travel by the height of layers, a curve per particle scale."""
    return _by_layer(job, "sideways_m_per_s", "Velocity sideways")


def _by_layer(job: Job, component: str, name: str) -> Any:
    """Draw a component of the velocity, with what is published of it where the job has that."""
    import pandas as pd

    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.particle_size.plots.wear_by_scale import curves_by_scale
    from bulkwear.workflows.cases.sliding_sample.particle_size.wear_by_scale import over_the_sample, velocity_bounds

    scales = read_summary(job.files.summary).set_index("run")["particle_scale"]
    table = over_the_sample(read_summary(job.files.profiles), scales)
    published = getattr(job.files, "published", None)
    bounds = velocity_bounds(pd.read_csv(published), table) if published else None
    labels = (f"{name} (m/s)", "Height of the layer (mm)")
    return curves_by_scale(table, component, "height_mm", labels, job.remarks, bounds), table


@size_figure(
    "Angular speed along the sample",
    finding=figure_findings.spin_along,
    charts=(charts.SPIN_ALONG,),
    # what the snapshots of the bed were reduced to lies beside the tables of wear
    inputs={"summary": SUMMARY, "profiles": PROFILES, "wear": every_run("wear.csv")},
    told={"runs": flow_runs},
    caption="""
    Magnitude of the averaged angular velocity of the lowest layer over the sample, from its front edge, which the bed
    meets first, to its rear edge. Pieces are as long as the layer is
    high, 5 mm times the particle scale, as nearly as whole ones fill the sample; means over the steady window of the
    relative velocity, or over all travel where there is none. The source: it falls with the scale, is much higher over
    the convex sample, and there higher at the front than at the back. The counterpart of Yan 2022, Fig 4.22.
    """,
)
def angular_velocity_along_sample(job: Job) -> Any:
    """Draw the averaged angular velocity of the lowest layer along the samples, a curve per scale."""
    from bulkwear.postproc.tables.display import MILLIMETRES, in_display_units
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.flow_history import RunFlow, spin_profiles
    from bulkwear.workflows.cases.sliding_sample.particle_size.plots.wear_by_scale import curves_by_scale

    summary = read_summary(job.files.summary)[["run", "row", "surface", "particle_scale"]]
    starts = read_summary(job.files.profiles).groupby("run")["window_start_mm"].first() / MILLIMETRES
    runs = {run: RunFlow(**values) for run, values in job.told.runs.items()}
    folders = dict(zip(summary["run"], [Path(path).parent for path in job.files.wear], strict=True))
    table = in_display_units(summary.merge(spin_profiles(folders, runs, starts.to_dict()), on="run"))
    labels = ("Averaged angular velocity of\nthe lowest layer (°/s)", "Distance behind the front edge (mm)")
    return curves_by_scale(table, "averaged_angular_velocity_deg_per_s", "along_mm", labels, job.remarks), table


# ---------------------------------------------------------------- beside the source


@tables(
    inputs={
        "wear": "results/{study}/figures/wear_against_scale.csv",
        "critical": "results/{study}/particle_size/critical_scale.csv",
        "guidance": "results/{study}/particle_size/guidance.csv",
        "steady": "results/{study}/figures/steady_by_scale.csv",
        "profiles": "results/{study}/figures/velocity_by_layer.csv",
        "container": "results/{study}/figures/packing_profiles.csv",
        "bed": "results/{study}/figures/bed_packing.csv",
        "published": PUBLISHED_SIZES,
        "published_packing": PUBLISHED_PACKING,
    },
    tables={"published": "particle_size/published.csv", "sentences": "particle_size/sentences.csv"},
    when=compares_sizes,
)
def size_findings(job: Job) -> Any:
    """Set what a study found beside the numbers of the source; tell of its critical scale."""
    import pandas as pd

    from bulkwear.postproc.reference.size_ratios import PUBLISHED_CRITICAL_SCALE
    from bulkwear.postproc.tables.summary import read_summary
    from bulkwear.workflows.cases.sliding_sample.particle_size import published_sizes
    from bulkwear.workflows.cases.sliding_sample.particle_size.wear_by_scale import (
        patterned_curve,
        ratio_by_scale,
        read_critical_scale,
    )

    files = job.files
    steady, profiles, wear = (read_summary(path) for path in (files.steady, files.profiles, files.wear))
    critical, guidance = read_critical_scale(files.critical), pd.read_csv(files.guidance)
    ratio = next(iter(guidance["equivalent_radius"]), math.nan)  # of real particles: the pattern of all rows is one
    table = published_sizes.beside_the_source(pd.read_csv(files.published), steady, profiles, critical, ratio)
    packings = [pd.read_csv(path) for path in (files.published_packing, files.container, files.bed)]
    ratios, curve = ratio_by_scale(wear), patterned_curve(wear)
    said = published_sizes.critical_sentences(critical, PUBLISHED_CRITICAL_SCALE, ratios, curve)
    return {
        "published": pd.concat([table, published_sizes.packing_beside_the_source(*packings)], ignore_index=True),
        "sentences": pd.DataFrame({"sentence": said}),
    }
