"""Draw how contours are taken from a worn disc."""

from pathlib import Path

import pandas as pd

from postproc.mesh import read_surface
from postproc.plots.style import save
from workflows.cases.pin_on_disc.contours import section_table
from workflows.cases.pin_on_disc.figure_tables import MESH_ANGLE
from workflows.cases.pin_on_disc.plots.disc import contour_extraction
from workflows.cases.pin_on_disc.runs import REFERENCE, coefficient_remark, pin_runs, reference_runs
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    run = runs.set_index("run").loc[next(iter(reference_runs(runs, published, REFERENCE).values()))]
    mesh = read_surface(Path(snakemake.input.design).parent / run.name / "worn_surface.vtu")
    shown = runs[runs["run"] == run.name]
    remarks = [coefficient_remark(shown, published, REFERENCE), *snakemake.params.remarks]
    save(contour_extraction(mesh, run["track_radius_m"], MESH_ANGLE, remarks), snakemake.output.figure)
    section_table(mesh, run["track_radius_m"], [MESH_ANGLE]).to_csv(snakemake.output.table, index=False)
