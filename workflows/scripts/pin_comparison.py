"""Compare depth, width and volume with laboratory and thesis."""

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.figure_tables import compared_cases, compared_runs
from workflows.cases.pin_on_disc.plots import volume as pin_volume
from workflows.cases.pin_on_disc.runs import CALIBRATED, of_runs, pin_runs, reference_remark
from workflows.cases.pin_on_disc.series import comparison
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    contours, volumes = (of_runs(runs, files) for files in (snakemake.input.contours, snakemake.input.volumes))
    table = comparison(published, compared_cases(compared_runs(runs, published), contours, volumes, published))
    remarks = [f"beside Yan 2022: {reference_remark(runs, published, CALIBRATED)}", *snakemake.params.remarks]
    save(pin_volume.comparison(table, remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
