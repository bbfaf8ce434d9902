"""Runs of benchmarks: which failures are kept as an answer, and what is taken for simulated."""

from dataclasses import replace

import pytest

from benchmarks.runs import attempted, failure_file, is_simulated, shared_chain
from benchmarks.stiffness import CASE, MODULUS, ROW, STUDY, with_derived
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine import state
from bulkwear.workflows.engine.inputs import inputs_digest
from bulkwear.workflows.engine.solver import SolverCrashedError, SolverError, SolverStoppedError


def raising(error):
    def task():
        raise error

    return task


@pytest.mark.parametrize("error", [SolverError("lost atoms"), SolverCrashedError("SIGSEGV"), ValueError("no bed")])
def test_a_simulation_that_fails_by_itself_is_not_tried_again(tmp_path, error):
    failed = tmp_path / "failed.txt"
    attempted(raising(error), failed, (ValueError,))
    assert failed.read_text() == str(error)
    attempted(lambda: pytest.fail("failed before"), failed)


def test_one_that_the_machine_ended_is_tried_again(tmp_path):
    """Memory, disk and a kill tell nothing of what is simulated."""
    failed, tried = tmp_path / "failed.txt", []
    with pytest.raises(SolverStoppedError):
        attempted(raising(SolverStoppedError("the disk is full")), failed)
    attempted(lambda: tried.append(1), failed)
    assert tried and not failed.exists()


@pytest.fixture
def chain_at(tmp_path):
    """A run's chain in a folder, of a modulus."""
    study = load_study(STUDY, overrides=CASE)

    def chain(modulus):
        run = with_derived(study.run(f"{ROW}_plain"), modulus, 7)
        (bed,) = study.case.beds([run])[0].values()
        return shared_chain("run", tmp_path, study.case, run, bed)

    return chain


def test_only_what_was_simulated_from_these_settings_counts(chain_at):
    """In a folder of the same name a run of another modulus is none, nor is its failure."""
    chain = chain_at(MODULUS)
    for file in (chain.surface, chain.bed_restart, chain.folder / "wear.csv"):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("made")
    assert not is_simulated(chain)
    with state.working_folder(chain.folder, 0) as folder:
        state.write_state(folder, inputs_digest(chain), (), {})
    assert is_simulated(chain)
    other = replace(chain_at(0.1 * MODULUS), bed_restart=chain.bed_restart)
    assert other.folder == chain.folder and not is_simulated(other)
    assert failure_file(other) != failure_file(chain)


def test_beds_and_surfaces_of_other_settings_lie_elsewhere(chain_at):
    one, other = chain_at(MODULUS), chain_at(0.1 * MODULUS)
    assert one.bed_restart != other.bed_restart and one.surface == other.surface
