"""Draw what the runs of the best designs wear against what was predicted of them."""

import pandas as pd

from postproc.plots.style import save
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.screening.confirmation import (
    check_fidelity,
    confirmation_remarks,
    confirmation_table,
)
from workflows.cases.sliding_sample.screening.plots import confirmation as figures
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    files = snakemake.input
    predictions = pd.read_csv(files.prediction)
    check_fidelity(predictions, snakemake.params.fidelity, files.prediction)
    table = confirmation_table(predictions, read_summary(files.summary), read_summary(files.regimes))
    table.to_csv(snakemake.output.table, index=False)
    remarks = [*snakemake.params.remarks, *confirmation_remarks(table)]
    save(figures.confirmation(table, remarks), snakemake.output.figure)
