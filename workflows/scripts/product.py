"""Make a figure or tables of a study."""

from pathlib import Path

from bulkwear.workflows.engine.cases import find_case
from bulkwear.workflows.engine.job import project_job
from bulkwear.workflows.report.products import job_of, products_of, simulated_remark, write_product

with project_job(snakemake.log[0]):
    asked = snakemake.params
    case = find_case(asked.case)
    product = products_of(case)[asked.product]
    simulated = simulated_remark(case, Path("results", snakemake.wildcards.study), asked.runs)
    write_product(product, job_of(snakemake.input, asked.told, [*asked.remarks, simulated]), snakemake.output)
