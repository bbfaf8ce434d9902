"""Simulate shear boxes of other sizes."""

from pathlib import Path

from bulkwear.workflows.cases.calibration.driver import run_box_sizes
from bulkwear.workflows.engine.job import project_job

with project_job(snakemake.log[0]):
    table = run_box_sizes(
        snakemake.params.runs, Path(snakemake.input.pairs), Path(snakemake.output[0]).parent, snakemake.threads
    )
    table.to_csv(snakemake.output[0], index=False)
