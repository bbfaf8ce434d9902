"""Draw one section of every mesh after one revolution."""

from pathlib import Path

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.figure_tables import mesh_sections
from workflows.cases.pin_on_disc.plots.contours import mesh_contours
from workflows.cases.pin_on_disc.runs import REFERENCE, coefficient_remark, pin_runs
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, series = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.series)
    sections = mesh_sections(Path(snakemake.input.design).parent, runs, series)
    shown = runs[runs["run"].isin(series["run"])]
    remarks = [coefficient_remark(shown, pd.read_csv(snakemake.input.published), REFERENCE), *snakemake.params.remarks]
    save(mesh_contours(sections, remarks), snakemake.output.figure)
    sections.to_csv(snakemake.output.table, index=False, float_format="%.6g")
