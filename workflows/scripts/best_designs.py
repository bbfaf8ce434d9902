"""Write the best design of each flow regime as a design table, and what is predicted of it."""

from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.screening.confirmation import best_of_regimes, design_of
from workflows.cases.sliding_sample.screening.regression_tables import screen_summary
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    given = snakemake.params
    summary, regimes = read_summary(snakemake.input.summary), read_summary(snakemake.input.regimes)
    study = screen_summary(summary, given.factors)
    found = best_of_regimes(study, summary, regimes, given.factors, given.conditions)
    found.assign(fidelity=given.fidelity).to_csv(snakemake.output.prediction, index=False)
    design_of(found, summary, given.columns).to_csv(snakemake.output.design, index=False)
