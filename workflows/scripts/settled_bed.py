"""Fill and settle a bed."""

from pathlib import Path

from workflows.cycles import fill_bed
from workflows.job import job_log
from workflows.solver import LAUNCHER

with job_log(snakemake.log[0]):
    folder = Path(snakemake.output.restart).parent
    tasks, launcher = snakemake.resources.tasks, snakemake.resources.get("mpi", LAUNCHER)
    fill_bed(snakemake.wildcards.bed, snakemake.params.bed, folder, tasks, launcher)
