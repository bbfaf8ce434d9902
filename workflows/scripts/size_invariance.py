"""Draw simulated over theoretical volume against the scale of the pin."""

import pandas as pd

from postproc.plots.style import save
from postproc.tables.published import published_value
from workflows.cases.pin_on_disc.figure_tables import size_cases
from workflows.cases.pin_on_disc.plots import volume as pin_volume
from workflows.cases.pin_on_disc.runs import of_runs, pin_runs
from workflows.cases.pin_on_disc.series import size_invariance
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    table = size_invariance(size_cases(of_runs(runs, snakemake.input.volumes)))
    bound = published_value(published, "size_invariance_difference", "simulation")
    save(pin_volume.size_invariance(table, bound, snakemake.params.remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
