"""Print what a study will cost."""

from pathlib import Path

from bulkwear.workflows.engine.job import project_job
from bulkwear.workflows.forecast.forecast import forecast_table, forecast_text
from bulkwear.workflows.forecast.rates import read_rates

with project_job(snakemake.log[0]):
    found = read_rates(Path(snakemake.input.rates))
    table = forecast_table(snakemake.params.work, found.rates)
    given = snakemake.params
    print(forecast_text(given.heading, given.study, table, given.cores, found.said()), flush=True)
