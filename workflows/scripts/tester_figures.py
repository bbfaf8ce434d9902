"""Draw the figures of one job of a circular wear tester."""

from pathlib import Path

from workflows.cases.circular_tester.figures import JOBS, Drawing, tester_runs
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    tables = Path(snakemake.input.tables).parent
    JOBS[snakemake.params.job](
        Drawing(
            runs=tester_runs(snakemake.params.runs, tables.parent),
            tables=tables,
            folder=Path(snakemake.output.figures[0]).parent,
            paths=dict(snakemake.input.items()),
            remarks=snakemake.params.remarks,
        )
    )
