"""Draw what each wear update did: along the travel, or the worst per run where there are many design rows."""

from postproc.plots import curves, updates
from postproc.plots.style import save
from postproc.tables.updates import update_summary, wear_updates
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    table, draw = wear_updates(snakemake.input.design, snakemake.input.wear), updates.wear_updates
    if table["row"].nunique() > curves.FEW_ROWS:
        table, draw = update_summary(table), updates.worst_updates
    save(draw(table, snakemake.params.angle_bound, snakemake.params.remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
