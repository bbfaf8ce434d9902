"""Collect the tables of the runs of a circular wear tester."""

from pathlib import Path

from workflows.job import job_log
from workflows.tester_figures import tester_runs, write_tables

with job_log(snakemake.log[0]):
    folder = Path(snakemake.output.volumes).parent
    runs = tester_runs(snakemake.params.runs, folder.parent)
    write_tables(runs, folder, dict(snakemake.input.items()))
