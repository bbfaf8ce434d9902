"""Draw the distribution of depth over the area."""

import pandas as pd

from postproc.plots import curves
from postproc.plots.style import save
from postproc.tables.depths import depth_distribution, depth_quantity
from postproc.tables.history import runs_of
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    shares = depth_distribution(pd.read_csv(snakemake.input.depths, usecols=["run", "depth_um", "area_mm2"]))
    table = runs_of(snakemake.input.design).merge(shares, on="run")
    quantity = depth_quantity(snakemake.params.deformed)
    save(curves.depth_distribution(table, quantity, snakemake.params.remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
