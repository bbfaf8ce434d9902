"""Draw the bed over the samples of the rows that are shown in detail."""

from pathlib import Path

from postproc.flow.bed import shown_particles
from postproc.plots.pictures import bed, bed_table
from postproc.plots.style import save
from postproc.tables.depths import read_worn_surfaces
from postproc.tables.summary import read_summary, rows_to_show, runs_of_rows
from workflows.cases.sliding_sample.page import ROWS_IN_DETAIL
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    summary = read_summary(snakemake.input.summary)
    shown = runs_of_rows(summary, rows_to_show(summary, ROWS_IN_DETAIL))
    files = dict(zip(summary["run"], snakemake.input.surfaces, strict=True))
    meshes = read_worn_surfaces(shown, [files[run] for run in shown])
    cuts = {run: shown_particles(Path(files[run]).parent, meshes[run]) for run in shown}
    save(bed(cuts, meshes, snakemake.params.remarks), snakemake.output.figure)
    bed_table(cuts).to_csv(snakemake.output.table, index=False, float_format="%.6g")
