"""Bin the motion of the bed over every sample along its travel, and draw its relative velocity by regime."""

from pathlib import Path

import pandas as pd

from postproc.plots.style import save
from postproc.tables.history import runs_of
from workflows.cases.sliding_sample.flow_history import RunFlow, flow_tables, published_window
from workflows.cases.sliding_sample.plots.flow import along_travel
from workflows.cases.sliding_sample.screening.regime_groups import regime_remarks
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    names = runs_of(snakemake.input.design)
    folders = dict(zip(names["run"], [Path(path).parent for path in snakemake.input.wear], strict=True))
    runs = {run: RunFlow(**values) for run, values in snakemake.params.runs.items()}
    bins, along, regimes = flow_tables(folders, runs, names)
    bins.to_csv(snakemake.output.bins, index=False, float_format="%.6g")
    regimes.to_csv(snakemake.output.regimes, index=False)
    along.to_csv(snakemake.output.table, index=False, float_format="%.6g")
    label = "Relative velocity of the particles (%)"
    published = pd.read_csv(snakemake.input.published)
    window = published_window(published, snakemake.params.run_in)
    lines = published[published["quantity"] == "relative_velocity"] if "of" in published else None
    remarks = [*snakemake.params.remarks, *regime_remarks(regimes)]
    figure = along_travel(along, "relative_velocity_percent", label, window, remarks, lines)
    save(figure, snakemake.output.figure)
