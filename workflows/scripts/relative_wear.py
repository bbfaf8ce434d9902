"""Draw convex over plain wear."""

import pandas as pd

from postproc.plots.style import save
from postproc.tables.summary import read_history, read_summary
from workflows.cases.sliding_sample.comparison import relative_wear_table
from workflows.cases.sliding_sample.plots.bars import relative_wear
from workflows.cases.sliding_sample.replicates import by_setting, replicate_remark
from workflows.cases.sliding_sample.screening.regime_groups import published_relative_wear
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    given = snakemake.params
    summary, history = read_summary(snakemake.input.summary), read_history(snakemake.input.history)
    table = by_setting(relative_wear_table(summary, history, given.size_ratios), given.settings)
    published = published_relative_wear(pd.read_csv(snakemake.input.published), given.published_rows)
    figure = relative_wear(table, published, [*given.remarks, replicate_remark(table)])
    save(figure, snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
