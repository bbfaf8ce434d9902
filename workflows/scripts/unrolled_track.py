"""Draw the unrolled tracks of worn discs as maps of depth."""

from pathlib import Path

import pandas as pd

from postproc.analysis.pin_figures import reference_discs, track_map
from postproc.analysis.pin_runs import CALIBRATED, pin_runs, reference_remark
from postproc.plots.disc import unrolled_track
from postproc.plots.style import save
from workflows.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    meshes, track = reference_discs(Path(snakemake.input.design).parent, runs, published)
    maps = {scheme: track_map(mesh, track) for scheme, mesh in meshes.items()}
    remarks = [reference_remark(runs, published, CALIBRATED), *snakemake.params.remarks]
    save(unrolled_track(maps, remarks), snakemake.output.figure)
    table = pd.concat([shown.assign(scheme=scheme) for scheme, shown in maps.items()])
    table.to_csv(snakemake.output.table, float_format="%.4g")
