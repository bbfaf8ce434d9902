"""Simulate shear boxes of other sizes."""

from pathlib import Path

from bulkwear.workflows.cases.calibration.driver import run_box_sizes
from bulkwear.workflows.engine.job import project_job
from bulkwear.workflows.engine.ranks import ranks_to_start

with project_job(snakemake.log[0]):
    resources = snakemake.resources
    at_once = ranks_to_start(resources.cpus_per_task, snakemake.threads, resources.submitted)  # of a rank each
    table = run_box_sizes(snakemake.params.runs, Path(snakemake.input.pairs), Path(snakemake.output[0]).parent, at_once)
    table.to_csv(snakemake.output[0], index=False)
