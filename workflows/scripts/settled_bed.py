"""Fill and settle a bed."""

from pathlib import Path

from workflows.cycles import fill_bed
from workflows.job import job_log

with job_log(snakemake.log[0]):
    folder = Path(snakemake.output.restart).parent
    fill_bed(snakemake.wildcards.bed, snakemake.params.bed, folder, snakemake.threads)
