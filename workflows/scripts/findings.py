"""Write which findings of the source the study confirms, and its rows beside what the source tells of them."""

import pandas as pd

from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.screening.finding_tests import findings_table
from workflows.cases.sliding_sample.screening.findings import gather, runs_beside_source
from workflows.cases.sliding_sample.screening.published_model import published_wear_by_row
from workflows.cases.sliding_sample.screening.regression_tables import screen_summary
from workflows.engine.job import job_log

OF_RUNS = ("summary", "regimes", "profiles", "gradients", "steady")  # tables whose names are text

with job_log(snakemake.log[0]):
    given, files = snakemake.params, snakemake.input
    tables = {name: (read_summary if name in OF_RUNS else pd.read_csv)(path) for name, path in files.items() if path}
    study = screen_summary(tables["summary"], given.factors) if given.factors else None
    evidence = gather(tables, study, given.run_in, given.settings, given.published_rows)
    told = tables["published_regimes"]
    found = findings_table(evidence, tables["published_findings"], told)
    found.to_csv(snakemake.output.findings, index=False)
    model = published_wear_by_row(tables["published_design"], tables["published_coefficients"], given.factors)
    runs_beside_source(evidence, told, model).to_csv(snakemake.output.runs, index=False)
