"""Draw the relative wear of all runs by regime."""

from postproc.plots.style import save
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.replicates import replicate_remark, with_intervals
from workflows.cases.sliding_sample.screening.plots.regimes import wear_by_regime
from workflows.cases.sliding_sample.screening.regime_groups import regime_remarks, wear_by_group, with_wear_rates
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    regimes = read_summary(snakemake.input.regimes)
    summary = read_summary(snakemake.input.summary)
    runs = with_wear_rates(wear_by_group(summary, regimes), summary, snakemake.params.beds)
    table = with_intervals(runs, snakemake.params.settings)
    table.to_csv(snakemake.output.table, index=False)
    remarks = [*snakemake.params.remarks, *regime_remarks(regimes), replicate_remark(table)]
    save(wear_by_regime(table, remarks), snakemake.output.figure)
