"""Fill and shake a container per particle scale, and draw how its particles are packed."""

from pathlib import Path

import pandas as pd

from postproc.analysis.packing import slabs_remark
from postproc.plots.packing import packing_profiles
from postproc.plots.style import save
from workflows.job import job_log
from workflows.packings import packing_costs, packing_table

with job_log(snakemake.log[0]):
    packing, folder = snakemake.params.packing, Path(snakemake.output.cost).parent
    table = packing_table(snakemake.params.runs, packing, folder)
    packing_costs(snakemake.params.runs, packing, folder).to_csv(snakemake.output.cost, index=False)
    published = pd.read_csv(snakemake.input.published).query("case == 'container'")
    sides = f"container of {packing['width_diameters']:g} median diameters to a side"
    remarks = [sides, f"shaken along {packing['axis']} for {packing['shaking_s']:g} s", slabs_remark(table)]
    save(packing_profiles(table, published, remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
