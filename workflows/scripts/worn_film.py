"""Film how a run of the row that is shown in detail wears, cycle by cycle."""

from pathlib import Path

import pandas as pd

from postproc.plots.film import film_pictures, save_film
from postproc.tables.depths import depth_quantity
from postproc.tables.film import film_frames, film_run, film_surfaces, frame_table
from postproc.tables.summary import read_summary
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    summary = read_summary(snakemake.input.summary)
    run = film_run(summary)
    wear_file = Path(dict(zip(summary["run"], snakemake.input.wear, strict=True))[run])
    frames = film_frames(pd.read_csv(wear_file))
    surfaces = film_surfaces(wear_file.parent, frames)
    table = frame_table(frames, surfaces)
    pictures = film_pictures(run, surfaces, table, depth_quantity(True), snakemake.params.remarks)
    save_film(pictures, snakemake.output.figure)
    table.assign(run=run).to_csv(snakemake.output.table, index=False)
