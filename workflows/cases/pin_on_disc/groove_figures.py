"""Figures of a pin on its disc: how it is set up, its force, and the groove with its contours."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from bulkwear.workflows.cases.pin_on_disc import charts, figure_findings
from bulkwear.workflows.cases.pin_on_disc.checks import MESHES
from bulkwear.workflows.cases.pin_on_disc.findings import trend
from bulkwear.workflows.cases.pin_on_disc.volume_figures import (
    CONTOURS,
    DESIGN,
    NORMALITY,
    PUBLISHED,
    VOLUMES,
    has_series,
)
from bulkwear.workflows.report.products import Job, every_run, figure

DISTRIBUTION_REVOLUTION = 10  # Yan 2022, Fig 5.10 and 5.11
WORN_DISCS = {"design": DESIGN, "published": PUBLISHED, "worn": every_run("worn_surface.vtu")}
OF_CONTOURS = {"design": DESIGN, "published": PUBLISHED, "contours": CONTOURS}


def folder_of(files: SimpleNamespace) -> Path:
    """Return the folder of a study, in which its runs have theirs."""
    return Path(files.design).parent


@figure(
    "Set-up",
    "The pin on its disc",
    finding=figure_findings.setup,
    inputs={"design": DESIGN, "published": PUBLISHED, "surfaces": every_run("surface.vtu")},
    caption="""
    What is simulated (Yan 2022, Fig 5.5): a ring of the disc about the track, seen from above with the size of its
    elements, and the pin on it from the side. The pin is held in the plane, free to sink, and goes round
    anticlockwise from the x axis; the disc rests. In the thesis the disc turns and the pin rests.
    """,
)
def disc_setup(job: Job) -> Any:
    """Draw the set-up of the pin on its disc."""
    from bulkwear.postproc.mesh import read_surface
    from bulkwear.postproc.tables.display import MILLIMETRES
    from bulkwear.workflows.cases.pin_on_disc.plots import disc
    from bulkwear.workflows.cases.pin_on_disc.runs import REFERENCE, reference_runs, runs_and_published

    runs, published = runs_and_published(job.files)
    run = runs.set_index("run").loc[next(iter(reference_runs(runs, published, REFERENCE).values()))]
    mesh, radius = read_surface(folder_of(job.files) / run.name / "surface.vtu"), run["pin_radius_mm"] / MILLIMETRES
    drawn = disc.disc_setup(mesh, run["track_radius_m"], radius, run["load_n"], job.remarks)
    return drawn, run.to_frame().T.rename_axis("run").reset_index()


@figure(
    "Contours",
    "How contours are taken",
    finding=figure_findings.groove,
    inputs=WORN_DISCS,
    caption="""
    Counterpart of Fig 5.6 (Yan 2022). The worn disc is cut by 360 half-planes about its axis, 1 degree apart (the
    thesis prints 0.5 degrees, which would make 720). Depth is the largest vertical displacement in a contour. The
    width is taken two ways: the opening, between the outermost places deeper than a tenth of the contour's depth, and
    the width that holds 95 % of the area of the section. At the very rim a groove fades out over one edge of the
    mesh, so an opening without a level would be that of the mesh.
    """,
)
def contour_extraction(job: Job) -> Any:
    """Draw how contours are taken from a worn disc."""
    from bulkwear.postproc.mesh import read_surface
    from bulkwear.workflows.cases.pin_on_disc.contours import MESH_ANGLE, section_table
    from bulkwear.workflows.cases.pin_on_disc.plots import disc
    from bulkwear.workflows.cases.pin_on_disc.runs import (
        REFERENCE,
        coefficient_remark,
        reference_runs,
        runs_and_published,
    )

    runs, published = runs_and_published(job.files)
    run = runs.set_index("run").loc[next(iter(reference_runs(runs, published, REFERENCE).values()))]
    mesh = read_surface(folder_of(job.files) / run.name / "worn_surface.vtu")
    remarks = [coefficient_remark(runs[runs["run"] == run.name], published, REFERENCE), *job.remarks]
    drawn = disc.contour_extraction(mesh, run["track_radius_m"], MESH_ANGLE, remarks)
    return drawn, section_table(mesh, run["track_radius_m"], [MESH_ANGLE])


@figure(
    "Contours",
    "Depth and width by mesh",
    charts=(charts.MESHES,),
    finding=trend,
    inputs={"design": DESIGN, "published": PUBLISHED, "statistics": "results/{study}/figures/run_in.csv"},
    tables={"stability": "figures/mesh_stability.csv"},
    when=has_series(MESHES),
    caption="""
    Counterpart of Fig 5.7 (Yan 2022), of which the text gives the trend only: coarser meshes make shallower and wider
    contours. Mean of 360 contours, bars: standard deviation. The shaded meshes are those with elements up to a fifth
    of the groove's width (of its opening on the finest mesh); above each panel stands how far they differ, largest
    over least. A groove that is narrower than five elements is as wide as its mesh makes it.
    """,
)
def mesh_series(job: Job) -> Any:
    """Draw depth and width of the groove against the size of the elements."""
    import pandas as pd

    from bulkwear.workflows.cases.pin_on_disc import comparison
    from bulkwear.workflows.cases.pin_on_disc.plots import contours as plots
    from bulkwear.workflows.cases.pin_on_disc.runs import REFERENCE, coefficient_remark, runs_and_published

    runs, published = runs_and_published(job.files)
    series = comparison.mesh_series(runs, pd.read_csv(job.files.statistics).drop(columns="scheme"))
    stability, shown = comparison.mesh_stability(series), runs[runs["run"].isin(series["run"])]
    said = [f"after revolution {series['revolution'].iloc[0]}", coefficient_remark(shown, published, REFERENCE)]
    return plots.mesh_series(series, stability, [*said, *job.remarks]), series, {"stability": stability}


@figure(
    "Contours",
    "Contours by mesh",
    finding=figure_findings.depth_by_mesh,
    inputs={**WORN_DISCS, "series": "results/{study}/figures/mesh_series.csv"},
    when=has_series(MESHES),
    digits=6,
    caption="""
    Counterpart of Fig 5.8 (Yan 2022): the contour at 90 degrees after one revolution, for every size of the elements;
    both schemes on the same axes.
    """,
)
def mesh_contours(job: Job) -> Any:
    """Draw one section of every mesh after one revolution."""
    import pandas as pd

    from bulkwear.workflows.cases.pin_on_disc.contours import mesh_sections
    from bulkwear.workflows.cases.pin_on_disc.plots import contours as plots
    from bulkwear.workflows.cases.pin_on_disc.runs import REFERENCE, coefficient_remark, runs_and_published

    (runs, published), series = runs_and_published(job.files), pd.read_csv(job.files.series)
    sections = mesh_sections(folder_of(job.files), runs, series)
    remark = coefficient_remark(runs[runs["run"].isin(series["run"])], published, REFERENCE)
    return plots.mesh_contours(sections, [remark, *job.remarks]), sections


@figure(
    "Forces",
    "Force of the pin",
    finding=figure_findings.forces,
    inputs={"design": DESIGN, "published": PUBLISHED, "wear": every_run("wear.csv")},
    caption="""
    Counterpart of Fig 5.9 (Yan 2022). Two boxes per revolution, of means over windows of a fraction of a degree: the
    vertical force on the disc, and the sum of the normal forces of all contacts. Boxes reach from the first to the
    third quartile with the median between; whiskers reach 1.5 boxes further, dots lie beyond. Circles: means of the
    revolution. That of the vertical force is the load. The sum of the normal forces exceeds it where walls of the
    groove push on one another, and it, not the load, is what Archard's law multiplies with the sliding distance.
    """,
)
def normal_force(job: Job) -> Any:
    """Draw the force of the pin revolution by revolution."""
    import pandas as pd

    from bulkwear.workflows.cases.pin_on_disc.plots import contours as plots
    from bulkwear.workflows.cases.pin_on_disc.runs import (
        REFERENCE,
        force_boxes,
        reference_remark,
        reference_runs,
        runs_and_published,
        window_forces,
    )

    runs, published = runs_and_published(job.files)
    chosen, loads = reference_runs(runs, published, REFERENCE), runs.set_index("run")["load_n"]
    of_schemes = [
        window_forces(folder_of(job.files) / run).assign(run=run, scheme=scheme) for scheme, run in chosen.items()
    ]
    forces, remarks = pd.concat(of_schemes), [reference_remark(runs, published, REFERENCE), *job.remarks]
    drawn = plots.normal_force(forces, {scheme: loads[run] for scheme, run in chosen.items()}, remarks)
    return drawn, force_boxes(forces)


@figure(
    "Contours",
    "Distribution of depth and width",
    finding=figure_findings.normality,
    inputs=OF_CONTOURS,
    caption="""
    Counterpart of Fig 5.10 and 5.11 (Yan 2022): depth and opening of the 360 contours round the disc, and their
    histograms beside the normal distribution of the same mean and standard deviation. p: probability of a chi-squared
    as large as the sample's if contours were independent and normal. Shaded: the published ranges of depth and width.
    """,
)
def contour_distribution(job: Job) -> Any:
    """Draw how depth and opening are distributed round the disc."""
    from bulkwear.workflows.cases.pin_on_disc.plots import contours as plots
    from bulkwear.workflows.cases.pin_on_disc.run_in import histograms, published_ranges
    from bulkwear.workflows.cases.pin_on_disc.runs import (
        REFERENCE,
        common_revolution,
        of_runs,
        only_reference,
        reference_remark,
        runs_and_published,
    )

    runs, published = runs_and_published(job.files)
    contours = only_reference(of_runs(runs, job.files.contours), runs, published, REFERENCE)
    ranges = published_ranges(published)
    ranges["label"] = ranges["source"] + f", revolution {DISTRIBUTION_REVOLUTION}"
    last = common_revolution(contours, DISTRIBUTION_REVOLUTION)
    shown = contours[contours["revolution"] == last]
    bars = histograms(shown)
    remarks = [f"after revolution {last}", reference_remark(runs, published, REFERENCE), *job.remarks]
    by_panel = dict(list(bars.groupby(["scheme", "size"])))
    return plots.contour_distribution(shown, by_panel, ranges, remarks), bars


@figure(
    "Contours",
    "Run-in",
    finding=figure_findings.ended,
    charts=(charts.RUN_IN,),
    inputs={**OF_CONTOURS, "normality": NORMALITY, "volumes": VOLUMES},
    tables={"change_points": "figures/run_in_change_points.csv"},
    caption="""
    Counterpart of Fig 5.12, 5.13 and Table 5.3 (Yan 2022). Above: mean of the 360 contours, thick bars the standard
    deviation, thin lines the extremes. Below: p of the chi-squared test of normality, with the published values. The
    thesis gives no classes; here they are equally probable under the normal distribution of the sample's mean and
    deviation, 2 n^0.4 = 21 of them, with 18 degrees of freedom. By the source's rule the run-in ends with the
    revolution from which on depth and width stay above 0.05, each at every revolution: contours that are normal from
    the start rarely pass so many tests. Corrected for their number each is passed above a lower p, so that such
    contours pass all of them in 95 %. p values below 1e-6 are drawn at 1e-6.

    A table beside the figure says where the volume of a revolution, and the deviation of the contours over their mean,
    become level: a broken line, with the 95 % interval of its corner, or that no run-in is found.

    The test takes contours for independent. Neighbours are 0.38 mm apart on a track of 22 mm; the mark of the pin and
    elements can be larger, so that neighbours hold the same mark. The table holds their correlation beside each p
    value. A smooth wave round the disc fails the test, noise of the mesh passes it: a p value says nothing about
    whether a groove has settled.
    """,
)
def run_in(job: Job) -> Any:
    """Draw the run-in: contours revolution by revolution and their normality. The table is of all runs."""
    import pandas as pd

    from bulkwear.workflows.cases.pin_on_disc.plots import contours as plots
    from bulkwear.workflows.cases.pin_on_disc.run_in import change_points, run_in_words, statistics_of
    from bulkwear.workflows.cases.pin_on_disc.runs import (
        REFERENCE,
        of_runs,
        only_reference,
        reference_remark,
        runs_and_published,
    )

    (runs, published), normality = runs_and_published(job.files), pd.read_csv(job.files.normality)
    statistics = statistics_of(runs, of_runs(runs, job.files.contours))
    shown = only_reference(statistics, runs, published, REFERENCE)
    remarks = [reference_remark(runs, published, REFERENCE), *job.remarks]
    points = change_points(shown, of_runs(runs, job.files.volumes))
    drawn = plots.run_in(shown, normality, run_in_words(shown, normality), remarks)
    return drawn, statistics, {"change_points": points}


@figure(
    "Contours",
    "Examples of contours",
    finding=figure_findings.deepest_contours,
    inputs=OF_CONTOURS,
    digits=6,
    caption="""
    Counterpart of Fig 5.14 (Yan 2022): contours at eight angles after the last three revolutions, the last one
    darkest.
    """,
)
def contour_examples(job: Job) -> Any:
    """Draw sections at eight angles after the last revolutions."""
    from bulkwear.workflows.cases.pin_on_disc.contours import example_sections
    from bulkwear.workflows.cases.pin_on_disc.plots import contours as plots
    from bulkwear.workflows.cases.pin_on_disc.runs import (
        REFERENCE,
        of_runs,
        reference_remark,
        reference_runs,
        runs_and_published,
    )

    runs, published = runs_and_published(job.files)
    chosen = runs[runs["run"].isin(reference_runs(runs, published, REFERENCE).values())]
    sections = example_sections(folder_of(job.files), chosen, of_runs(runs, job.files.contours))
    return plots.contour_examples(sections, [reference_remark(runs, published, REFERENCE), *job.remarks]), sections


@figure(
    "Contours",
    "Worn disc",
    finding=figure_findings.deepest_places,
    inputs=WORN_DISCS,
    digits=4,
    caption="""
    Counterpart of Fig 5.17 (Yan 2022): the track in three dimensions. Depth and width of the track are exaggerated by
    the factors above each picture; colours are true depths. In the thesis the spot where the pin was set down, at 0
    degrees, is far deeper than the rest.
    """,
)
def worn_disc(job: Job) -> Any:
    """Draw the worn discs in three dimensions; the table is that of the unrolled track."""
    from bulkwear.workflows.cases.pin_on_disc.contours import track_map, track_table
    from bulkwear.workflows.cases.pin_on_disc.plots import disc

    meshes, track, remarks = _reference_discs(job)
    table = track_table({scheme: track_map(mesh, track) for scheme, mesh in meshes.items()})
    return disc.worn_disc(meshes, track, remarks), table


@figure(
    "Contours",
    "Unrolled track",
    finding=figure_findings.deepest_places,
    inputs=WORN_DISCS,
    digits=4,
    caption="""
    Depth on the track, angle against radius, one map per scheme, on one scale. The pin starts at 0 degrees and goes
    towards larger angles.
    """,
)
def unrolled_track(job: Job) -> Any:
    """Draw the unrolled tracks of worn discs as maps of depth."""
    from bulkwear.workflows.cases.pin_on_disc.contours import track_map, track_table
    from bulkwear.workflows.cases.pin_on_disc.plots import disc

    meshes, track, remarks = _reference_discs(job)
    maps = {scheme: track_map(mesh, track) for scheme, mesh in meshes.items()}
    return disc.unrolled_track(maps, remarks), track_table(maps)


def _reference_discs(job: Job) -> tuple[dict[str, Any], float, list[str]]:
    """Return worn discs by scheme, the radius (m) of their track, and what figures of them must say."""
    from bulkwear.workflows.cases.pin_on_disc.runs import (
        CALIBRATED,
        reference_discs,
        reference_remark,
        runs_and_published,
    )

    runs, published = runs_and_published(job.files)
    meshes, track = reference_discs(folder_of(job.files), runs, published)
    return meshes, track, [reference_remark(runs, published, CALIBRATED), *job.remarks]


@figure(
    "Laboratory",
    "Contours beside the laboratory's",
    finding=figure_findings.contours_by_case,
    inputs={**WORN_DISCS, "cases": "results/{study}/figures/pin_comparison.csv"},
    digits=6,
    caption="""
    Counterpart of Fig 5.18 (Yan 2022). Three contours of each worn disc; brackets: least and largest depth and width
    of the laboratory's three contours (the contours themselves are not published in numbers). Black: the pin's own
    shape with the laboratory's volume. The laboratory's profile holds ridges and its mean would hold more than its
    volume.
    """,
)
def laboratory_contour(job: Job) -> Any:
    """Draw sections of worn discs beside the laboratory's contours."""
    import pandas as pd

    from bulkwear.workflows.cases.pin_on_disc import comparison
    from bulkwear.workflows.cases.pin_on_disc.plots import contours as plots
    from bulkwear.workflows.cases.pin_on_disc.runs import CALIBRATED, reference_remark, runs_and_published

    runs, published = runs_and_published(job.files)
    compared = comparison.compared_runs(runs, published)
    sections = comparison.laboratory_sections(folder_of(job.files), compared, pd.read_csv(job.files.cases))
    boxes, segment = comparison.laboratory_boxes(published), comparison.laboratory_segment(published)
    remarks = [f"beside Yan 2022: {reference_remark(runs, published, CALIBRATED)}", *job.remarks]
    return plots.laboratory_contour(sections, boxes, segment, remarks), sections
