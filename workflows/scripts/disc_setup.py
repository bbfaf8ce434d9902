"""Draw the set-up of the pin on its disc."""

from pathlib import Path

import pandas as pd

from postproc.mesh import read_surface
from postproc.plots.style import save
from workflows.cases.pin_on_disc.plots.disc import disc_setup
from workflows.cases.pin_on_disc.runs import REFERENCE, pin_runs, reference_runs
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    run = runs.set_index("run").loc[next(iter(reference_runs(runs, published, REFERENCE).values()))]
    mesh = read_surface(Path(snakemake.input.design).parent / run.name / "surface.vtu")
    figure = disc_setup(
        mesh, run["track_radius_m"], run["pin_radius_mm"] / 1e3, run["load_n"], snakemake.params.remarks
    )
    save(figure, snakemake.output.figure)
    run.to_frame().T.to_csv(snakemake.output.table, index_label="run")
