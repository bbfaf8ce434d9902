"""Write the summary of a study: one row per run."""

from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.job import project_job

with project_job(snakemake.log[0]):
    files = snakemake.input
    table = find_case(snakemake.params.case).summary(files.design, files.wear, files.pristine, files.worn)
    table.to_csv(snakemake.output[0], index=False)
