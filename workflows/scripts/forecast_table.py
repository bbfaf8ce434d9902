"""Write what a study will cost, job by job."""

from pathlib import Path

from workflows.forecast import forecast_table
from workflows.job import job_log
from workflows.rates import read_rates

with job_log(snakemake.log[0]):
    found = read_rates(Path(snakemake.input.rates))
    table = forecast_table(snakemake.params.work, found.rates)
    table.assign(fidelity=snakemake.params.fidelity, by=found.said()).to_csv(snakemake.output[0], index=False)
