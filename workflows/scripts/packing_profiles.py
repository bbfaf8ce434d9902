"""Fill and shake a container per particle scale, and draw how its particles are packed."""

from pathlib import Path

import pandas as pd

from postproc.flow.packing import slabs_remark
from postproc.plots.style import save
from workflows.cases.sliding_sample.particle_size.packings import packing_costs, packing_table
from workflows.cases.sliding_sample.particle_size.plots.packing import packing_profiles
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    packing, folder = snakemake.params.packing, Path(snakemake.output.cost).parent
    table = packing_table(snakemake.params.runs, packing, folder)
    packing_costs(snakemake.params.runs, packing, folder).to_csv(snakemake.output.cost, index=False)
    published = pd.read_csv(snakemake.input.published).query("case == 'container'")
    sides = f"container of {packing['width_diameters']:g} median diameters to a side"
    remarks = [sides, f"shaken along {packing['axis']} for {packing['shaking_s']:g} s", slabs_remark(table)]
    save(packing_profiles(table, published, remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
