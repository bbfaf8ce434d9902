"""Write the interactive page of worn surfaces: all runs of the rows that are shown in detail."""

from postproc.plots.page import surfaces_page
from postproc.plots.pictures import colour_limits
from postproc.tables.depths import carried_remark, depth_quantity, depth_table, read_worn_surfaces
from postproc.tables.summary import read_summary, rows_to_show, runs_of_rows
from workflows.cases.sliding_sample.page import ROWS_IN_DETAIL
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    summary, deformed = read_summary(snakemake.input.summary), snakemake.params.deformed
    shown = runs_of_rows(summary, rows_to_show(summary, ROWS_IN_DETAIL))
    files = dict(zip(summary["run"], snakemake.input.surfaces, strict=True))
    meshes = read_worn_surfaces(shown, [files[run] for run in shown])
    limits = colour_limits(depth_table(meshes, deformed))
    remarks = [*snakemake.params.remarks, carried_remark(meshes, deformed)]
    surfaces_page(snakemake.output[0], meshes, deformed, limits, depth_quantity(deformed), remarks)
