"""Draw convex over plain wear against ratios of particle to bump, and write what these let expect."""

import numpy as np
import pandas as pd

from postproc.plots.style import save
from postproc.reference.size_ratios import size_ratios
from workflows.cases.sliding_sample.particle_size.guidance import Particles, Pattern, guidance_table
from workflows.cases.sliding_sample.particle_size.plots.wear_by_scale import wear_against_size_ratios
from workflows.cases.sliding_sample.particle_size.wear_by_scale import published_by_size_ratio, wear_by_size_ratio
from workflows.engine.job import job_log

PUBLISHED_SCALES = np.linspace(1.0, 8.0, 71)  # of the source

with job_log(snakemake.log[0]):
    wear, lines = pd.read_csv(snakemake.input.wear, dtype={"row": str}), pd.read_csv(snakemake.input.published)
    rows = snakemake.params.rows
    patterns = {row: Pattern(**given["pattern"]) for row, given in rows.items()}
    real = Particles(**next(iter(rows.values()))["particles"])
    scales = {row: given["scale"] for row, given in rows.items()}
    ratios = {row: size_ratios(scales[row] * real.median_diameter, *patterns[row].bump) for row in rows}
    table = wear_by_size_ratio(wear, ratios)
    published = published_by_size_ratio(lines, PUBLISHED_SCALES)
    save(wear_against_size_ratios(table, published, snakemake.params.remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
    guidance_table(patterns, real, scales, lines).to_csv(snakemake.output.guidance, index=False)
