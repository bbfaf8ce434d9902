"""Draw the worn surfaces of a study."""

from postproc.plots.pictures import worn_surface
from postproc.plots.style import save
from postproc.tables.depths import carried_remark, depth_quantity, depth_table, read_worn_surfaces
from postproc.tables.history import runs_of
from workflows.engine.job import job_log

with job_log(snakemake.log[0]):
    runs, deformed = runs_of(snakemake.input.design), snakemake.params.deformed
    meshes = read_worn_surfaces(runs["run"], snakemake.input.surfaces)
    depths = depth_table(meshes, deformed)
    remarks = [*snakemake.params.remarks, carried_remark(meshes, deformed)]
    figure = worn_surface(meshes, runs, deformed, depths, depth_quantity(deformed), remarks)
    save(figure, snakemake.output.figure)
    depths.to_csv(snakemake.output.table, index=False, float_format="%.6g")
