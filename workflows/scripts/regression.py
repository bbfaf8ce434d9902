"""Regress the wear of a study on its factors: tables, and the four figures that draw them."""

from pathlib import Path

import pandas as pd

from postproc.plots.style import save
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.screening.plots.regression import DRAWN, regression_figures
from workflows.cases.sliding_sample.screening.regression_tables import regression_tables, screen_summary
from workflows.cases.sliding_sample.screening.regression_warnings import warnings_for_figures
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    study = screen_summary(read_summary(snakemake.input.summary), snakemake.params.factors)
    published = pd.read_csv(snakemake.input.published)
    tables = regression_tables(study, published, pd.read_csv(snakemake.input.published_contours))
    for name, table in tables.items():
        table.to_csv(snakemake.output[name], index=False)
    remarks = [*snakemake.params.remarks, *warnings_for_figures(study)]
    figures = regression_figures(study, tables, published, snakemake.params.labels, remarks)
    for name, figure in figures.items():
        save(figure, snakemake.output[f"figure_{name}"])
        path = Path(snakemake.output[f"figure_{name}"]).with_suffix(".csv")
        tables[DRAWN[name]].to_csv(path, index=False)
