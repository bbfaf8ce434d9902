"""Draw the velocity over the samples round a circle of layers, a curve per particle scale."""

import pandas as pd

from postproc.analysis.comparison import read_summary
from postproc.plots.particle_size import spider_charts
from postproc.plots.style import save
from workflows.job import job_log

LABELS = ("velocity with the sample (m/s)", "height of the layer (mm)")

with job_log(snakemake.log[0]):
    scales = read_summary(snakemake.input.summary).set_index("run")["particle_scale"]
    profiles = pd.read_csv(snakemake.input.profiles, dtype={"run": str, "row": str}).query("zone == 'central'")
    table = profiles.assign(particle_scale=profiles["run"].map(scales))
    save(
        spider_charts(table, "velocity_m_per_s", "height_mm", LABELS, snakemake.params.remarks), snakemake.output.figure
    )
    table.to_csv(snakemake.output.table, index=False)
