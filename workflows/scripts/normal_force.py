"""Draw the force of the pin revolution by revolution."""

from pathlib import Path

import pandas as pd

from postproc.plots.style import save
from workflows.cases.pin_on_disc.plots.contours import normal_force
from workflows.cases.pin_on_disc.runs import (
    REFERENCE,
    force_boxes,
    pin_runs,
    reference_remark,
    reference_runs,
    window_forces,
)
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    folder, chosen = Path(snakemake.input.design).parent, reference_runs(runs, published, REFERENCE)
    forces = pd.concat(
        [window_forces(f"{folder}/{run}").assign(run=run, scheme=scheme) for scheme, run in chosen.items()]
    )
    loads = runs.set_index("run")["load_n"]
    remarks = [reference_remark(runs, published, REFERENCE), *snakemake.params.remarks]
    save(normal_force(forces, {scheme: loads[run] for scheme, run in chosen.items()}, remarks), snakemake.output.figure)
    force_boxes(forces).to_csv(snakemake.output.table, index=False)
