"""Assemble the page of a calibration."""

from pathlib import Path

from workflows.calibration_page import write_page
from workflows.job import job_log

with job_log(snakemake.log[0]):
    write_page(
        Path(snakemake.output[0]), snakemake.params.study, Path(snakemake.input.measured), Path(snakemake.input.pairs)
    )
