"""Assemble the page of a study."""

from pathlib import Path

from bulkwear.workflows.engine.job import job_log
from bulkwear.workflows.report.page import write_page

with job_log(snakemake.log[0]):
    write_page(Path(snakemake.output[0]), snakemake.params.study)
