"""Draw sections of worn discs beside the laboratory's contours."""

from pathlib import Path

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.figure_tables import (
    compared_runs,
    laboratory_boxes,
    laboratory_sections,
    laboratory_segment,
)
from workflows.cases.pin_on_disc.plots.contours import laboratory_contour
from workflows.cases.pin_on_disc.runs import CALIBRATED, pin_runs, reference_remark
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    cases = pd.read_csv(snakemake.input.cases)
    sections = laboratory_sections(Path(snakemake.input.design).parent, compared_runs(runs, published), cases)
    boxes, segment = laboratory_boxes(published), laboratory_segment(published)
    remarks = [f"beside Yan 2022: {reference_remark(runs, published, CALIBRATED)}", *snakemake.params.remarks]
    save(laboratory_contour(sections, boxes, segment, remarks), snakemake.output.figure)
    sections.to_csv(snakemake.output.table, index=False, float_format="%.6g")
