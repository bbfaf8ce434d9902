"""Draw the flow over the samples of one of the rows that are shown in detail."""

from pathlib import Path

from postproc.flow.bed import last_snapshot, read_snapshot
from postproc.plots.style import save
from postproc.tables.depths import read_worn_surfaces
from postproc.tables.summary import read_summary, rows_to_show, runs_of_rows
from workflows.cases.sliding_sample.flow_views import flow_views, sample_lines
from workflows.cases.sliding_sample.plots import flow_views as figures
from workflows.cases.sliding_sample.screening.regime_groups import published_rows_in_detail, rows_in_detail
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    summary, place = read_summary(snakemake.input.summary), snakemake.params.place
    rows = rows_to_show(summary)
    if snakemake.input.regimes:
        preferred = published_rows_in_detail(snakemake.params.published_rows)
        rows = rows_in_detail(summary, read_summary(snakemake.input.regimes[0]), preferred)
    shown = runs_of_rows(summary, rows[place : place + 1])
    files = dict(zip(summary["run"], snakemake.input.surfaces, strict=True))
    meshes = read_worn_surfaces(shown, [files[run] for run in shown])
    views = {run: flow_views(read_snapshot(last_snapshot(Path(files[run]).parent)), meshes[run]) for run in shown}
    lines = {run: sample_lines(mesh) for run, mesh in meshes.items()}
    save(figures.flow_views(views, lines, snakemake.params.remarks), snakemake.output.figure)
    figures.flow_views_table(views).to_csv(snakemake.output.table, index=False, float_format="%.6g")
