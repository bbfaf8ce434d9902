"""Measure what the solver's work costs on this machine."""

import tempfile
from pathlib import Path

from bulkwear.workflows.engine.job import Progress, project_job
from bulkwear.workflows.engine.project import leave_project
from bulkwear.workflows.forecast.rate_benchmark import measured_rates
from bulkwear.workflows.forecast.rates import write_rates

with project_job(snakemake.log[0]), tempfile.TemporaryDirectory() as folder:
    leave_project()  # they are measured on the package's own decks
    say = Progress("rates", 1).say
    say("a minute or two on an idle machine; other work on it makes them less sharp")
    write_rates(Path(snakemake.output[0]), measured_rates(Path(folder), say, snakemake.threads))
