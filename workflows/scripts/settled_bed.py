"""Fill and settle a bed."""

from pathlib import Path

from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.cycles import fill_bed
from bulkwear.workflows.engine.job import project_job
from bulkwear.workflows.engine.patience import patience_of
from bulkwear.workflows.engine.ranks import ranks_to_start
from bulkwear.workflows.engine.solver import LAUNCHER

with project_job(snakemake.log[0]):
    folder = Path(snakemake.output.restart).parent
    ranks = ranks_to_start(snakemake.resources.tasks, snakemake.threads, snakemake.resources.submitted)
    case, launcher = find_case(snakemake.params.case), snakemake.resources.get("mpi", LAUNCHER)
    patience = patience_of(snakemake.resources, ranks)
    fill_bed(case, snakemake.wildcards.bed, snakemake.params.bed, folder, ranks, launcher, patience)
