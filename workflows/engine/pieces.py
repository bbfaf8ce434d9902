"""The simulation of a long cycle in pieces, each from the restart file that the one before left.

A piece is a start of the solver on the cycle's one deck, told where to begin and to stop; the last one ends the cycle.
Most cycles are one piece, which is told nothing.
They are the same pieces whether a run is killed or not: a run that is taken up within a cycle is the undisturbed one.
Where the interval of the pieces was changed meanwhile, it goes on from the newest one.
What is finished stands in `pieces.json`. It, the logs of the pieces and the newest restart file stay until the
cycle is accounted and its state written, so that a fault on the way there costs no simulation.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from bulkwear.postproc.readers.solver_log import last_step
from bulkwear.workflows.engine.chain import RESTART
from bulkwear.workflows.engine.disk import whole_restart
from bulkwear.workflows.engine.records import RecordError, read_record, write_record
from bulkwear.workflows.engine.solver import LOG, SCREEN, SolverError, processor_seconds
from bulkwear.workflows.engine.state import file_digest

PIECES, CHECKPOINT = "pieces.json", "checkpoint.restart"  # the second as the decks name it
FORCED = "restart_forced_*"  # left by a solver that was asked to end
LEAST_LAST_PIECE = 0.5  # -, of an interval; a shorter rest is added to the piece before


@dataclass(frozen=True)
class Piece:
    """A finished piece: the step at which it ended, and the solver's wall and processor time (s)."""

    end: int
    wall_s: float
    processor_s: float


def piece_ends(first: int, steps: int, interval: int) -> list[int]:
    """Return the steps at which the pieces of a simulation of so many steps end, none of them before `first`."""
    ends = list(range(first + interval, steps, interval))
    if ends and steps - ends[-1] < LEAST_LAST_PIECE * interval:
        ends.pop()
    return [*ends, steps]


def simulate_in_pieces(
    folder: Path,
    origin: str,
    ends: list[int],
    run: Callable[[Mapping[str, str]], float],
    check_restart: Callable[[Path], object] = whole_restart,
) -> list[Piece]:
    """Run the pieces of a cycle that are missing and return all of them.

    run: starts the solver with these variables of its deck and returns its wall time in s
    origin: hash of all that the cycle starts from
    check_restart: raises a fault for a restart file that is not whole; only one that is finishes a piece

    The folder then holds one log and one screen of the cycle; `forget_pieces` removes the rest. Raises SolverError, and
    what `check_restart` does.
    """
    done = finished_pieces(folder, origin)
    for forced in folder.glob(FORCED):
        forced.unlink()
    for end in [end for end in ends if not done or end > done[-1].end]:
        before = processor_seconds()
        wall = run(_variables(done, end) if done or len(ends) > 1 else {})
        check_end(folder, end)
        check_restart(folder / (RESTART if end == ends[-1] else CHECKPOINT))
        done.append(Piece(end, wall, processor_seconds() - before))
        _keep(folder, origin, done)
    _join(folder, len(done))
    return done


def finished_pieces(folder: Path, origin: str) -> list[Piece]:
    """Return the finished pieces of a cycle; those that started from something else, that a torn list tells, or whose
    restart file has changed do not count.
    """
    try:
        found = read_record(folder / PIECES)
        pieces = [Piece(**piece) for piece in found["pieces"]] if found["origin"] == origin else []
        left = all(file_digest(folder / name) == digest for name, digest in found["left"].items())
    except (OSError, RecordError, KeyError, TypeError, AttributeError):
        return []
    return pieces if left else []


def check_end(folder: Path, end: int) -> None:
    """Raise SolverError if the solver did not come to that step: one that is asked to end does so without a fault."""
    found = last_step(folder / SCREEN)
    if found is None or found < end:
        raise SolverError(
            f"{folder / SCREEN}: LIGGGHTS ended at step {found}, allowed is {end}; it was asked to end, start again."
        )


def _variables(done: list[Piece], end: int) -> dict[str, str]:
    """Return what the deck of a cycle is told for its next piece."""
    begin = {"begin": _checkpoint(len(done)), "begin_step": str(done[-1].end)} if done else {}
    return {**begin, "stop": str(end)}


def _checkpoint(pieces: int) -> str:
    """Return the name of the restart file that so many pieces left."""
    return f"checkpoint_{pieces}.restart"


def _keep(folder: Path, origin: str, done: list[Piece]) -> None:
    """Put aside what the newest piece wrote; only then does it count as finished."""
    count = len(done)
    for name in (LOG, SCREEN):
        os.replace(folder / name, _of_piece(folder, name, count))
    if (folder / CHECKPOINT).exists():  # the last piece leaves none, but the restart file of the cycle
        os.replace(folder / CHECKPOINT, folder / _checkpoint(count))
    restarts = [path for path in (folder / _checkpoint(count), folder / RESTART) if path.exists()]
    left = {path.name: file_digest(path) for path in restarts[:1]}
    write_record(folder / PIECES, {"origin": origin, "pieces": [asdict(piece) for piece in done], "left": left})
    for earlier in folder.glob("checkpoint_*.restart"):
        if earlier.name != _checkpoint(count):
            earlier.unlink()


def _join(folder: Path, pieces: int) -> None:
    """Make one log and one screen of those of the pieces, which stay: it can be done again."""
    for name in (LOG, SCREEN):
        parts = [_of_piece(folder, name, number) for number in range(1, pieces + 1)]
        (folder / name).write_bytes(b"".join(part.read_bytes() for part in parts))


def forget_pieces(folder: Path) -> None:
    """Remove what is left of a cycle's pieces, their list first: without it none counts."""
    (folder / PIECES).unlink(missing_ok=True)
    for name in (LOG, SCREEN):
        for part in folder.glob(f"piece_*_{name}"):
            part.unlink()


def _of_piece(folder: Path, name: str, number: int) -> Path:
    return folder / f"piece_{number}_{name}"
