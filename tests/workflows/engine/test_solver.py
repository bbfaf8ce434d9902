"""How the solver is started."""

from bulkwear.workflows.engine.solver import ranks_here


def test_ranks_are_no_more_than_the_cores_of_this_machine(monkeypatch):
    """Four ranks asked for on two cores are two; a Slurm job has its tasks, whatever cores Snakemake counts."""
    monkeypatch.delenv("SLURM_JOB_ID", raising=False)
    assert ranks_here(4, 2) == 2
    assert ranks_here(1, 2) == 1
    monkeypatch.setenv("SLURM_JOB_ID", "7")
    assert ranks_here(4, 2) == 4
