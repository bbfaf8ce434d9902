"""Build the pristine surface of a run."""

from postproc.mesh import write_surface
from workflows.geometry import sample_surface
from workflows.job import job_log

with job_log(snakemake.log[0]):
    write_surface(snakemake.output[0], sample_surface(snakemake.params.sample, snakemake.params.pattern))
