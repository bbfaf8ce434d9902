"""Draw depth and width of the groove against the size of the elements."""

import pandas as pd

from postproc.analysis.pin_runs import pin_runs
from postproc.analysis.pin_series import mesh_series, mesh_stability
from postproc.plots import contours
from postproc.plots.style import save
from workflows.job import job_log

with job_log(snakemake.log[0]):
    runs = pin_runs(snakemake.input.design)
    series = mesh_series(runs, pd.read_csv(snakemake.input.statistics).drop(columns="scheme"))
    stability = mesh_stability(series)
    remarks = [f"after revolution {series['revolution'].iloc[0]}", *snakemake.params.remarks]
    save(contours.mesh_series(series, stability, remarks), snakemake.output.figure)
    series.to_csv(snakemake.output.table, index=False)
    stability.to_csv(snakemake.output.stability, index=False)
