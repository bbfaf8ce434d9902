"""Draw the forces on the samples: along the travel, or their means where there are many design rows."""

from pathlib import Path

from postproc.plots import curves
from postproc.plots.style import save
from postproc.tables.history import force_history, force_summary
from workflows.cases.sliding_sample.plots import bars
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    table = force_history(snakemake.input.design, [Path(path).parent for path in snakemake.input.wear])
    draw = curves.forces
    if table["row"].nunique() > curves.FEW_ROWS:
        table, draw = force_summary(table), bars.mean_forces
    save(draw(table, snakemake.params.remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
