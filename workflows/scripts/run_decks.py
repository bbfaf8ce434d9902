"""Render every deck of a run."""

from pathlib import Path

from workflows.chain import Chain, write_decks
from workflows.job import job_log

with job_log(snakemake.log[0]):
    write_decks(
        Chain(
            name=snakemake.wildcards.run,
            folder=Path(snakemake.output[0]).parents[1],
            parameters=snakemake.params.run,
            bed=snakemake.params.bed,
            surface=Path(snakemake.input[0]),
            bed_restart=Path(snakemake.params.bed_restart),
        )
    )
