"""Figures of the volume that a pin wears off its disc, and of the wear coefficient that follows from it."""

from __future__ import annotations

from typing import Any

from bulkwear.workflows.cases.pin_on_disc import charts, figure_findings
from bulkwear.workflows.cases.pin_on_disc.page import update_remark
from bulkwear.workflows.report.products import Job, OfStudy, every_run, figure

DESIGN = "results/{study}/design.csv"
PUBLISHED = "config/published/pin_on_disc.csv"
FITS = "config/published/pin_on_disc_volume.csv"
NORMALITY = "config/published/pin_on_disc_normality.csv"
CONTOURS, VOLUMES = every_run("contours.csv"), every_run("volumes.csv")


def has_series(name: str) -> OfStudy:
    """Return what says whether the design of a study has rows of a series."""
    return lambda study: any(row["series"] == name for row in study.design_rows)


@figure(
    "Laboratory",
    "Thesis, laboratory and ours",
    finding=figure_findings.compared,
    charts=(charts.COMPARISON,),
    inputs={"design": DESIGN, "published": PUBLISHED, "contours": CONTOURS, "volumes": VOLUMES},
    caption="""
    Counterpart of Table 5.4 (Yan 2022): mean depth and width of the contours and removed volume, beside the
    laboratory's and the thesis' values. Differences in per cent of the laboratory's and of the thesis' value. The
    pin's shape is the groove that a pin of 3 mm leaves if the laboratory's volume is spread evenly round the track.
    """,
)
def pin_comparison(job: Job) -> Any:
    """Draw depth, width and volume beside those of laboratory and thesis."""
    from bulkwear.workflows.cases.pin_on_disc import comparison
    from bulkwear.workflows.cases.pin_on_disc.plots import volume as plots
    from bulkwear.workflows.cases.pin_on_disc.runs import CALIBRATED, of_runs, reference_remark, runs_and_published

    runs, published = runs_and_published(job.files)
    contours, volumes = (of_runs(runs, files) for files in (job.files.contours, job.files.volumes))
    cases = comparison.compared_cases(comparison.compared_runs(runs, published), contours, volumes, published)
    table = comparison.comparison(published, cases)
    remarks = [f"beside Yan 2022: {reference_remark(runs, published, CALIBRATED)}", *job.remarks]
    return plots.comparison(table, remarks), table


@figure(
    "Volume",
    "What exceeds Archard's volume",
    finding=figure_findings.excess,
    inputs={"published": PUBLISHED, "factors": "results/{study}/figures/force_rise.csv"},
    told={"update_remark": update_remark},
    caption="""
    The published volumes are several times alpha F L of their own load and track. One candidate at a time, as factors
    that multiply exactly to the volume that the thesis' own rules would sum up: the summed normal force over the load,
    the path of the contact point over the length of the track, the share of the wear that is taken up and not carried
    over to later updates, the displacement rule (volume that the surface loses over the wear taken up; 1 if volume is
    conserved) and the rule by which volume is summed. Eq 5.9 sums area times path of the centroid over "the elements";
    if those are all triangles it finds what the surface has lost, if they are the triangles in contact at the time it
    leaves out their neighbours, which move as well. The bars take the second reading (a conserving patch moves
    triangles that nothing touches, its sum is over all), the table holds both.

    The second reading depends on the length of a wear update. On a flat disc it gives 1 times alpha times the sliding
    work with one triangle per update, about 3 times with an arc of many triangles, where all triangles give about 6
    times. The source updates in every time step, here an update is as long as the figure says: how near the product
    comes to the published factor hangs on that length, and is a lead rather than an explanation.

    Hatched: what of the published factor is left over, below 1 where the rules would give more than was published.
    Contacts at once: the factor that would come of it if every contact were charged with the whole load; it is no
    part of the product.
    """,
)
def excess_volume(job: Job) -> Any:
    """Draw what volumes above alpha F L are made of."""
    import pandas as pd

    from bulkwear.workflows.cases.pin_on_disc.plots import volume as plots
    from bulkwear.workflows.cases.pin_on_disc.volume import groove_remark, shown_factors

    published = pd.read_csv(job.files.published)
    shown = shown_factors(pd.read_csv(job.files.factors), published)
    remarks = [groove_remark(published), job.told.update_remark, *job.remarks]
    return plots.excess_volume(shown, remarks), shown


@figure(
    "Volume",
    "Volume against revolutions",
    finding=figure_findings.over_law,
    charts=(charts.WEAR_VOLUME,),
    inputs={"design": DESIGN, "published": PUBLISHED, "fits": FITS, "volumes": VOLUMES},
    tables={"trends": "figures/wear_volume_trends.csv"},
    caption="""
    Counterpart of Fig 5.15 (Yan 2022). Volume that the surface has lost, by wear coefficient and displacement scheme,
    beside the published fits (dashed, drawn as printed from the first revolution on, beside runs of their load and
    track alone) and the volume alpha F L of
    Archard's law with the load F. For the per-triangle rule the volume is also summed as the thesis does (Eq 5.9:
    absolute paths of the centroids times areas). Titles hold the 95 % interval of how much what a revolution adds
    changes over the run: 0 for linear growth. It is that of the run that is shown, for increments correlated with their
    neighbours; no run is repeated. A table beside the figure holds all of them.
    """,
)
def wear_volume(job: Job) -> Any:
    """Draw volume against revolutions, and test what revolutions add for being all the same."""
    import pandas as pd

    from bulkwear.workflows.cases.pin_on_disc.plots import volume as plots
    from bulkwear.workflows.cases.pin_on_disc.runs import conditions_words, of_runs, runs_and_published
    from bulkwear.workflows.cases.pin_on_disc.volume import beside_laws, volume_trends

    runs, published = runs_and_published(job.files)
    volumes = of_runs(runs, job.files.volumes)
    volumes = volumes[volumes["series"] == "coefficient"]
    trends, fits = volume_trends(volumes), pd.read_csv(job.files.fits)
    other = conditions_words(volumes, published)
    remarks = [*([f"{other}: the published fits are left out beside them"] if other else []), *job.remarks]
    table = beside_laws(volumes, fits, published)
    return plots.wear_volume(table, fits, trends, remarks), table, {"trends": trends}


@figure(
    "Forces",
    "Rise of the summed normal force",
    finding=figure_findings.force_over_load,
    charts=(charts.FORCE_RISE,),
    inputs={"published": PUBLISHED, "fits": FITS, "volumes": "results/{study}/figures/wear_volume.csv"},
    caption="""
    Counterpart of Fig 5.16 (Yan 2022), which explains the excess volume by a horizontal part of the normal force in
    the worn groove. Measured: the vertical force over the load (1 where the load is carried), the sum of the normal
    forces of all contacts over the load, and the number of contacts at once; means since the start.
    """,
)
def force_rise(job: Job) -> Any:
    """Draw how the summed normal force rises above the load; the table holds all factors of the volume."""
    import pandas as pd

    from bulkwear.workflows.cases.pin_on_disc.plots import volume as plots
    from bulkwear.workflows.cases.pin_on_disc.volume import excess_factors

    read = (pd.read_csv(path) for path in (job.files.volumes, job.files.fits, job.files.published))
    factors = excess_factors(*read)
    return plots.force_rise(factors, job.remarks), factors


@figure(
    "Laboratory",
    "Calibration of the wear coefficient",
    finding=figure_findings.coefficients,
    charts=(charts.CALIBRATION,),
    inputs={
        "design": DESIGN,
        "published": PUBLISHED,
        "fits": FITS,
        "normality": NORMALITY,
        "statistics": "results/{study}/figures/run_in.csv",
        "volumes": VOLUMES,
    },
    tables={"limits": "figures/scaling_limits.csv"},
    caption="""
    The coefficient that makes N simulated revolutions remove the laboratory's volume, by scheme, and by the published
    fits from the third revolution on (before, they do not grow with the coefficient). Bars: the laboratory's error of
    volume. The band is the laboratory's own coefficient, V / (F L) = (6.3 +- 1)e-13 1/Pa, times the scaling factor
    1302.5 / N: with a scheme that conserves volume nothing else is to be calibrated, but for the rise of the normal
    force. Dotted lines: the largest scaling factor that the run-in allows; a run-in that ends with revolution 1 sets
    no limit. The table of limits holds the factor at which a wear update reaches the cap of its steps, too: for these
    wear cycles per revolution and elements only.
    """,
)
def calibration(job: Job) -> Any:
    """Draw the wear coefficient that makes few revolutions stand for the laboratory's."""
    import pandas as pd

    from bulkwear.postproc.tables.summary import published_value
    from bulkwear.workflows.cases.pin_on_disc import coefficient
    from bulkwear.workflows.cases.pin_on_disc.plots import volume as plots
    from bulkwear.workflows.cases.pin_on_disc.run_in import run_in_table
    from bulkwear.workflows.cases.pin_on_disc.runs import (
        REFERENCE,
        conditions_words,
        of_runs,
        only_reference,
        reference_remark,
        runs_and_published,
    )

    runs, published = runs_and_published(job.files)
    volumes, revolutions = of_runs(runs, job.files.volumes), published_value(published, "revolutions", "laboratory")
    table = coefficient.calibrated(volumes, pd.read_csv(job.files.fits), published)
    statistics = only_reference(pd.read_csv(job.files.statistics), runs, published, REFERENCE)
    run_ins = run_in_table(statistics, pd.read_csv(job.files.normality))
    limits = coefficient.scaling_limits(run_ins, revolutions)
    laboratory = coefficient.coefficient_of_laboratory(published)
    remarks = [f"run-in: {reference_remark(runs, published, REFERENCE)}", *job.remarks]
    if other := conditions_words(runs[runs["series"] == "coefficient"], published):
        remarks.append(f"{other}: volumes are taken over load and track, times the source's")
    drawn = plots.calibration(table, laboratory, revolutions, limits, remarks)
    caps = coefficient.step_cap_limits(volumes, laboratory[0])
    table = coefficient.beside_laboratory(table, laboratory)
    return drawn, table, {"limits": limits.merge(caps, on="run", how="left")}


@figure(
    "Volume",
    "Size invariance of Archard's law",
    finding=figure_findings.sizes,
    charts=(charts.SIZE_INVARIANCE,),
    inputs={"design": DESIGN, "published": PUBLISHED, "volumes": VOLUMES},
    when=has_series("size"),
    caption="""
    Counterpart of Fig 4.6 (Yan 2022): volume of one revolution, alpha times the solver's sliding work, over alpha F
    L, by the scale of the pin. The load is the same, so is the volume; the thesis has differences under 0.6 %. The
    pins are spheres whose radius grows with the scale and whose mass grows with its cube, and there is no gravity: load
    and track stay, only the pin is scaled.
    """,
)
def size_invariance(job: Job) -> Any:
    """Draw simulated over theoretical volume against the scale of the pin."""
    from bulkwear.postproc.tables.summary import published_value
    from bulkwear.workflows.cases.pin_on_disc import volume
    from bulkwear.workflows.cases.pin_on_disc.plots import volume as plots
    from bulkwear.workflows.cases.pin_on_disc.runs import of_runs, runs_and_published

    runs, published = runs_and_published(job.files)
    table = volume.size_invariance(volume.size_cases(of_runs(runs, job.files.volumes)))
    bound = published_value(published, "size_invariance_difference", "simulation")
    return plots.size_invariance(table, bound, job.remarks), table
