"""Draw a component of the velocity over the samples round a circle of layers, a curve per particle scale."""

import pandas as pd

from postproc.plots.style import save
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.particle_size.plots.wear_by_scale import spider_charts
from workflows.cases.sliding_sample.particle_size.wear_by_scale import over_the_sample, velocity_bounds
from workflows.engine.job import job_log

NAMES = {"velocity_m_per_s": "velocity with the sample", "upward_m_per_s": "velocity upwards"}
NAMES |= {"sideways_m_per_s": "velocity sideways"}

with job_log(snakemake.log[0]):
    component = snakemake.params.component
    scales = read_summary(snakemake.input.summary).set_index("run")["particle_scale"]
    table = over_the_sample(read_summary(snakemake.input.profiles), scales)
    bounds = velocity_bounds(pd.read_csv(snakemake.input.published), table) if component == "velocity_m_per_s" else None
    labels = (f"{NAMES[component]} (m/s)", "height of the layer (mm)")
    figure = spider_charts(table, component, "height_mm", labels, snakemake.params.remarks, bounds)
    save(figure, snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
