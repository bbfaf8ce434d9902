"""A simulation in pieces: where they end, and that a killed one goes on where its newest whole piece ended."""

from contextlib import suppress
from functools import partial

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bulkwear.workflows.engine.chain import RESTART
from bulkwear.workflows.engine.pieces import (
    CHECKPOINT,
    PIECES,
    finished_pieces,
    forget_pieces,
    piece_ends,
    simulate_in_pieces,
)
from bulkwear.workflows.engine.solver import LOG, SCREEN, SolverError

ENDS = [100, 200, 300, 340]
checked_pieces = partial(simulate_in_pieces, check_restart=lambda path: None)


@given(st.integers(0, 1000), st.integers(1, 5000), st.integers(1, 1000))
def test_pieces_end_with_the_cycle(first, steps, interval):
    """Pieces end in order, the last with the cycle; all before it are one interval long, it is half to one and a half,
    unless there is one piece."""
    ends = piece_ends(first, first + steps, interval)
    assert ends[-1] == first + steps
    lengths = [end - begin for begin, end in zip([first, *ends], ends, strict=False)]
    assert all(length == interval for length in lengths[:-1])
    assert len(ends) == 1 or interval / 2 <= lengths[-1] < 1.5 * interval


class Solver:
    """Writes what a piece of the solver writes, or fails on its way."""

    def __init__(self, folder, fails_at=None):
        self.folder, self.fails_at, self.calls = folder, fails_at, []

    def __call__(self, variables):
        self.calls.append(variables)
        begin = int(variables.get("begin_step", 0))
        if begin:
            assert (self.folder / variables["begin"]).read_text() == f"at {begin}"
        for name in (LOG, SCREEN):
            (self.folder / name).write_text(f"{begin} to\n{variables['stop']} 1.0\n")
        if int(variables["stop"]) == self.fails_at:
            raise SolverError("killed")
        if int(variables["stop"]) < ENDS[-1]:
            (self.folder / CHECKPOINT).write_text(f"at {variables['stop']}")
        return 1.0


@pytest.mark.parametrize("fails_at", ENDS)
def test_a_killed_simulation_goes_on_after_its_newest_piece(tmp_path, fails_at):
    """Every piece is simulated once but the one that was killed, and the log is that of an undisturbed simulation; it
    can be joined again until the pieces are forgotten."""
    with pytest.raises(SolverError):
        checked_pieces(tmp_path, "inputs", ENDS, Solver(tmp_path, fails_at))
    (tmp_path / "checkpoint_0.restart").touch()  # killed before it was removed
    solver, missing = Solver(tmp_path), ENDS[ENDS.index(fails_at) :]
    done = checked_pieces(tmp_path, "inputs", ENDS, solver)
    assert [variables["stop"] for variables in solver.calls] == [str(end) for end in missing]
    assert [piece.end for piece in done] == ENDS
    assert sum(piece.wall_s for piece in done) == len(ENDS)
    repeated = checked_pieces(tmp_path, "inputs", ENDS, lambda variables: pytest.fail("the solver was started"))
    assert repeated == done
    forget_pieces(tmp_path)
    assert finished_pieces(tmp_path, "inputs") == []
    lines = "".join(f"{begin} to\n{end} 1.0\n" for begin, end in zip([0, *ENDS], ENDS, strict=False))
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {LOG: lines, SCREEN: lines}


def test_pieces_of_another_start_do_not_count(tmp_path):
    """What was begun from other inputs is not taken up."""
    with pytest.raises(SolverError):
        checked_pieces(tmp_path, "inputs", ENDS, Solver(tmp_path, 300))
    assert [piece.end for piece in finished_pieces(tmp_path, "inputs")] == [100, 200]
    assert finished_pieces(tmp_path, "other inputs") == []


@pytest.mark.parametrize(
    "text",
    [
        "",
        '{"origin": "inp',
        "[]",
        '{"origin": "inputs"}',
        '{"origin": "inputs", "pieces": [{}]}',
        '{"origin": "inputs", "pieces": [], "left": 1}',
    ],
)
def test_a_torn_list_of_pieces_is_none(tmp_path, text):
    """A list that a full disk or a lost machine left unfinished counts no piece and stops no run."""
    (tmp_path / PIECES).write_text(text)
    assert finished_pieces(tmp_path, "inputs") == []


class OnePiece(Solver):
    """Writes what a cycle of 40 steps writes, or ends before."""

    def __call__(self, variables):
        self.calls.append(variables)
        for name in (LOG, SCREEN):
            (self.folder / name).write_text(f"{self.fails_at or 40} 1.0\n")
        return 1.0


def test_a_short_cycle_is_one_piece_that_is_told_nothing(tmp_path):
    """A cycle below the interval runs as its deck stands, once: until it is accounted it counts as simulated."""
    solver = OnePiece(tmp_path)
    done = checked_pieces(tmp_path, "inputs", [40], solver)
    assert solver.calls == [{}]
    repeated = checked_pieces(tmp_path, "inputs", [40], lambda variables: pytest.fail("the solver was started"))
    assert repeated == done == finished_pieces(tmp_path, "inputs")
    forget_pieces(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {LOG, SCREEN}


def test_a_solver_that_was_asked_to_end_has_finished_no_piece(tmp_path):
    """LIGGGHTS ends well when it is asked to end; its step tells, and the restart file that it leaves is nobody's."""
    with pytest.raises(SolverError, match=r"screen.txt: LIGGGHTS ended at step 39, allowed is 40; it was asked to end"):
        checked_pieces(tmp_path, "inputs", [40], OnePiece(tmp_path, 39))
    (tmp_path / "restart_forced_39").touch()
    assert finished_pieces(tmp_path, "inputs") == []
    checked_pieces(tmp_path, "inputs", [40], OnePiece(tmp_path))
    forget_pieces(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {LOG, SCREEN}


@pytest.mark.parametrize("ends", [[340], [150, 340], [100, 200, 250, 300, 340], [310, 340]])
def test_a_changed_interval_goes_on_from_the_newest_piece(tmp_path, ends):
    """Killed after 200 steps and started again with pieces of another length: what is done is not simulated again, and
    the log is whole."""
    with pytest.raises(SolverError):
        checked_pieces(tmp_path, "inputs", ENDS, Solver(tmp_path, 300))
    solver, missing = Solver(tmp_path), [end for end in ends if end > 200]
    done = checked_pieces(tmp_path, "inputs", ends, solver)
    assert [variables["stop"] for variables in solver.calls] == [str(end) for end in missing]
    assert [variables["begin_step"] for variables in solver.calls] == [str(end) for end in [200, *missing[:-1]]]
    assert [piece.end for piece in done] == [100, 200, *missing]
    begins = [line for line in (tmp_path / LOG).read_text().splitlines() if line.endswith("to")]
    assert begins == [f"{begin} to" for begin in [0, 100, 200, *missing[:-1]]]


def test_a_restart_file_that_changed_counts_no_piece(tmp_path):
    """Of a piece within the cycle, and of the last one while the cycle is not accounted."""
    for name, fails_at in (("checkpoint_2.restart", 300), (RESTART, None)):
        folder = tmp_path / name
        folder.mkdir()
        with suppress(SolverError):
            (folder / RESTART).write_text("of the cycle")
            checked_pieces(folder, "inputs", ENDS, Solver(folder, fails_at))
        assert finished_pieces(folder, "inputs")
        (folder / name).write_text("a flipped bit")
        assert finished_pieces(folder, "inputs") == []


def test_a_piece_whose_restart_file_is_not_whole_is_not_finished(tmp_path):
    """A solver on a full disk ends well and leaves a cut file: its piece does not count, and is made again from the one
    before, the last piece of the cycle too."""
    for cut in ENDS:
        folder = tmp_path / str(cut)
        folder.mkdir()

        def check(path, cut=cut):
            if f"\n{cut} " in (path.parent / SCREEN).read_text():
                raise SolverError(f"{path.name} is cut")

        with pytest.raises(SolverError, match=CHECKPOINT if cut < ENDS[-1] else "run.restart"):
            simulate_in_pieces(folder, "inputs", ENDS, Solver(folder), check)
        solver = Solver(folder)
        done = checked_pieces(folder, "inputs", ENDS, solver)
        assert [variables["stop"] for variables in solver.calls] == [str(end) for end in ENDS if end >= cut]
        assert [piece.end for piece in done] == ENDS
