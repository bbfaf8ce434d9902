"""Simulate bulk tests until the contact parameters are known as well as the measurement allows."""

from pathlib import Path

from bulkwear.workflows.cases.calibration.driver import run_calibration
from bulkwear.workflows.engine.job import project_job
from bulkwear.workflows.engine.ranks import ranks_to_start

with project_job(snakemake.log[0]):
    resources = snakemake.resources
    at_once = ranks_to_start(resources.cpus_per_task, snakemake.threads, resources.submitted)  # of a rank each
    tables = run_calibration(
        snakemake.params.run,
        Path(snakemake.input.measured),
        Path(snakemake.input.pairs),
        Path(snakemake.output.simulations).parent,
        at_once,
    )
    for name, table in zip(("simulations", "looks", "repeats"), tables, strict=True):
        table.to_csv(snakemake.output[name], index=False)
