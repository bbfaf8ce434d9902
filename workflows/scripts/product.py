"""Make a figure or tables of a study."""

from bulkwear.workflows.report.figure_process import hand_over

asked = snakemake.params
hand_over(
    snakemake.log[0],
    {
        "study": snakemake.wildcards.study,
        "case": asked.case,
        "name": asked.product,
        "files": {name: paths if isinstance(paths, str) else list(paths) for name, paths in snakemake.input.items()},
        "told": asked.told,
        "remarks": asked.remarks,
        "runs": asked.runs,
        "outputs": dict(snakemake.output.items()),
    },
)
