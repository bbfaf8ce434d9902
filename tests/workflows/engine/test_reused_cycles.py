"""Finished cycles are used again, unless their inputs or their files have changed."""

import os
from dataclasses import replace

import pandas as pd
import pytest

from bulkwear.workflows.engine import cycles, state
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.inputs import inputs_digest, run_digest
from bulkwear.workflows.engine.solver import SEARCHES
from tests.support.tiny import tiny_study
from tests.support.tiny_runs import copy_cycles, twin, wear_cycles

pytestmark = pytest.mark.solver


def test_a_finished_run_is_not_done_again(finished):
    """Started once more, a finished run only writes its tables."""
    before = {path: path.stat().st_mtime_ns for path in finished.folder.glob("cycle_???/*")}
    cycles.run_chain(finished)
    assert {path: path.stat().st_mtime_ns for path in finished.folder.glob("cycle_???/*")} == before


def test_the_same_simulation_is_run_once(finished, tmp_path, monkeypatch):
    """A run with the inputs of a finished one gets its tables and its surface without the solver, at no cost."""
    monkeypatch.setattr(cycles, "run_deck", lambda *given, **named: pytest.fail("the solver was called"))
    chain = replace(twin(finished, tmp_path), name="R1_convex", same_as=finished.folder)
    cycles.run_chain(chain)
    for name in ("wear.csv", "worn_surface.vtu"):
        assert (chain.folder / name).read_bytes() == (finished.folder / name).read_bytes()
    cost, paid = (pd.read_csv(folder / "cost.csv") for folder in (chain.folder, finished.folder))
    assert not cost[["solver_s", "other_s", cycles.OWN_TIME]].any(axis=None)
    assert paid["solver_s"].all() and cost["particles"].equals(paid["particles"])


def test_changed_inputs_are_not_reused_and_nothing_is_lost(finished, tmp_path):
    """Another wear coefficient: cycles are done again, the old ones are kept and come back with the old inputs."""
    chain = twin(finished, tmp_path)
    copy_cycles(finished, chain)
    doubled = replace(
        chain,
        parameters={**chain.parameters, "wear": {**chain.parameters["wear"], "gap_closing_fraction": 0.1}},
    )
    cycles.run_chain(doubled)
    assert (chain.folder / "wear.csv").read_bytes() != (finished.folder / "wear.csv").read_bytes()
    assert len(list(chain.folder.glob("superseded/*/cycle_???"))) == wear_cycles(chain) + 1
    old = (state.cycle_folder(finished.folder, 1) / "log.liggghts").read_bytes()
    cycles.run_chain(chain)
    assert (chain.folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()
    assert (state.cycle_folder(chain.folder, 1) / "log.liggghts").read_bytes() == old


def test_a_damaged_cycle_is_done_again(finished, tmp_path):
    """A restart file that changed after its state was written does not count: its cycle is simulated again."""
    chain = twin(finished, tmp_path)
    copy_cycles(finished, chain)
    inputs = inputs_digest(chain)
    assert state.finished_cycles(chain.folder, inputs) == wear_cycles(chain) + 1
    with open(state.cycle_folder(chain.folder, 1) / "run.restart", "ab") as restart:
        restart.write(b"damage")
    assert state.finished_cycles(chain.folder, inputs) == 1
    cycles.run_chain(chain)
    assert state.finished_cycles(chain.folder, inputs) == wear_cycles(chain) + 1
    assert (chain.folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()


def test_a_cycle_with_a_cut_restart_file_is_done_again(finished, tmp_path, capfd):
    """A restart file that was cut by a full disk, under a state that says it is as it was: the run falls back by
    itself, and says so."""
    chain = twin(finished, tmp_path)
    copy_cycles(finished, chain)
    folder = state.cycle_folder(chain.folder, wear_cycles(chain))
    record = state.read_state(chain.folder, wear_cycles(chain))
    os.truncate(folder / "run.restart", 4096)
    state.write_state(folder, record.pop("inputs"), tuple(record.pop("files")), record)
    cycles.run_chain(chain)
    said = capfd.readouterr().err
    assert f"{folder / 'run.restart'}: the restart file of 4096 bytes is not whole" in said
    assert f"{folder.name} is made again" in said
    assert (chain.folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()


@pytest.mark.parametrize(
    ("kept", "finished_cycles", "there"),
    [("few", 4, {0, 2, 3}), ("few", 24, {0, 10, 20, 22, 23}), ("few", 2, {0, 1}), ("all", 24, set(range(24)))],
)
def test_restart_files_that_no_resume_needs_go(tmp_path, kept, finished_cycles, there):
    """Those of cycle 0, of every tenth cycle and of the last two stay, or all; states of the others do without."""
    study = tiny_study(solver={"kept_restarts": kept})
    chain = Chain("R9_convex", tmp_path, study.case, study.run("R9_convex").parameters, tmp_path / "surface.vtu")
    for cycle in range(finished_cycles):
        folder = state.cycle_folder(tmp_path, cycle)
        folder.mkdir()
        for name in ("run.restart", "surface.vtu"):
            (folder / name).write_text(name)
        state.write_state(folder, "same", ("run.restart", "surface.vtu"), {})
    for count in range(1, finished_cycles + 1):
        cycles.drop_restarts(chain, count)
    folders = {cycle: state.cycle_folder(tmp_path, cycle) for cycle in range(finished_cycles)}
    assert {cycle for cycle, folder in folders.items() if (folder / "run.restart").exists()} == there
    assert state.finished_cycles(tmp_path, "same", ("run.restart", "surface.vtu")) == finished_cycles
    (folders[finished_cycles - 1] / "run.restart").write_text("damage")
    assert state.finished_cycles(tmp_path, "same", ("run.restart", "surface.vtu")) == finished_cycles - 1


@pytest.mark.parametrize(("setting", "values"), [("kept_restarts", ("few", "all")), ("search", SEARCHES)])
def test_what_changes_no_number_changes_no_input(setting, values):
    """Neither which restart files are kept nor who searches is a reason to simulate again."""
    assert len({inputs_of(tiny_study(solver={setting: value})) for value in values}) == 1


def inputs_of(study):
    return run_digest(study.case, study.run("R9_convex").parameters, study.beds[study.bed_of("R9_convex")])


def test_more_ranks_are_the_same_run(finished):
    """Ranks change the time a run takes, not what it is: its cycles stay valid."""
    assert inputs_digest(replace(finished, ranks=4)) == inputs_digest(finished)
