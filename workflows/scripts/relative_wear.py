"""Draw convex over plain wear."""

import pandas as pd

from postproc.analysis.comparison import read_history, read_summary, relative_wear_table
from postproc.analysis.regime_groups import published_relative_wear
from postproc.analysis.replicates import by_setting, replicate_remark
from postproc.plots.bars import relative_wear
from postproc.plots.style import save
from workflows.job import job_log

with job_log(snakemake.log[0]):
    given = snakemake.params
    summary, history = read_summary(snakemake.input.summary), read_history(snakemake.input.history)
    table = by_setting(relative_wear_table(summary, history, given.size_ratios), given.settings)
    published = published_relative_wear(pd.read_csv(snakemake.input.published), given.published_rows)
    figure = relative_wear(table, published, [*given.remarks, replicate_remark(table)])
    save(figure, snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
