"""Write the summary of a study: one row per run."""

from workflows.cases import CASES
from workflows.job import job_log

with job_log(snakemake.log[0]):
    files = snakemake.input
    table = CASES[snakemake.params.case].summary(files.design, files.wear, files.pristine, files.worn)
    table.to_csv(snakemake.output[0], index=False)
