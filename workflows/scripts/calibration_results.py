"""Draw the figures of a calibration, and write its statements and the materials file that other studies can use."""

from pathlib import Path

import pandas as pd

from workflows.cases.calibration.tables import calibrated_materials, draw_all, read_calibrated
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    files, told = snakemake.input, snakemake.params
    folder = Path(snakemake.output.summary).parent
    done = read_calibrated(told.run, Path(files.measured), Path(files.pairs), folder)
    tables = [pd.read_csv(path) for path in (files.looks, files.sizes, files.sizes_before)]
    draw_all(done, *tables, told.remarks)
    done.statements.to_csv(snakemake.output.summary, index=False, float_format="%.6g")
    Path(snakemake.output.materials).write_text(calibrated_materials(done, told.materials, told.study))
