"""Draw convex over plain wear."""

from postproc.analysis.comparison import read_history, read_summary, relative_wear_table
from postproc.plots.bars import relative_wear
from postproc.plots.style import save
from workflows.job import job_log

with job_log(snakemake.log[0]):
    summary, history = read_summary(snakemake.input.summary), read_history(snakemake.input.history)
    table = relative_wear_table(summary, history, snakemake.params.size_ratios)
    save(relative_wear(table, snakemake.params.remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
