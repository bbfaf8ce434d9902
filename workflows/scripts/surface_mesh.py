"""Build the pristine surface of a run."""

from bulkwear.postproc.mesh import write_surface
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.job import project_job

with project_job(snakemake.log[0]):
    case, of_run = find_case(snakemake.params.case), snakemake.wildcards
    try:
        surface = case.surface_mesh(snakemake.params.geometry)
    except ConfigError as fault:
        raise ConfigError(f"study {of_run.study}, run {of_run.run}: {fault}") from fault
    write_surface(snakemake.output[0], surface)
