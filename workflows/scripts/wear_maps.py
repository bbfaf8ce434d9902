"""Draw the worn surfaces of the smallest and the largest particle scale side by side."""

from postproc.plots.pictures import wear_maps
from postproc.plots.style import save
from postproc.tables.depths import carried_remark, depth_quantity, depth_table, read_worn_surfaces
from postproc.tables.summary import read_summary
from workflows.cases.sliding_sample.particle_size.wear_by_scale import smallest_and_largest
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    summary, deformed = read_summary(snakemake.input.summary), snakemake.params.deformed
    every = dict(zip(summary["run"], snakemake.input.surfaces, strict=True))
    runs = smallest_and_largest(summary)
    meshes = read_worn_surfaces(runs["run"], [every[run] for run in runs["run"]])
    depths = depth_table(meshes, deformed)
    remarks = [*snakemake.params.remarks, carried_remark(meshes, deformed)]
    save(wear_maps(meshes, runs, deformed, depths, depth_quantity(deformed), remarks), snakemake.output.figure)
    depths.to_csv(snakemake.output.table, index=False, float_format="%.6g")
