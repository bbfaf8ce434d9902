"""Draw the run-in: contours revolution by revolution and their normality."""

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.figure_tables import only_reference, run_in_words, statistics_of
from workflows.cases.pin_on_disc.plots.contours import run_in
from workflows.cases.pin_on_disc.runs import REFERENCE, of_runs, pin_runs, reference_remark
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    statistics = statistics_of(runs, of_runs(runs, snakemake.input.contours))
    statistics.to_csv(snakemake.output.table, index=False)
    normality = pd.read_csv(snakemake.input.normality)
    shown = only_reference(statistics, runs, published, REFERENCE)
    remarks = [reference_remark(runs, published, REFERENCE), *snakemake.params.remarks]
    figure = run_in(shown, normality, run_in_words(shown, normality), remarks)
    save(figure, snakemake.output.figure)
