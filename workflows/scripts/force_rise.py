"""Draw how the summed normal force rises above the load, and the factors of the volume."""

import pandas as pd

from postproc.analysis.pin_volume import excess_factors
from postproc.plots.pin_volume import force_rise
from postproc.plots.style import save
from workflows.job import job_log

with job_log(snakemake.log[0]):
    factors = excess_factors(pd.read_csv(snakemake.input.volumes), pd.read_csv(snakemake.input.fits))
    save(force_rise(factors, snakemake.params.remarks), snakemake.output.figure)
    factors.to_csv(snakemake.output.table, index=False)
