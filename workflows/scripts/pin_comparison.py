"""Compare depth, width and volume with laboratory and thesis."""

import pandas as pd

from postproc.analysis.pin_figures import compared_cases, compared_runs
from postproc.analysis.pin_runs import CALIBRATED, of_runs, pin_runs, reference_remark
from postproc.analysis.pin_series import comparison
from postproc.plots import pin_volume
from postproc.plots.style import save
from workflows.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    contours, volumes = (of_runs(runs, files) for files in (snakemake.input.contours, snakemake.input.volumes))
    table = comparison(published, compared_cases(compared_runs(runs, published), contours, volumes, published))
    remarks = [f"beside Yan 2022: {reference_remark(runs, published, CALIBRATED)}", *snakemake.params.remarks]
    save(pin_volume.comparison(table, remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
