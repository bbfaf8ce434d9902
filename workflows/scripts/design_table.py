"""Write the design table of a study: one row per run."""

from pathlib import Path

from bulkwear.workflows.engine.job import job_log, write_table

with job_log(snakemake.log[0]):
    write_table(Path(snakemake.output[0]), snakemake.params.rows)
