"""Fill and settle a bed."""

from pathlib import Path

from workflows.cycles import fill_bed
from workflows.job import job_log

with job_log(snakemake.log[0]):
    fill_bed(snakemake.wildcards.bed, snakemake.params.bed, Path(snakemake.output.restart).parent)
