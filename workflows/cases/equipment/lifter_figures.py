"""The table of a mill's lifters against hours of operation, and its figure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bulkwear.workflows.cases.equipment import charts, figure_findings
from bulkwear.workflows.cases.equipment.figures import LIFTERS
from bulkwear.workflows.cases.equipment.flow_figures import is_mill
from bulkwear.workflows.cases.equipment.map_figures import BESIDE, DIGITS, deforms, folder_of
from bulkwear.workflows.cases.equipment.tables import values_of_runs
from bulkwear.workflows.report.products import Job, every_run, figure, tables

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.workflows.config.design import Study


def wears_mills(study: Study) -> bool:
    """Return whether a study is of mills, and wears their shape."""
    return is_mill(study) and deforms(study)


@tables(
    inputs={"wear": every_run(BESIDE), "surfaces": every_run("surface.vtu")},
    told={"runs": values_of_runs},
    tables=LIFTERS,
    when=is_mill,
    digits=DIGITS,
)
def lifters(job: Job) -> dict[str, pd.DataFrame]:
    """Measure the lifters as built and after every update."""
    from bulkwear.workflows.cases.equipment.lifters import lifters_table

    return {"lifters": lifters_table(job.told.runs, folder_of(job))}


@figure(
    "Wear",
    "Lifters against hours of operation",
    finding=figure_findings.lifters,
    charts=(charts.LIFTERS,),
    inputs={name: f"results/{{study}}/{path}" for name, path in LIFTERS.items()},
    when=wears_mills,
    digits=DIGITS,
    caption="""
    Height of the crests above the plates, and lean of the leading face from the radius: means over lifters and
    packings, as built and after every update of the shape. Bars: 95 % interval over packings; of one packing the
    scatter is unknown.
    """,
)
def lifter_profiles(job: Job) -> Any:
    """Draw height and leading face of lifters against hours of operation."""
    from bulkwear.postproc.tables.summary import read_named
    from bulkwear.workflows.cases.equipment.plots.lifters import lifter_profiles as draw

    table = read_named(job.files.lifters, "part")
    return draw(table, job.remarks), table
