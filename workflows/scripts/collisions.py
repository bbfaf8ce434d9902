"""Simulate single collisions at every particle scale, and draw them in units of their size."""

from pathlib import Path

from postproc.plots.style import save
from workflows.cases.sliding_sample.particle_size.collision import dimensionless, spread_over_scales
from workflows.cases.sliding_sample.particle_size.collision_tests import spheres_of
from workflows.cases.sliding_sample.particle_size.packings import COLLISION, collision_tables, collision_tests
from workflows.cases.sliding_sample.particle_size.plots.collision import collisions
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, folder = snakemake.params.runs, Path(snakemake.output.measures).parent
    histories, measures = collision_tables(runs, folder / "collisions")
    spheres = spheres_of(collision_tests(runs)[0])
    forms = spheres.closed_forms(COLLISION["speed_m_per_s"]).items()
    closed = {kind: dimensionless(form, spheres.units(kind)) for kind, form in forms}
    largest = spread_over_scales(measures)["spread"].max()
    figure = collisions(histories, closed, [f"largest difference between scales {100.0 * largest:.1g} %"])
    save(figure, snakemake.output.figure)
    histories.to_csv(snakemake.output.table, index=False, float_format="%.6g")
    measures.to_csv(snakemake.output.measures, index=False)
