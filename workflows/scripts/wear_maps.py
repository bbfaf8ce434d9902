"""Draw the worn surfaces of the smallest and the largest particle scale side by side."""

from postproc.analysis.comparison import read_summary
from postproc.analysis.depth import carried_remark, depth_quantity, depth_table, read_worn_surfaces
from postproc.analysis.particle_size import smallest_and_largest
from postproc.plots.pictures import wear_maps
from postproc.plots.style import save
from workflows.job import job_log

with job_log(snakemake.log[0]):
    summary, deformed = read_summary(snakemake.input.summary), snakemake.params.deformed
    every = dict(zip(summary["run"], snakemake.input.surfaces, strict=True))
    runs = smallest_and_largest(summary)
    meshes = read_worn_surfaces(runs["run"], [every[run] for run in runs["run"]])
    depths = depth_table(meshes, deformed)
    remarks = [*snakemake.params.remarks, carried_remark(meshes, deformed)]
    save(wear_maps(meshes, runs, deformed, depths, depth_quantity(deformed), remarks), snakemake.output.figure)
    depths.to_csv(snakemake.output.table, index=False, float_format="%.6g")
