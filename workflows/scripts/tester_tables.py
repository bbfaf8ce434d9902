"""Collect the tables of the runs of a circular wear tester."""

from pathlib import Path

from workflows.cases.circular_tester.figures import tester_runs, write_tables
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    folder = Path(snakemake.output.volumes).parent
    runs = tester_runs(snakemake.params.runs, folder.parent)
    write_tables(runs, folder, dict(snakemake.input.items()))
