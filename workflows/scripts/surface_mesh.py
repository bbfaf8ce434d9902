"""Build the pristine surface of a run."""

from bulkwear.postproc.mesh import write_surface
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.job import project_job

with project_job(snakemake.log[0]):
    write_surface(snakemake.output[0], find_case(snakemake.params.case).surface_mesh(snakemake.params.geometry))
