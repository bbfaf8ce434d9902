"""Render the deck of a bulk test with the meshes that it reads."""

from pathlib import Path

from bulkwear.workflows.cases.calibration.boxes import test_of
from bulkwear.workflows.engine.bulk_tests import write_test
from bulkwear.workflows.engine.job import project_job

with project_job(snakemake.log[0]):
    run = snakemake.params.run
    test = test_of(run, snakemake.wildcards.test, {}, run["calibration"]["seed"])
    write_test(test, Path(snakemake.output[0]).parent)
