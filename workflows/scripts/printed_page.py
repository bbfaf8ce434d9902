"""Print the page of a study as PDF."""

from pathlib import Path

from bulkwear.workflows.engine.job import project_job
from bulkwear.workflows.report.printed import print_page

with project_job(snakemake.log[0]):
    print_page(Path(snakemake.input[0]), Path(snakemake.output[0]))
