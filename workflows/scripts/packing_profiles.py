"""Fill and shake a container per particle scale: how its particles are packed, and what that took."""

from pathlib import Path

from bulkwear.workflows.cases.sliding_sample.particle_size.packings import packing_costs, packing_table
from bulkwear.workflows.engine.job import project_job

with project_job(snakemake.log[0]):
    asked = snakemake.params.runs, snakemake.params.packing, Path(snakemake.output.cost).parent
    packing_table(*asked).to_csv(snakemake.output.profiles, index=False)
    packing_costs(*asked).to_csv(snakemake.output.cost, index=False)
