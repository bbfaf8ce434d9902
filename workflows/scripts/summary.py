"""Write the summary of a study: one row per run."""

from postproc.analysis.summary import summary_table
from workflows.job import job_log

with job_log(snakemake.log[0]):
    summary_table(snakemake.input.design, snakemake.input.wear).to_csv(snakemake.output[0], index=False)
