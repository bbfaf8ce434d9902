"""Draw how the summed normal force rises above the load, and the factors of the volume."""

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.plots.volume import force_rise
from workflows.cases.pin_on_disc.volume import excess_factors
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    factors = excess_factors(pd.read_csv(snakemake.input.volumes), pd.read_csv(snakemake.input.fits))
    save(force_rise(factors, snakemake.params.remarks), snakemake.output.figure)
    factors.to_csv(snakemake.output.table, index=False)
