"""Write the design table of a study: one row per run."""

from pathlib import Path

from bulkwear.workflows.engine.job import project_job, write_table

with project_job(snakemake.log[0]):
    write_table(Path(snakemake.output[0]), snakemake.params.rows)
