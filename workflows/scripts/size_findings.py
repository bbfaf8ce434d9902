"""Set what a study of particle size found beside the numbers of the source, and tell of its critical scale."""

import pandas as pd

from postproc.reference.size_ratios import PUBLISHED_CRITICAL_SCALE
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.particle_size.published_sizes import (
    beside_the_source,
    critical_sentences,
    packing_beside_the_source,
)
from workflows.cases.sliding_sample.particle_size.wear_by_scale import read_critical_scale
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    files = snakemake.input
    steady, profiles, wear = (read_summary(path) for path in (files.steady, files.profiles, files.wear))
    critical, guidance = read_critical_scale(files.critical), pd.read_csv(files.guidance)
    ratio = guidance["equivalent_radius"].iloc[0]  # of real particles: the pattern of all rows is one
    table = beside_the_source(pd.read_csv(files.published), steady, profiles, critical, ratio)
    packings = [pd.read_csv(path) for path in (files.published_packing, files.container, files.bed)]
    table = pd.concat([table, packing_beside_the_source(*packings)], ignore_index=True)
    table.to_csv(snakemake.output.published, index=False)
    unsteady = int((~steady["steady"]).sum())
    said = critical_sentences(critical, PUBLISHED_CRITICAL_SCALE, wear, unsteady)
    pd.DataFrame({"sentence": said}).to_csv(snakemake.output.sentences, index=False)
