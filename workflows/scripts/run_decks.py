"""Render every deck of a run."""

from pathlib import Path

from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.chain import Chain, write_decks
from bulkwear.workflows.engine.job import project_job

with project_job(snakemake.log[0]):
    write_decks(
        Chain(
            name=snakemake.wildcards.run,
            folder=Path(snakemake.output[0]).parents[1],
            case=find_case(snakemake.params.case),
            parameters=snakemake.params.run,
            surface=Path(snakemake.input[0]),
            bed=snakemake.params.bed,
            bed_restart=snakemake.params.bed_restart and Path(snakemake.params.bed_restart),
        )
    )
