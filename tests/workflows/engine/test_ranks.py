"""The ranks that a job starts."""

from bulkwear.workflows.engine.ranks import ranks_to_start


def test_only_a_submitted_job_has_the_tasks_of_slurm(monkeypatch):
    """Four ranks asked for on two cores are two, also in an allocation in which Snakemake was called."""
    monkeypatch.setenv("SLURM_JOB_ID", "7")
    assert ranks_to_start(4, 2, submitted=0) == 2
    assert ranks_to_start(4, 2, submitted=1) == 4
    monkeypatch.delenv("SLURM_JOB_ID")
    assert ranks_to_start(4, 2, submitted=1) == 2, "another cluster"
    assert ranks_to_start(1, 2, submitted=0) == 1
