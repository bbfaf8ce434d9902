"""Assemble the page of a calibration."""

from pathlib import Path

from workflows.cases.calibration.html_page import write_page
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    write_page(
        Path(snakemake.output[0]), snakemake.params.study, Path(snakemake.input.measured), Path(snakemake.input.pairs)
    )
