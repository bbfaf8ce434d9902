"""Draw sections at eight angles after the last revolutions."""

from pathlib import Path

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.figure_tables import example_sections
from workflows.cases.pin_on_disc.plots.contours import contour_examples
from workflows.cases.pin_on_disc.runs import REFERENCE, of_runs, pin_runs, reference_remark, reference_runs
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    chosen = runs[runs["run"].isin(reference_runs(runs, published, REFERENCE).values())]
    sections = example_sections(Path(snakemake.input.design).parent, chosen, of_runs(runs, snakemake.input.contours))
    remarks = [reference_remark(runs, published, REFERENCE), *snakemake.params.remarks]
    save(contour_examples(sections, remarks), snakemake.output.figure)
    sections.to_csv(snakemake.output.table, index=False, float_format="%.6g")
