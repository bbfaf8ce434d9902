"""Draw what the runs of the best designs wear against what was predicted of them."""

import pandas as pd

from postproc.analysis.comparison import read_summary
from postproc.analysis.confirmation import check_fidelity, confirmation_remarks, confirmation_table
from postproc.plots import confirmation as figures
from postproc.plots.style import save
from workflows.job import job_log

with job_log(snakemake.log[0]):
    files = snakemake.input
    predictions = pd.read_csv(files.prediction)
    check_fidelity(predictions, snakemake.params.fidelity, files.prediction)
    table = confirmation_table(predictions, read_summary(files.summary), read_summary(files.regimes))
    table.to_csv(snakemake.output.table, index=False)
    remarks = [*snakemake.params.remarks, *confirmation_remarks(table)]
    save(figures.confirmation(table, remarks), snakemake.output.figure)
