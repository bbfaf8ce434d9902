"""Print what a study will cost."""

from pathlib import Path

from workflows.forecast import forecast_table, forecast_text
from workflows.job import job_log
from workflows.rates import read_rates

with job_log(snakemake.log[0]):
    found = read_rates(Path(snakemake.input.rates))
    table = forecast_table(snakemake.params.work, found.rates)
    given = snakemake.params
    print(forecast_text(given.heading, given.study, table, given.cores, found.said()), flush=True)
