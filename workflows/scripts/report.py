"""Assemble the page of a study."""

from pathlib import Path

from bulkwear.workflows.engine.job import project_job
from bulkwear.workflows.report.page import write_page

with project_job(snakemake.log[0]):
    write_page(Path(snakemake.output[0]), snakemake.params.study)
