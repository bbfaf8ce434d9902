"""Draw wear against particle scale with fitted lines and the critical scale."""

from dataclasses import asdict

import pandas as pd

from postproc.plots.style import save
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.particle_size.plots.wear_by_scale import wear_against_scale
from workflows.cases.sliding_sample.particle_size.wear_by_scale import (
    beside_published,
    critical_scale,
    critical_scale_text,
    wear_by_scale,
    wear_lines,
)
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    wear, published = wear_by_scale(read_summary(snakemake.input.summary)), pd.read_csv(snakemake.input.published)
    critical = critical_scale(wear)
    reference = f"relative to the plain sample at particle scale {wear['reference_scale'].iloc[0]:g}"
    remarks = [*snakemake.params.remarks, reference, critical_scale_text(critical)]
    save(wear_against_scale(wear, published, critical, remarks), snakemake.output.figure)
    wear.to_csv(snakemake.output.table, index=False)
    beside_published(wear_lines(wear), published).to_csv(snakemake.output.lines, index=False)
    told = pd.DataFrame([asdict(critical)] if critical else [], columns=["value", "low", "high", "bounded"])
    told.to_csv(snakemake.output.critical, index=False)
