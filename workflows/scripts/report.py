"""Assemble the page of a study."""

from pathlib import Path

from workflows.job import job_log
from workflows.study_report import write_page

with job_log(snakemake.log[0]):
    write_page(Path(snakemake.output[0]), snakemake.params.study)
