"""Render the deck of a bed."""

from pathlib import Path

from workflows.engine.case import find_case
from workflows.engine.chain import write_bed
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    write_bed(find_case(snakemake.params.case), snakemake.params.bed, Path(snakemake.output[0]).parent)
