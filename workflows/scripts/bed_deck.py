"""Render the deck of a bed."""

from pathlib import Path

from workflows.chain import write_bed
from workflows.job import job_log

with job_log(snakemake.log[0]):
    write_bed(snakemake.params.bed, Path(snakemake.output[0]).parent)
