"""Fill and settle a bed."""

from pathlib import Path

from workflows.cycles import fill_bed
from workflows.job import job_log
from workflows.solver import LAUNCHER, ranks_here

with job_log(snakemake.log[0]):
    folder = Path(snakemake.output.restart).parent
    ranks = ranks_here(snakemake.resources.tasks, snakemake.threads)
    fill_bed(snakemake.wildcards.bed, snakemake.params.bed, folder, ranks, snakemake.resources.get("mpi", LAUNCHER))
