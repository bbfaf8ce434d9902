"""Draw the wear coefficient that makes few revolutions stand for the laboratory's."""

import pandas as pd

from postproc.plots.style import save
from postproc.tables.published import published_value
from postproc.wear.coefficient import laboratory_coefficient
from workflows.cases.pin_on_disc.coefficient import scaling_limits, step_cap_limits
from workflows.cases.pin_on_disc.figure_tables import calibrated, laboratory_volume, only_reference
from workflows.cases.pin_on_disc.plots.volume import calibration
from workflows.cases.pin_on_disc.run_in import run_in_table
from workflows.cases.pin_on_disc.runs import REFERENCE, of_runs, pin_runs, reference_remark
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, published = pin_runs(snakemake.input.design), pd.read_csv(snakemake.input.published)
    volumes = of_runs(runs, snakemake.input.volumes)
    table = calibrated(volumes, pd.read_csv(snakemake.input.fits), published)
    load, distance, revolutions = (
        published_value(published, name, "laboratory") for name in ("load", "sliding_distance", "revolutions")
    )
    statistics = only_reference(pd.read_csv(snakemake.input.statistics), runs, published, REFERENCE)
    limits = scaling_limits(run_in_table(statistics, pd.read_csv(snakemake.input.normality)), revolutions)
    laboratory = laboratory_coefficient(*laboratory_volume(published), load, distance)
    remarks = [f"run-in: {reference_remark(runs, published, REFERENCE)}", *snakemake.params.remarks]
    save(calibration(table, laboratory, revolutions, limits, remarks), snakemake.output.figure)
    limits = limits.merge(step_cap_limits(volumes, laboratory[0]), on="run", how="left")
    table.to_csv(snakemake.output.table, index=False)
    limits.to_csv(snakemake.output.limits, index=False)
