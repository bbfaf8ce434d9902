"""Draw depth and width of the groove against the size of the elements."""

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.plots import contours
from workflows.cases.pin_on_disc.runs import REFERENCE, coefficient_remark, pin_runs
from workflows.cases.pin_on_disc.series import mesh_series, mesh_stability
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs = pin_runs(snakemake.input.design)
    series = mesh_series(runs, pd.read_csv(snakemake.input.statistics).drop(columns="scheme"))
    stability = mesh_stability(series)
    published, shown = pd.read_csv(snakemake.input.published), runs[runs["run"].isin(series["run"])]
    said = [f"after revolution {series['revolution'].iloc[0]}", coefficient_remark(shown, published, REFERENCE)]
    remarks = [*said, *snakemake.params.remarks]
    save(contours.mesh_series(series, stability, remarks), snakemake.output.figure)
    series.to_csv(snakemake.output.table, index=False)
    stability.to_csv(snakemake.output.stability, index=False)
