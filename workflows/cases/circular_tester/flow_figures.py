"""Figures of the flow in the circular wear tester: steadiness, and what the lowest layer does over the samples."""

from __future__ import annotations

from typing import Any

from bulkwear.workflows.cases.circular_tester import charts, figure_findings
from bulkwear.workflows.cases.circular_tester.figures import OF_PAIRS, PAIRS, PUBLISHED, WEAR, of_study, read, runs_of
from bulkwear.workflows.cases.circular_tester.runs import SURFACE, shown_pair
from bulkwear.workflows.report.products import Job, figure

OF_SERIES = {"inputs": {**of_study("series"), **PUBLISHED}, **OF_PAIRS}
OF_PARTICLES = {"inputs": WEAR, "told": PAIRS, **OF_PAIRS}
SHOWN_REVOLUTION = 5.0  # of Fig 6.19 and 6.20


@figure(
    "Flow",
    "Steadiness",
    finding=figure_findings.variations,
    charts=(charts.STEADINESS,),
    caption="""
    Counterpart of Fig 6.7 (Yan 2022): standard deviation over mean (Eq 6.1) of each revolution since the trough began
    to turn, mean over packings with its 95 % interval. Velocity and height are those of the particles over the sample,
    height twice their centre of mass over it. At first a block stands in the sample's place; wear is known from where
    its curve begins. Steady from: of each packing, by the rule of all studies (postproc/statistics/steady.py), which
    says steady, drifting or neither.
    """,
    **OF_SERIES,
)
def tester_steadiness(job: Job) -> Any:
    """Draw how much velocity, bed height and wear rate vary in each revolution (Fig 6.7)."""
    from bulkwear.workflows.cases.circular_tester import flow
    from bulkwear.workflows.cases.circular_tester.plots.flow import steadiness

    series, published = read(job, "series", "published")
    variations = flow.revolutions_over_packings(flow.revolution_means(series, flow.STEADINESS), "variation")
    return steadiness(variations, flow.steady_revolutions(series), published, job.remarks), variations


@figure(
    "Flow",
    "Spin of the lowest layer",
    finding=figure_findings.spin,
    charts=(charts.SPIN,),
    caption="""
    Counterpart of Fig 6.17 (Yan 2022): magnitude of the averaged angular velocity of particles whose centres are within
    a median diameter of the sample's plane, by revolution of wear; the table has the mean of their own angular speeds
    as well; mean over packings with its 95 % interval. Bands: the source's standard deviations.
    """,
    **OF_SERIES,
)
def tester_spin(job: Job) -> Any:
    """Draw the spin of the lowest layer by revolution (Fig 6.17)."""
    from bulkwear.workflows.cases.circular_tester.flow import MEAN_SPIN, SPIN

    return _by_revolution(job, SPIN, MEAN_SPIN)


@figure(
    "Flow",
    "Velocity of the lowest layer",
    finding=figure_findings.velocity,
    charts=(charts.VELOCITY,),
    caption="""
    Counterpart of Fig 6.18 (Yan 2022): velocity along the travel of the same particles, mean over packings with its
    95 % interval.
    """,
    **OF_SERIES,
)
def tester_velocity(job: Job) -> Any:
    """Draw the velocity of the lowest layer by revolution (Fig 6.18)."""
    from bulkwear.workflows.cases.circular_tester.flow import VELOCITY

    return _by_revolution(job, VELOCITY)


@figure(
    "Flow",
    "Normal force by revolution",
    finding=figure_findings.force,
    charts=(charts.FORCE,),
    caption="""
    Counterpart of Fig 6.21 (Yan 2022): sum of the normal forces on the faces that wear, by revolution of wear;
    mean over packings with its 95 % interval. Bands: the source's standard deviations.
    """,
    **OF_SERIES,
)
def tester_force(job: Job) -> Any:
    """Draw the normal force by revolution (Fig 6.21)."""
    from bulkwear.workflows.cases.circular_tester.flow import FORCE

    return _by_revolution(job, FORCE)


def _by_revolution(job: Job, measure: str, *beside: str) -> Any:
    """Draw a measure of the lowest layer by revolution; beside: more measures, for the table alone."""
    from bulkwear.workflows.cases.circular_tester.flow import flow_means, revolutions_over_packings
    from bulkwear.workflows.cases.circular_tester.plots.flow import by_revolution

    series, published = read(job, "series", "published")
    means = revolutions_over_packings(flow_means(series), "mean")
    drawn = means[means["measure"] == measure]
    return by_revolution(drawn, measure, published, job.remarks), means[means["measure"].isin([measure, *beside])]


@figure(
    "Flow",
    "Map of spin",
    finding=figure_findings.turning,
    caption="""
    Counterpart of Fig 6.19 (Yan 2022): the particles of the lowest layer at the end of the wear cycle nearest to
    revolution 5, coloured by their angular speed over the plain sample's mean; of the first packing.
    """,
    **OF_PARTICLES,
)
def tester_spin_map(job: Job) -> Any:
    """Draw how fast the particles of the lowest layer turn (Fig 6.19)."""
    return _motion(job, "relative_angular_speed", "Angular speed over the plain sample's mean (-)")


@figure(
    "Flow",
    "Map of velocity",
    finding=figure_findings.passing,
    caption="Counterpart of Fig 6.20 (Yan 2022): the same particles by their speed, with arrows of their velocity.",
    **OF_PARTICLES,
)
def tester_velocity_map(job: Job) -> Any:
    """Draw how fast the particles of the lowest layer pass (Fig 6.20)."""
    return _motion(job, "relative_speed", "Speed over the plain sample's mean (-)")


def _motion(job: Job, quantity: str, label: str) -> Any:
    """Draw the particles of the lowest layer over both samples by a speed of `relative_motion`."""
    import pandas as pd

    from bulkwear.postproc.mesh import read_surface
    from bulkwear.workflows.cases.circular_tester.distribution import top_of
    from bulkwear.workflows.cases.circular_tester.layer import layer_particles, outlines, relative_motion
    from bulkwear.workflows.cases.circular_tester.plots.flow import relative_motion as draw

    runs = shown_pair(runs_of(job))
    particles = relative_motion(pd.concat([layer_particles(run, SHOWN_REVOLUTION) for run in runs], ignore_index=True))
    lines = {run.surface: outlines(top_of(read_surface(run.folder / SURFACE))) for run in runs}
    return draw(particles, quantity, label, lines, job.remarks), particles
