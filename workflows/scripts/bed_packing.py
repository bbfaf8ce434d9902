"""Count contacts in the beds of plain runs before and after the sample passed, and draw them by particle scale."""

from pathlib import Path

import pandas as pd

from postproc.plots.style import save
from workflows.cases.sliding_sample.particle_size.packings import bed_packing_table
from workflows.cases.sliding_sample.particle_size.plots.packing import bed_packing
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    files, given = snakemake.input, snakemake.params
    folders = {run: Path(path).parent for run, path in zip(given.runs, files.wear, strict=True)}
    places = zip(map(Path, files.beds), given.floors, strict=True)
    beds = dict(zip(given.runs, places, strict=True))
    folder = Path(snakemake.output.table).parents[1] / "particle_size" / "beds"
    table = bed_packing_table(given.runs, folders, beds, folder)
    published = pd.read_csv(files.published).query("case == 'bed'")
    save(bed_packing(table, published, given.remarks), snakemake.output.figure)
    table.to_csv(snakemake.output.table, index=False)
