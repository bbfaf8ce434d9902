"""State of a run on disk: what a finished cycle depended on, what it left, and which cycles still hold.

A cycle is worked on in `cycle_<nnn>.part` and renamed to `cycle_<nnn>` when its state is written: a folder under the
final name is whole. A run resumes after the newest cycle whose state was made from the same inputs, and from nothing
else; cycles of other inputs move to `superseded/<digest>`, and come back when those inputs do.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import hashlib
import os
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from bulkwear.postproc.readers.cycle_folders import cycle_folders
from bulkwear.workflows.engine.records import RecordError, read_record, write_record
from bulkwear.workflows.engine.records import digest as digest  # hashes of inputs are made where states are

STATE = "state.json"
LOCK = ".lock"  # of a folder that a process works on, which has it locked
HELD_BY_ANOTHER = (errno.EAGAIN, errno.EACCES)  # of a lock; any other error is the file system's
DIGEST_LETTERS = 12  # of the hash, in the name of a superseded folder


class StateError(RuntimeError):
    """The inputs of a run changed while it was running; the message names the run."""


def file_digest(path: Path) -> str:
    """Return the SHA-256 of a file."""
    with open(path, "rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def cycle_folder(run_folder: Path, cycle: int) -> Path:
    """Return the folder of a finished cycle: cycle_000 is the lowered and run-in bed, wear starts with cycle_001."""
    return run_folder / f"cycle_{cycle:03d}"


@contextlib.contextmanager
def working_folder(run_folder: Path, cycle: int, begun: Callable[[Path], bool] = lambda part: False) -> Iterator[Path]:
    """Give a folder to work on a cycle in; it gets the cycle's final name when the block ends well.

    It is empty, unless `begun` says that what an interrupted driver left in it can be taken up. Where the cycle is done
    again because it was damaged, later ones stay if it left the same files, and are set aside if it did not.
    """
    final = cycle_folder(run_folder, cycle)
    part = final.with_suffix(".part")
    if not begun(part):
        shutil.rmtree(part, ignore_errors=True)
    part.mkdir(parents=True, exist_ok=True)
    yield part
    if final.exists():  # a damaged cycle, done again
        every = cycle_folders(run_folder)
        for folder in [] if _same_files(part, final) else reversed(every[every.index(final) + 1 :]):
            set_aside(folder)
        set_aside(final)
    os.replace(part, final)


def _same_files(made: Path, before: Path) -> bool:
    """Return whether a cycle that was made again left what it had left before, of what is still there of that."""
    names = read_record(made / STATE)["files"]
    return all(file_digest(before / name) == found for name, found in names.items() if (before / name).is_file())


def set_aside(folder: Path) -> None:
    """Keep a folder that is no longer valid under superseded/damaged, replacing an earlier one of its name."""
    target = folder.parent / "superseded" / "damaged" / folder.name
    shutil.rmtree(target, ignore_errors=True)
    target.parent.mkdir(parents=True, exist_ok=True)
    os.replace(folder, target)


def write_state(folder: Path, inputs: str, files: tuple[str, ...], record: Mapping[str, Any]) -> None:
    """Write the state of a cycle: the digest of its inputs, those of the files that the next one needs, its record."""
    hashes = {name: file_digest(folder / name) for name in files}
    write_record(folder / STATE, {"inputs": inputs, "files": hashes, **record})


def drop_files(folder: Path, names: Iterable[str]) -> None:
    """Remove files of a finished cycle that nothing needs any more; its state then does without them."""
    there = [name for name in names if (folder / name).exists()]
    if not there:
        return
    state = read_record(folder / STATE)
    state["files"] = {name: digest for name, digest in state["files"].items() if name not in there}
    write_record(folder / STATE, state)
    for name in there:
        (folder / name).unlink()


def read_state(run_folder: Path, cycle: int) -> dict[str, Any]:
    """Return the state of a finished cycle. Raises RecordError for one that is not as it was written."""
    return read_record(cycle_folder(run_folder, cycle) / STATE)


def finished_cycles(
    run_folder: Path,
    inputs: str,
    needed: tuple[str, ...] = (),
    usable: Callable[[Path], bool] = lambda folder: True,
    faulty: Callable[[Path], str | None] = lambda folder: None,
    say: Callable[[str], None] = lambda text: None,
) -> int:
    """Return how many cycles, counted from 0 without a gap, were made from these inputs and are undamaged.

    needed: files of the last wear cycle from which the next one goes on; where they were dropped, as from all but the
    newest cycle, an earlier one that still has them is the last.
    usable: whether the next cycle can go on from a folder; from one that is not, as written on a full disk, none does
    faulty: what else is wrong with a cycle whose files are as they were written, a sentence
    say: is told of a damaged cycle
    """
    count = 0
    while not (fault := damage(cycle_folder(run_folder, count), inputs) or faulty(cycle_folder(run_folder, count))):
        count += 1
    if fault and (cycle_folder(run_folder, count) / STATE).exists():
        say(f"{fault} {cycle_folder(run_folder, count).name} is made again, and what follows it.")
    while count > 0 and not _goes_on(cycle_folder(run_folder, count - 1), needed if count > 1 else (), usable):
        count -= 1
    return count


def _goes_on(folder: Path, needed: tuple[str, ...], usable: Callable[[Path], bool]) -> bool:
    return all((folder / name).exists() for name in needed) and usable(folder)


def damage(folder: Path, inputs: str) -> str | None:
    """Return why a cycle does not count, a sentence that names the file; None for a whole one of these inputs."""
    path = folder / STATE
    try:
        state = read_record(path)
        if state["inputs"] != inputs:
            return f"{path}: it was made from other inputs."
        for name, digest in state["files"].items():
            if file_digest(folder / name) != digest:
                return f"{folder / name}: the file is not as it was written."
    except RecordError as fault:
        return str(fault)
    except OSError as fault:
        return f"{fault.filename}: the file cannot be read ({fault.strerror})."
    except (KeyError, TypeError, AttributeError):
        return f"{path}: the record is torn, allowed is JSON as it was written."
    return None


def share_cycles(run_folder: Path, other: Path, inputs: str) -> int:
    """Give a run the finished cycles that it lacks of another one made from the same inputs; return how many.

    Files are linked where the file system can, and the state tells whose they are (`shared_with`). Cycles of other
    inputs and damaged ones are not taken. A run that has worn its sample itself gets none: several ranks sum in an
    order of their own, and the other's next cycle would not go on from this run's last one.
    """
    finished = finished_cycles(run_folder, inputs)
    if any("shared_with" not in read_state(run_folder, cycle) for cycle in range(1, finished)):
        return 0
    missing = range(finished, finished_cycles(other, inputs))
    for cycle in missing:
        source = cycle_folder(other, cycle)
        with working_folder(run_folder, cycle) as folder:
            for path in source.iterdir():
                if path.name != STATE:
                    _link(path, folder / path.name)
            write_record(folder / STATE, {**read_state(other, cycle), "shared_with": other.name})
    return len(missing)


def _link(source: Path, target: Path) -> None:
    try:
        os.link(source, target)
    except OSError:  # a file system without hard links
        shutil.copy2(source, target)


def set_aside_others(run_folder: Path, inputs: str) -> str | None:
    """Move cycles of other inputs to superseded/<digest> and bring back those of these inputs, if there are any.

    What was left unfinished goes with them, for inputs may have changed by mistake.
    Returns a sentence about what was moved, or None.
    """
    said = []
    first = cycle_folder(run_folder, 0)
    if first.exists() and (other := _inputs_of(run_folder)) != inputs:
        target = run_folder / "superseded" / other[:DIGEST_LETTERS]
        _move(sorted(run_folder.glob("cycle_*.part")), target)
        _move(reversed(cycle_folders(run_folder)), target)
        said.append(f"its inputs changed, earlier cycles are kept in {target}")
    stored = run_folder / "superseded" / inputs[:DIGEST_LETTERS]
    if stored.exists() and not first.exists():
        _move(sorted(stored.glob("cycle_*.part")), run_folder)
        _move(reversed(cycle_folders(stored)), run_folder)
        said.append(f"cycles of the same inputs were brought back from {stored}")
    return "; ".join(said) or None


def fit_length(run_folder: Path, inputs: str, cycles: int | None) -> str | None:
    """Move what a run that became shorter has too much to superseded/<digest>; bring back what a longer one has there.

    cycles: how many the run has, cycle 0 included; None where a run of another length shares none with it.
    Returns a sentence about what was moved, or None.
    """
    if cycles is None:
        return None
    stored = run_folder / "superseded" / inputs[:DIGEST_LETTERS]
    kept = {cycle_folder(run_folder, cycle) for cycle in range(cycles)}
    surplus = [folder for folder in cycle_folders(run_folder) if folder not in kept]
    count, back = finished_cycles(run_folder, inputs), []
    while count + len(back) < cycles and not damage(found := cycle_folder(stored, count + len(back)), inputs):
        back.append(found)
    _move(reversed(surplus), stored)  # the last one first: those that are left have no gap, whenever it ends
    _move(back, run_folder)
    said = [f"the run is shorter now, later cycles are kept in {stored}"] if surplus else []
    said += [f"{len(back)} cycles of it were brought back from {stored}"] if back else []
    return "; ".join(said) or None


def _inputs_of(run_folder: Path) -> str:
    """Return the inputs of a run's cycles, by the first record that is as it was written."""
    for folder in cycle_folders(run_folder):
        with contextlib.suppress(OSError, RecordError, KeyError):
            return read_record(folder / STATE)["inputs"]
    return "damaged_state"


def _move(folders: Iterable[Path], target: Path) -> None:
    """Move cycles one by one; of all of a run the first one goes last, it tells whose cycles a folder holds."""
    for folder in folders:
        target.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(target / folder.name, ignore_errors=True)
        os.replace(folder, target / folder.name)


def no_lock(folder: Path, fault: OSError) -> str:
    """Return in a sentence that a folder's file system cannot lock files."""
    return (
        f"{folder}: its file system cannot lock files ({fault.strerror}); allowed is one that can, Lustre with the"
        " mount option flock."
    )


@contextlib.contextmanager
def only_driver(folder: Path, say: Callable[[str], None]) -> Iterator[None]:
    """Hold a folder's lock; the kernel releases it with the process. Waits, and says so, while another one holds it."""
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / LOCK, "a+") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as fault:
            if fault.errno not in HELD_BY_ANOTHER:
                raise OSError(fault.errno, no_lock(folder, fault)) from None
            lock.seek(0)
            say(f"process {lock.read().strip() or 'unknown'} works on {folder}; waiting for it to end")
            fcntl.flock(lock, fcntl.LOCK_EX)
        lock.truncate(0)
        lock.write(str(os.getpid()))
        lock.flush()
        yield
