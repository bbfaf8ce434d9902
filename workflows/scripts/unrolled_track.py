"""Draw the unrolled tracks of worn discs as maps of depth."""

from pathlib import Path

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.figure_tables import reference_discs, track_map
from workflows.cases.pin_on_disc.plots.disc import unrolled_track
from workflows.cases.pin_on_disc.runs import CALIBRATED, pin_runs, reference_remark
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    meshes, track = reference_discs(Path(snakemake.input.design).parent, runs, published)
    maps = {scheme: track_map(mesh, track) for scheme, mesh in meshes.items()}
    remarks = [reference_remark(runs, published, CALIBRATED), *snakemake.params.remarks]
    save(unrolled_track(maps, remarks), snakemake.output.figure)
    table = pd.concat([shown.assign(scheme=scheme) for scheme, shown in maps.items()])
    table.to_csv(snakemake.output.table, float_format="%.4g")
