"""Figures of the flow through a machine: over time, from the side, its mean paths, the charge of a mill."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.equipment import charts, figure_findings
from bulkwear.workflows.cases.equipment.map_figures import (
    BESIDE,
    DIGITS,
    SURFACES,
    TOLD,
    folder_of,
)
from bulkwear.workflows.cases.equipment.tables import values_of_runs
from bulkwear.workflows.report.products import Job, every_run, figure

if TYPE_CHECKING:
    from bulkwear.workflows.config.design import Study


TURNING, LEVEL = ("rotation", "turning_surface"), 0.2  # kinds of motion; -, sine of an axis with the horizontal


MOST_DESIGNS = 4  # on a figure, each as built and as worn


def is_mill(study: Study) -> bool:
    """Return whether a study is of mills: filled, without a feed, and turning about a level axis."""

    def turns(part: Mapping[str, Any]) -> bool:
        motion = part["motion"] or {"kind": ""}
        return motion["kind"] in TURNING and abs(motion["axis"][2]) < LEVEL * math.hypot(*motion["axis"])

    every = [run.parameters for run in study.runs]
    return all(run["filling"] and not run["inlet"] and any(map(turns, run["parts"])) for run in every)


def runs_in_panels(job: Job) -> Any:
    """Return the runs of the designs that are drawn side by side."""
    from bulkwear.workflows.cases.equipment.pictures import shown_runs

    return shown_runs(job.told.runs, MOST_DESIGNS)


def remarks_on_panels(job: Job) -> list[str]:
    """Return what is said on a figure of panels: what is missing, and which packings and designs are not drawn."""
    from bulkwear.workflows.cases.equipment.pictures import designs_remark, packings_remark

    return [*job.remarks, *packings_remark(job.told.runs), *designs_remark(job.told.runs, MOST_DESIGNS)]


@figure(
    "Flow",
    "Flow over time",
    finding=figure_findings.held_and_power,
    charts=(charts.FLOW,),
    inputs={"wear": every_run(BESIDE)},
    told={"runs": values_of_runs},
    digits=DIGITS,
    caption="""
    Mass that comes in and goes out, mass held in the machine, and the power that moving parts give to the particles,
    means over a block. Thick: first packing, thin: others. Grey: start-up, of which nothing is counted;
    then the shape as built, while wear is carried on to the shape, and the worn shape.
    """,
)
def flow_over_time(job: Job) -> Any:
    """Draw mass in, out and held and the power of moving parts over time."""
    from bulkwear.workflows.cases.equipment.histories import flow_series, phase_spans
    from bulkwear.workflows.cases.equipment.pictures import designs_remark
    from bulkwear.workflows.cases.equipment.plots.curves import MOST_SETTINGS
    from bulkwear.workflows.cases.equipment.plots.curves import flow_over_time as draw
    from bulkwear.workflows.cases.equipment.tables import read_runs

    runs = read_runs(job.told.runs, folder_of(job))
    series, remarks = flow_series(runs), [*job.remarks, *designs_remark(job.told.runs, MOST_SETTINGS)]
    return draw(series, phase_spans(runs), remarks), series


@figure(
    "Flow",
    "The flow from the side",
    finding=figure_findings.speeds("speed_m_per_s", "Mean speed of the particles shown"),
    inputs=SURFACES,
    told=TOLD,
    digits=DIGITS,
    caption="""
    Particles at the end of the time on the shape as built and on the worn one, by their speed, of the first packing;
    those in front hide others. Lines: section of the parts through the middle of the particles. The view is along the
    axis of a slice, or the one that parts turn about, else along the level axis in which particles move least.
    """,
)
def flow_pictures(job: Job) -> Any:
    """Draw the particles of an instant as built and as worn."""
    from bulkwear.workflows.cases.equipment.flow_panels import panel_rows, particle_panels
    from bulkwear.workflows.cases.equipment.plots.flow import flow_pictures as draw

    panels = particle_panels(runs_in_panels(job), folder_of(job))
    return draw(panels, remarks_on_panels(job)), panel_rows(panels)


@figure(
    "Flow",
    "Mean paths",
    finding=figure_findings.speeds("speed_m_per_s", "Mean velocity over the cells"),
    inputs=SURFACES,
    told=TOLD,
    digits=DIGITS,
    caption="""
    Mean velocity across the view, by mass, in cells 1.25 mean diameters wide, of all snapshots on the shape as built
    and on the worn one; arrows lie along the mean paths. Views as in the picture of the flow.
    """,
)
def velocity_fields(job: Job) -> Any:
    """Draw mean velocities as built and as worn."""
    from bulkwear.workflows.cases.equipment.flow_panels import panel_rows, velocity_panels
    from bulkwear.workflows.cases.equipment.plots.flow import velocity_fields as draw

    panels = velocity_panels(runs_in_panels(job), folder_of(job))
    return draw(panels, remarks_on_panels(job)), panel_rows(panels)


@figure(
    "Flow",
    "Shoulder and toe of the charge",
    finding=figure_findings.charge,
    inputs=SURFACES,
    told=TOLD,
    when=is_mill,
    digits=DIGITS,
    caption="""
    How full the section of the mill is, a mean over all snapshots on the shape as built and on the worn one, of the
    first packing; the sentence above has the angles of all. Shoulder and toe: where the layer at the shell, two mean
    diameters thick, is half as full as most of it; degrees from 12 o'clock in the sense of rotation, as Kalala (2008)
    tells them.
    """,
)
def charge_shape(job: Job) -> Any:
    """Draw where the charge of a mill lies, with its toe and shoulder."""
    from bulkwear.workflows.cases.equipment.flow_panels import charge_panels, charge_rows
    from bulkwear.workflows.cases.equipment.plots.flow import charge_shape as draw

    folder = folder_of(job)
    return draw(charge_panels(runs_in_panels(job), folder), remarks_on_panels(job)), charge_rows(job.told.runs, folder)
