"""Draw cumulative wear against travel."""

from postproc.plots.curves import wear_against_travel
from postproc.plots.style import save
from postproc.tables.history import wear_history
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    history = wear_history(snakemake.input.design, snakemake.input.wear)
    save(wear_against_travel(history, snakemake.params.remarks), snakemake.output.figure)
    history.to_csv(snakemake.output.table, index=False)
