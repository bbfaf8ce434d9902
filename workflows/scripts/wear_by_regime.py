"""Draw the relative wear of all runs by regime."""

from postproc.analysis.comparison import read_summary
from postproc.analysis.regime_groups import regime_remarks, wear_by_group
from postproc.plots.regimes import wear_by_regime
from postproc.plots.style import save
from workflows.job import job_log

with job_log(snakemake.log[0]):
    regimes = read_summary(snakemake.input.regimes)
    table = wear_by_group(read_summary(snakemake.input.summary), regimes)
    table.to_csv(snakemake.output.table, index=False)
    remarks = [*snakemake.params.remarks, *regime_remarks(regimes)]
    save(wear_by_regime(table, remarks), snakemake.output.figure)
