"""Write what a study will cost, job by job."""

from pathlib import Path

from bulkwear.workflows.engine.job import project_job
from bulkwear.workflows.forecast.forecast import forecast_table
from bulkwear.workflows.forecast.rates import read_rates

with project_job(snakemake.log[0]):
    found = read_rates(Path(snakemake.input.rates))
    table = forecast_table(snakemake.params.work, found.rates)
    table.assign(fidelity=snakemake.params.fidelity, by=found.said()).to_csv(snakemake.output[0], index=False)
