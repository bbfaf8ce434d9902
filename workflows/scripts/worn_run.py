"""Run the wear cycles of a run, or what is missing of them."""

from pathlib import Path

from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.cycles import run_chain
from bulkwear.workflows.engine.job import project_job
from bulkwear.workflows.engine.patience import patience_of
from bulkwear.workflows.engine.ranks import ranks_to_start
from bulkwear.workflows.engine.solver import LAUNCHER

with project_job(snakemake.log[0]):
    ranks = ranks_to_start(snakemake.resources.tasks, snakemake.threads, snakemake.resources.submitted)
    run_chain(
        Chain(
            name=snakemake.wildcards.run,
            folder=Path(snakemake.output.wear).parent,
            case=find_case(snakemake.params.case),
            parameters=snakemake.params.run,
            surface=Path(snakemake.input.surface),
            bed=snakemake.params.bed,
            bed_restart=next(map(Path, snakemake.input.bed), None),
            ranks=ranks,
            launcher=snakemake.resources.get("mpi", LAUNCHER),
            patience=patience_of(snakemake.resources, ranks),
            same_as=next((Path(path).parent for path in snakemake.input.same), None),
        )
    )
