"""Draw Archard's and Finnie's volumes."""

from postproc.plots.style import save
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.comparison import law_comparison
from workflows.cases.sliding_sample.plots.bars import wear_law_comparison
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    table = law_comparison(read_summary(snakemake.input[0]))
    save(wear_law_comparison(table, snakemake.params.remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
