"""Draw the relative wear gradient along the travel by regime."""

from pathlib import Path

import pandas as pd

from postproc.plots.style import save
from postproc.tables.history import wear_within_cycles
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.flow_history import published_window
from workflows.cases.sliding_sample.plots.flow import along_travel
from workflows.cases.sliding_sample.screening.regime_groups import gradients_by_group, regime_remarks
from workflows.cases.sliding_sample.steady_table import steady_table
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    regimes = read_summary(snakemake.input.regimes)
    folders = [Path(path).parent for path in snakemake.input.wear]
    table = gradients_by_group(wear_within_cycles(snakemake.input.design, folders), regimes)
    table.to_csv(snakemake.output.table, index=False)
    window = published_window(pd.read_csv(snakemake.input.published), snakemake.params.run_in)
    steady_table(read_summary(snakemake.input.along), table, window).to_csv(snakemake.output.steady, index=False)
    label = "Wear gradient over the largest of all runs (-)"
    remarks = [*snakemake.params.remarks, *regime_remarks(regimes)]
    save(along_travel(table, "relative_gradient", label, window, remarks), snakemake.output.figure)
