"""Draw the run-in: contours revolution by revolution and their normality."""

import pandas as pd

from postproc.analysis.pin_figures import only_reference, run_in_words, statistics_of
from postproc.analysis.pin_runs import of_runs, pin_runs
from postproc.plots.contours import run_in
from postproc.plots.style import save
from workflows.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    statistics = statistics_of(runs, of_runs(runs, snakemake.input.contours))
    statistics.to_csv(snakemake.output.table, index=False)
    normality, shown = pd.read_csv(snakemake.input.normality), only_reference(statistics, runs, published)
    figure = run_in(shown, normality, run_in_words(shown, normality), snakemake.params.remarks)
    save(figure, snakemake.output.figure)
