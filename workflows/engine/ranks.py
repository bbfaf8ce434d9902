"""How many ranks of the solver a job starts."""

from bulkwear.workflows.engine.solver import ranks_here


def ranks_to_start(tasks: int, threads: int, submitted: int) -> int:
    """Return the ranks that a job starts. Where Snakemake was called within an allocation (salloc, sbatch) they are no
    more than the cores that it gives the job, though Slurm's variables are there.

    submitted: 1 where a cluster's job runs Snakemake, 0 where it was called
    """
    return ranks_here(tasks, threads) if submitted else min(tasks, threads)
