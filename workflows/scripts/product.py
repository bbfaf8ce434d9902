"""Make a figure or tables of a study."""

from bulkwear.workflows.engine.case import find_case
from bulkwear.workflows.engine.job import project_job
from bulkwear.workflows.report.products import job_of, products_of, write_product

with project_job(snakemake.log[0]):
    asked = snakemake.params
    product = products_of(find_case(asked.case))[asked.product]
    write_product(product, job_of(snakemake.input, asked.told, asked.remarks), snakemake.output)
