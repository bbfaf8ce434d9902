"""Draw volume against revolutions, with its fits beside the published ones."""

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.plots.volume import wear_volume
from workflows.cases.pin_on_disc.runs import of_runs, pin_runs
from workflows.cases.pin_on_disc.volume import volume_fits
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, fits = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.fits)
    volumes = of_runs(runs, snakemake.input.volumes)
    volumes = volumes[volumes["series"] == "coefficient"]
    save(wear_volume(volumes, fits, snakemake.params.remarks), snakemake.output.figure)
    volumes.to_csv(snakemake.output.table, index=False)
    volume_fits(volumes).to_csv(snakemake.output.fits, index=False)
