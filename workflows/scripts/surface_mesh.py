"""Build the pristine surface of a run."""

from postproc.mesh import write_surface
from workflows.cases import CASES
from workflows.job import job_log

with job_log(snakemake.log[0]):
    write_surface(snakemake.output[0], CASES[snakemake.params.case].surface_mesh(snakemake.params.geometry))
