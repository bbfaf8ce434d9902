"""Draw the worn discs in three dimensions."""

from pathlib import Path

import pandas as pd

from postproc.analysis.pin_figures import reference_discs
from postproc.analysis.pin_runs import CALIBRATED, pin_runs, reference_remark
from postproc.plots.disc import worn_disc
from postproc.plots.style import save
from workflows.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    meshes, track = reference_discs(Path(snakemake.input.design).parent, runs, published)
    remarks = [reference_remark(runs, published, CALIBRATED), *snakemake.params.remarks]
    save(worn_disc(meshes, track, remarks), snakemake.output.figure)
