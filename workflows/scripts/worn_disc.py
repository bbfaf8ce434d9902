"""Draw the worn discs in three dimensions."""

from pathlib import Path

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.figure_tables import reference_discs
from workflows.cases.pin_on_disc.plots.disc import worn_disc
from workflows.cases.pin_on_disc.runs import CALIBRATED, pin_runs, reference_remark
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    meshes, track = reference_discs(Path(snakemake.input.design).parent, runs, published)
    remarks = [reference_remark(runs, published, CALIBRATED), *snakemake.params.remarks]
    save(worn_disc(meshes, track, remarks), snakemake.output.figure)
