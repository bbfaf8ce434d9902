"""Draw the normal force on all samples by regime."""

from pathlib import Path

from postproc.plots.style import save
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.replicates import mean_of_replicates
from workflows.cases.sliding_sample.screening.plots.regimes import normal_force_by_regime
from workflows.cases.sliding_sample.screening.regime_groups import force_by_group, force_remarks, regime_remarks
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    files = snakemake.input
    regimes = read_summary(files.regimes)
    runs = force_by_group(read_summary(files.summary), [Path(path).parent for path in files.wear], regimes)
    table = mean_of_replicates(runs, snakemake.params.settings)
    table.to_csv(snakemake.output.table, index=False)
    remarks = [*snakemake.params.remarks, *regime_remarks(regimes), *force_remarks(table)]
    save(normal_force_by_regime(table, remarks), snakemake.output.figure)
