"""A run that is killed, or whose solver fails: nothing is lost, and it goes on to the same end."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from bulkwear.postproc.readers.load_ledger import LoadLedgerError
from bulkwear.postproc.tables.summary import run_summary
from bulkwear.workflows.engine import cycles, state
from bulkwear.workflows.engine.accounting import HISTORY, LEDGER, account_and_wear
from bulkwear.workflows.engine.case import FORCES
from bulkwear.workflows.engine.pieces import PIECES
from bulkwear.workflows.engine.solver import SolverError
from tests import REPOSITORY
from tests.support.killed import DRIVER, kill_when, start_driver, wait_until_no_solver
from tests.support.tiny import tiny_chain, tiny_study
from tests.support.tiny_runs import LOOKS, SHORT_STEPS, copy_cycles, first_ledger, twin, wear_cycles, wear_table

pytestmark = pytest.mark.solver

# Relative, of totals: what chaos makes of them (seen 0.013). Finnie's wear hangs on few impacts (seen 0.05); half of it
# would be lost, were it not in the restart file.
PIECES_TOLERANCES = {"sliding_work_J": 2e-2, "normal_impulse_N_s": 2e-2, "contact_time_s": 2e-2, "finnie_wear": 0.2}


MOMENTS = {
    "while the bed is lowered": lambda run: (run / "cycle_000.part" / "screen.txt").exists(),
    "while cycle 1 is simulated": lambda run: (run / "cycle_001.part" / "bed_0.dump").exists(),
    "while cycle 1 is accounted": lambda run: (run / "cycle_001.part" / "run.restart").exists(),
    "while cycle 2 is simulated": lambda run: (run / "cycle_002.part" / "screen.txt").exists(),
}


# Moments of the same kind as another one that is tried.
SELDOM = {
    "while the bed is lowered",
    "while cycle 1 is simulated",
    "while cycle 1 is accounted",
    "after the first piece of the run-in",
}


def without_seldom(moments):
    """Parameters: those of SELDOM for `make verify` alone."""
    return [pytest.param(each, marks=pytest.mark.verify) if each in SELDOM else each for each in moments]


@pytest.mark.parametrize("moment", without_seldom(MOMENTS))
def test_killed_and_started_again_gives_the_same_tables(finished, tmp_path, moment):
    """kill -9 at any moment, start again: the same wear.csv and summary, finished cycles untouched, no orphan."""
    chain = twin(finished, tmp_path)
    kill_when(start_driver(chain, tmp_path), lambda: MOMENTS[moment](chain.folder))
    wait_until_no_solver(tmp_path)
    done = {path: path.stat().st_mtime_ns for path in chain.folder.glob("cycle_???/*")}
    cycles.run_chain(chain)
    assert (chain.folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()
    assert run_summary(wear_table(chain)) == run_summary(wear_table(finished))
    assert {path: path.stat().st_mtime_ns for path in done} == done


@pytest.fixture(scope="module")
def in_pieces(tmp_path_factory):
    """An undisturbed run of one wear cycle whose simulation is started anew every few hundred steps."""
    changes = {"solver": {**LOOKS, "checkpoint_interval_steps": 125}, "sliding": {"cycles": 1}}
    chain = tiny_chain(tiny_study(**changes), tmp_path_factory.mktemp("pieces"))
    cycles.run_chain(chain)
    return chain


def pieces_done(folder: Path) -> list[dict[str, float]]:
    """The finished pieces of a cycle that is being worked on."""
    return json.loads((folder / PIECES).read_text())["pieces"] if (folder / PIECES).exists() else []


MOMENTS_IN_PIECES = {
    "after the first piece of the run-in": ("cycle_000.part", 1, "lowering and run-in"),
    "after the third piece of cycle 1": ("cycle_001.part", 3, "cycle 1 of 1"),
}


@pytest.mark.verify
@pytest.mark.parametrize("moment", without_seldom(MOMENTS_IN_PIECES))
def test_killed_within_a_cycle_it_goes_on_from_its_newest_piece(in_pieces, tmp_path, capfd, moment):
    """kill -9 within a cycle and a second start: no finished piece is simulated again, and ledger, forces, history and
    tables are bit for bit those of the undisturbed run."""
    folder, count, title = MOMENTS_IN_PIECES[moment]
    chain = twin(in_pieces, tmp_path)
    kill_when(start_driver(chain, tmp_path), lambda: len(pieces_done(chain.folder / folder)) >= count)
    wait_until_no_solver(tmp_path)
    begun = pieces_done(chain.folder / folder)[-1]["end"]
    capfd.readouterr()
    cycles.run_chain(chain)
    assert f"{chain.name}: {title} goes on after step {begun}" in capfd.readouterr().err
    for name in ("wear.csv", *(f"cycle_001/{each}" for each in (LEDGER, FORCES, HISTORY, "run.restart"))):
        assert (chain.folder / name).read_bytes() == (in_pieces.folder / name).read_bytes(), name
    left = {path.name for path in state.cycle_folder(chain.folder, 1).iterdir()}
    assert left == {path.name for path in state.cycle_folder(in_pieces.folder, 1).iterdir()}
    assert not [name for name in left if name.startswith(("piece", "checkpoint"))]


@pytest.mark.verify
def test_a_fault_while_a_cycle_is_accounted_costs_no_simulation(in_pieces, tmp_path, monkeypatch):
    """What ends the driver between the last piece and the state of a cycle: the next start accounts the cycle again,
    without the solver, and leaves what the undisturbed run left."""
    chain = twin(in_pieces, tmp_path)

    def ended(*given):
        account_and_wear(*given)
        raise KeyboardInterrupt

    with monkeypatch.context() as first, pytest.raises(KeyboardInterrupt):
        first.setattr(cycles, "account_and_wear", ended)
        cycles.run_chain(chain)
    monkeypatch.setattr(cycles, "run_deck", lambda *given, **named: pytest.fail("the solver was started"))
    cycles.run_chain(chain)
    for name in ("wear.csv", *(f"cycle_001/{each}" for each in (LEDGER, FORCES, HISTORY, "run.restart"))):
        assert (chain.folder / name).read_bytes() == (in_pieces.folder / name).read_bytes(), name
    flows = [pd.read_parquet(run.folder / "cycle_001" / "flow.parquet") for run in (chain, in_pieces)]
    pd.testing.assert_frame_equal(*flows, check_exact=True)
    left, expected = ({path.name for path in (run.folder / "cycle_001").iterdir()} for run in (chain, in_pieces))
    assert left == expected


@pytest.mark.verify
def test_a_simulation_in_pieces_is_the_simulation(tmp_path):
    """From the same restart, a cycle in pieces has the ledger of the whole one, Finnie's wear and history included.

    The solver evaluates forces once more at each start, and chaos lets that grow over some hundred steps.
    """
    whole = tiny_chain(tiny_study(solver=LOOKS | SHORT_STEPS), tmp_path / "whole")
    cycles.run_chain(whole)
    chain = twin(whole, tmp_path)
    solver = {**chain.parameters["solver"], "checkpoint_interval_steps": 250}
    found = first_ledger(replace(chain, parameters={**chain.parameters, "solver": solver}), whole)
    expected = pd.read_parquet(state.cycle_folder(whole.folder, 1) / LEDGER)
    for field, tolerance in PIECES_TOLERANCES.items():
        assert found[field].sum() == pytest.approx(expected[field].sum(), rel=tolerance), field
    looks = pd.read_csv(state.cycle_folder(whole.folder, 1) / HISTORY)
    assert len(list(state.cycle_folder(chain.folder, 1).glob("load_ledger.bin.*"))) == len(looks) - 1


@pytest.mark.verify
def test_a_cycle_whose_ledger_cannot_be_read_is_simulated_again(in_pieces, tmp_path, monkeypatch):
    """What the solver left half is not accounted for ever: the next start simulates the cycle, to the same end."""
    chain = twin(in_pieces, tmp_path)

    def cut(chain, span, folder, surface):
        os.truncate(folder / "load_ledger.bin", 100)
        return account_and_wear(chain, span, folder, surface)

    with monkeypatch.context() as first, pytest.raises(LoadLedgerError, match=r"simulates cycle 1 of 1 again"):
        first.setattr(cycles, "account_and_wear", cut)
        cycles.run_chain(chain)
    assert not pieces_done(chain.folder / "cycle_001.part")
    cycles.run_chain(chain)
    assert (chain.folder / "wear.csv").read_bytes() == (in_pieces.folder / "wear.csv").read_bytes()


def test_a_kill_while_cycles_are_moved_loses_nothing(finished, tmp_path, monkeypatch):
    """Interrupted between two moves, the next start moves the rest: old cycles are whole in superseded/."""
    chain = twin(finished, tmp_path)
    copy_cycles(finished, chain)
    moves = []

    def move_once(source, target):
        if moves:
            raise KeyboardInterrupt
        moves.append(source)
        Path(source).rename(target)

    with monkeypatch.context() as patch:
        patch.setattr(state.os, "replace", move_once)
        with pytest.raises(KeyboardInterrupt):
            state.set_aside_others(chain.folder, "f" * 64)
    state.set_aside_others(chain.folder, "f" * 64)
    kept = sorted(path.name for path in chain.folder.glob("superseded/*/cycle_*"))
    assert kept == [f"cycle_{cycle:03d}" for cycle in range(wear_cycles(chain) + 1)]


def test_a_failed_solver_shows_its_last_words_and_the_run_resumes(finished, tmp_path, monkeypatch):
    """The message has the cause and the solver's own lines; finished cycles stay, and without the fault they go on."""
    chain = twin(finished, tmp_path)
    with monkeypatch.context() as broken:
        broken.setattr("bulkwear.workflows.engine.chain.RESTART", "no_such.restart")
        with pytest.raises(
            SolverError, match=r"cycle_001\.part/deck\.in: LIGGGHTS stopped: .*open restart file"
        ) as fault:
            cycles.run_chain(chain)
    assert "Its last lines" in str(fault.value) and "ERROR" in str(fault.value)
    done = (state.cycle_folder(chain.folder, 0) / "state.json").stat().st_mtime_ns
    cycles.run_chain(chain)
    assert (state.cycle_folder(chain.folder, 0) / "state.json").stat().st_mtime_ns == done
    assert (chain.folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()


@pytest.mark.verify
def test_a_second_driver_waits_for_the_first(finished, tmp_path):
    """Two drivers of one run do the work once: the second waits, says for whom, and finds everything finished."""
    chain = twin(finished, tmp_path)
    for cycle in (0, 1):  # the last one is left to be simulated
        shutil.copytree(state.cycle_folder(finished.folder, cycle), state.cycle_folder(chain.folder, cycle))
    first = start_driver(chain, tmp_path)
    lock = chain.folder / ".lock"
    while not (lock.exists() and lock.read_text()):
        time.sleep(0.01)
    first.send_signal(signal.SIGSTOP)  # until the second one waits, however slowly it starts
    with open(tmp_path / "second.txt", "w+") as said:
        command = [sys.executable, "-c", DRIVER, str(tmp_path / "chain.pickle")]
        second = subprocess.Popen(command, cwd=REPOSITORY, stderr=said)
        while second.poll() is None and "waiting" not in (tmp_path / "second.txt").read_text():
            time.sleep(0.05)
        first.send_signal(signal.SIGCONT)
        assert (first.wait(), second.wait()) == (0, 0)
    told = (tmp_path / "second.txt").read_text()
    assert f"process {first.pid} works on {chain.folder}; waiting for it to end" in told
    assert "cycle 1" not in told
    assert (chain.folder / "wear.csv").read_bytes() == (finished.folder / "wear.csv").read_bytes()
