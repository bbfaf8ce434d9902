"""Draw what volumes above alpha F L are made of."""

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.figure_tables import groove_remark, shown_factors
from workflows.cases.pin_on_disc.plots.volume import excess_volume
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    published = pd.read_csv(snakemake.input.published)
    shown = shown_factors(pd.read_csv(snakemake.input.factors), published)
    remarks = [groove_remark(published), *snakemake.params.remarks]
    save(excess_volume(shown, remarks), snakemake.output.figure)
    shown.to_csv(snakemake.output.table, index=False)
