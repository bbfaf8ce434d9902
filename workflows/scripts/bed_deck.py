"""Render the deck of a bed."""

from pathlib import Path

from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.chain import write_bed
from bulkwear.workflows.engine.job import project_job

with project_job(snakemake.log[0]):
    write_bed(find_case(snakemake.params.case), snakemake.params.bed, Path(snakemake.output[0]).parent)
