"""Draw Archard's and Finnie's volumes."""

from postproc.analysis.comparison import law_comparison, read_summary
from postproc.plots.bars import wear_law_comparison
from postproc.plots.style import save
from workflows.job import job_log

with job_log(snakemake.log[0]):
    table = law_comparison(read_summary(snakemake.input[0]))
    save(wear_law_comparison(table, snakemake.params.remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
