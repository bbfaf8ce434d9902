"""How many ranks of the solver a job starts."""

import os


def ranks_to_start(tasks: int, threads: int, submitted: int) -> int:
    """Return the ranks that a job starts: its tasks where it is a job of Slurm's, else no more than the cores it was
    given. Where Snakemake was called within an allocation (salloc, sbatch) Slurm's variables are there, and its jobs
    are none of Slurm's.

    submitted: 1 where a cluster's job runs Snakemake, 0 where it was called
    """
    return tasks if submitted and "SLURM_JOB_ID" in os.environ else min(tasks, threads)
