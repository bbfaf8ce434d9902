"""Draw the wear of base and bumps."""

from postproc.plots.style import save
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.comparison import wear_split
from workflows.cases.sliding_sample.plots import bars
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    split = wear_split(read_summary(snakemake.input[0]))
    save(bars.wear_split(split, snakemake.params.remarks), snakemake.output.figure)
    split.to_csv(snakemake.output.table, index=False)
