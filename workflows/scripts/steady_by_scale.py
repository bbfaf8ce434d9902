"""Draw relative velocity and wear rate in their steady windows against particle scale."""

import pandas as pd

from postproc.plots.style import save
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.particle_size.plots.wear_by_scale import steady_by_scale as drawn
from workflows.cases.sliding_sample.particle_size.published_sizes import steady_by_scale
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    scales = read_summary(snakemake.input.summary).set_index("run")["particle_scale"].to_dict()
    table = steady_by_scale(read_summary(snakemake.input.steady), scales)
    save(drawn(table, pd.read_csv(snakemake.input.published), snakemake.params.remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
