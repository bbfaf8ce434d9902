"""Draw the motion of the bed by layers over the rows that are shown in detail; tables of all rows beside them."""

import pandas as pd

from postproc.plots.style import save
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.flow_history import row_profiles
from workflows.cases.sliding_sample.plots.flow import angular_velocity_profiles, velocity_profiles
from workflows.cases.sliding_sample.screening.regime_groups import (
    of_published_rows,
    published_rows_in_detail,
    rows_in_detail,
)
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    files, drawn = snakemake.input, snakemake.output
    summary, along = read_summary(files.summary), read_summary(files.along)
    bins = pd.read_csv(files.bins, dtype={"run": str})
    every = row_profiles(bins, along, snakemake.params.velocities, list(dict.fromkeys(summary["row"])))
    same = snakemake.params.published_rows
    published = of_published_rows(pd.read_csv(files.published), same)
    rows = rows_in_detail(summary, read_summary(files.regimes), published_rows_in_detail(same))
    table = pd.concat([every[every["row"] == row] for row in rows], ignore_index=True)
    every.to_csv(drawn.every_row, index=False, float_format="%.6g")
    for figure, path in ((velocity_profiles, "velocity"), (angular_velocity_profiles, "angular")):
        save(figure(table, published, snakemake.params.remarks), drawn[path])
        table.to_csv(drawn[f"{path}_table"], index=False, float_format="%.6g")
