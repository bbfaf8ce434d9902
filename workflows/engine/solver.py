"""Run LIGGGHTS on a deck in its folder: start it, watch it, stop it with its parent, and pass on its last words."""

from __future__ import annotations

import ctypes
import os
import resource
import select
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from bulkwear.postproc.readers.solver_log import SolverLogError, ended_by_signal, failure, last_step, reported_triangles
from bulkwear.postproc.wear.kernels import kernel_column, kernel_of, kernel_parameters
from bulkwear.workflows.engine.disk import RESERVE_BYTES, free_bytes, full_sentence
from bulkwear.workflows.engine.own_kernels import own_library, python_fault
from bulkwear.workflows.engine.patience import PATIENCE, Patience, Watch
from bulkwear.workflows.engine.project import PACKAGE, ProjectError

if TYPE_CHECKING:
    from bulkwear.workflows.engine.case import Case

DECK, LOG, SCREEN = "deck.in", "log.liggghts", "screen.txt"
EXECUTABLE = "liggghts"
LAUNCHER = "mpirun --bind-to none"  # starts the ranks of a solver; a cluster's profile may name another
BUILT = PACKAGE / "solver" / "build" / "liggghts-ledger"
LEDGER_EXECUTABLE = str(BUILT) if BUILT.exists() else shutil.which(BUILT.name) or str(BUILT)
OWN_ROLLING_MODELS = ("own_spin", "rvd")  # those of solver/rolling, which only our program has
SEARCHES = ("ours", "stock")  # for contacts with meshes, of our program; both find the same
OF_SLURM = ("SLURM_", "PMI_", "PMIX_")  # environment variables of a job
# A rank without others needs no daemon of Open MPI, which takes longer than all else of its start; and without one no
# folder of Open MPI's, whose name would be the same for all such ranks of a machine.
ALONE = {
    "OMPI_MCA_ess_singleton_isolated": "1",
    "OMPI_MCA_orte_create_session_dirs": "0",
    "OMPI_MCA_pml": "ob1",
    "OMPI_MCA_btl": "self",
}
POLL_SECONDS = 0.25  # between two looks at the log
STOP_SECONDS = 10.0  # for which a solver may take to end when it is asked to
ANSWER_SECONDS = 60.0  # for which it may take to say what it has
OF_LAUNCHER = 128  # added to a signal's number in an exit code
CRASHES = {signal.SIGSEGV, signal.SIGBUS, signal.SIGFPE, signal.SIGILL, signal.SIGABRT}
LAST_LINES = 12  # of the solver's output, shown when it fails
_PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of prctl(2)


class SolverError(RuntimeError):
    """LIGGGHTS failed; the message gives its last words and, where known, the cause."""


class SolverStoppedError(SolverError):
    """LIGGGHTS was ended from outside, by a signal, a disk that was nearly full or a machine on which it made no step
    any more: that says nothing of what it simulates.
    """


class SolverCrashedError(SolverError):
    """A signal of its own ended LIGGGHTS, as SIGSEGV."""


def missing_program(executable: str) -> str | None:
    """Return a sentence that says what to do where a program is missing, None where it is there."""
    if shutil.which(executable) is not None:
        return None
    if executable == LEDGER_EXECUTABLE:
        return (
            f"{executable}: there is no such program, nor one of its name on the PATH; `make setup` (or `make -C "
            "solver`) builds it, and a study with `ledger: dumps` and a rolling friction of LIGGGHTS does without."
        )
    return f"{executable} is not on the PATH; `make setup` installs it and `make doctor` checks it."


def executable_of(parameters: Mapping[str, Any], wears: bool = False) -> str:
    """Return the program that runs a deck: ours where it has to, or is there, because it finds contacts with meshes in
    less time; else the plain one. Both simulate the same. A run whose ledger is sampled (`dumps`) has the plain one.

    parameters: with `solver`, and where the deck is one of a run's cycles (wears) with `ledger`
    """
    needed = parameters["solver"]["rolling_friction"] in OWN_ROLLING_MODELS
    ours = needed or (parameters["ledger"] == "solver" if wears else missing_program(LEDGER_EXECUTABLE) is None)
    return LEDGER_EXECUTABLE if ours else EXECUTABLE


def missing_rolling_model(executable: str, model: str) -> str | None:
    """Return a sentence that says what to do where a program of ours lacks a rolling model of ours; else None."""
    known = _told(executable, "-rolling") if model in OWN_ROLLING_MODELS else (model,)
    if model in known:
        return None
    return (
        f"{executable}: it has no rolling friction {model}, found: {', '.join(known) or 'none'} beside LIGGGHTS' own; "
        "`make -C solver` builds those of solver/rolling."
    )


def missing_kernels(executable: str, kernels: Iterable[str]) -> str | None:
    """Return a sentence that says what to do where a program lacks contact kernels (`postproc/wear/kernels.py`) as they
    are here: column and parameters; None where it has them, by itself or from the project (`own_kernels`).

    Raises ProjectError for a kernel of the project that cannot be compiled.
    """
    wanted = {name: " ".join([name, kernel_column(name), *kernel_parameters(name)]) for name in map(kernel_of, kernels)}
    known = _told(executable, *own_kernels_words(own_library(wanted)), "-kernels") if wanted else ()
    if missing := [name for name, line in wanted.items() if line not in known]:
        return (
            f"{executable}: it has no contact kernel {', '.join(missing)} as postproc/wear/kernels.py has it, found: "
            f"{'; '.join(known) or 'none'}; `make -C solver` builds those of solver/kernels.h, and a study with "
            "`ledger: dumps` does without."
        )
    return None


@cache  # a study asks once per run
def _told(executable: str, *question: str) -> tuple[str, ...]:
    """Return what a program says of what it has, a line each; nothing from one that does not know the question."""
    try:
        told = subprocess.run(
            [executable, *question], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=ANSWER_SECONDS
        )
    except subprocess.TimeoutExpired:
        raise SolverError(
            f"{executable}: it gives no answer to {' '.join(question)}, allowed is a solver of ours."
        ) from None
    return tuple(told.stdout.splitlines()) if told.returncode == 0 else ()


def cycle_fault(executable: str, case: Case, run: Mapping[str, Any]) -> str | None:
    """Return a sentence that says what to do where a program cannot simulate the wear cycles of a run of a case, with
    the kernels of all its laws and its rolling model; else None.
    """
    if missing := missing_program(executable):
        return missing
    kernels = case.kernels(run)
    try:
        lacking = missing_kernels(executable, kernels) if run["ledger"] == "solver" else python_fault(kernels)
    except ProjectError as fault:
        return str(fault)
    return lacking or missing_rolling_model(executable, run["solver"]["rolling_friction"])


def own_kernels_words(library: Path | None) -> list[str]:
    """Return the words by which our program loads the kernels of a project."""
    return ["-own-kernels", str(library)] if library else []


def solver_command(
    ranks: int,
    executable: str = EXECUTABLE,
    launcher: str = LAUNCHER,
    search: str = SEARCHES[0],
    own_kernels: Path | None = None,
) -> list[str]:
    """Return the command that runs a deck; output is line-buffered, or fatal messages would vanish in a pipe.

    search: of `SEARCHES`; the plain program has but its own; own_kernels: library of a project, for our program
    """
    deck = ["stdbuf", "-oL", executable, "-in", DECK, "-log", LOG]
    if executable != EXECUTABLE and search != SEARCHES[0]:
        deck += ["-search", search]
    deck += own_kernels_words(own_kernels)
    return deck if ranks == 1 else [*shlex.split(launcher), "-n", str(ranks), *deck]


def solver_environment(ranks: int = 1, by_slurm: bool = False) -> dict[str, str]:
    """Return the environment of the solver; Open MPI refuses to run as root unless told twice.

    by_slurm: Slurm itself starts the ranks (srun). Otherwise they must not know of it: Open MPI would look for an
    allocation that jobs of Snakemake do not hand on, or for a Slurm that speaks its protocol.
    """
    allowed = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    kept = {key: value for key, value in os.environ.items() if by_slurm or not key.startswith(OF_SLURM)}
    alone = ALONE if ranks == 1 else {}
    return {**alone, **kept, "OMP_NUM_THREADS": "1", **(allowed if os.geteuid() == 0 else {})}


def processor_seconds() -> float:
    """Return the processor time (s) of all programs that this process has run to their end so far."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


def run_deck(
    folder: Path,
    ranks: int = 1,
    on_step: Callable[[int], None] = lambda step: None,
    triangles: Mapping[str, int] | None = None,
    executable: str = EXECUTABLE,
    launcher: str = LAUNCHER,
    variables: Mapping[str, str] = MappingProxyType({}),
    patience: Patience = PATIENCE,
    search: str = SEARCHES[0],
    own_kernels: Path | None = None,
) -> float:
    """Run `deck.in` of a folder to its end and return the wall time in s.

    on_step: called with the last time step reported, several times a second
    triangles: {mesh fix id: number of triangles written for it}; the run is stopped when the solver reports fewer
    executable: name on the PATH, or path, of the LIGGGHTS that runs it
    launcher: command, with options, that starts several ranks of it
    variables: of style index, whose values in the deck these replace
    patience: how long it may make no step
    search: for contacts with meshes
    own_kernels: library of a project's contact kernels, see `own_kernels`

    Raises SolverError, SolverStoppedError where something else than the simulation ended it. A solver on a disk that is
    nearly full is stopped, before it leaves half a file.
    """
    if missing := missing_program(executable):
        raise SolverError(missing)
    started, unchecked = time.monotonic(), dict(triangles or {})
    given = [word for name, value in variables.items() for word in ("-var", name, value)]
    with open(folder / SCREEN, "wb") as screen:
        process = subprocess.Popen(
            [*solver_command(ranks, executable, launcher, search, own_kernels), *given],
            cwd=folder,
            env=solver_environment(ranks, by_slurm=ranks > 1 and shlex.split(launcher)[0] == "srun"),
            stdin=subprocess.DEVNULL,
            stdout=screen,
            stderr=subprocess.STDOUT,
            # a launcher has to stop its ranks; the plain program's handler of SIGTERM may wait for a lock that it holds
            preexec_fn=die_with(os.getpid(), signal.SIGKILL if ranks == 1 else signal.SIGTERM),
        )
        try:
            _watch(process, folder, on_step, unchecked, Watch(patience))
        finally:
            _stop(process)
    code = process.returncode or (-signal.SIGTERM if ended_by_signal(folder / SCREEN) else 0)
    if code != 0:
        raise _error_of(code)(_last_words(folder, code))
    if unchecked:
        raise SolverError(f"{folder / SCREEN}: LIGGGHTS did not report the triangles of mesh {', '.join(unchecked)}.")
    return time.monotonic() - started


def _watch(
    process: subprocess.Popen, folder: Path, on_step: Callable[[int], None], triangles: dict[str, int], watch: Watch
) -> None:
    """Follow a run until it ends; every mesh is checked once, as soon as the solver has reported it.

    Raises SolverStoppedError for a solver that makes no step any more or fills the disk; the caller stops it.
    """
    ended = False
    with _handle(process) as handle:
        while not ended:
            ended = _ended(process, handle)
            step = last_step(folder / SCREEN)  # the log file lags behind: the solver buffers it
            if step is not None:
                on_step(step)
            if triangles:
                _check_triangles(folder, triangles)
            if not ended and (hangs := watch.look(step)):
                raise SolverStoppedError(f"{folder / DECK}: {hangs}; finished cycles and pieces stay, start again.")
            if not ended and free_bytes(folder) < RESERVE_BYTES:
                raise SolverStoppedError(f"{folder / DECK}: stopped before its disk is full. {full_sentence(folder)}")


@contextmanager
def _handle(process: subprocess.Popen) -> Iterator[int | None]:
    """Yield what the kernel marks as readable when a process ends; None where it has no such thing."""
    try:
        handle = os.pidfd_open(process.pid)
    except (AttributeError, OSError):
        yield None
        return
    try:
        yield handle
    finally:
        os.close(handle)


def _ended(process: subprocess.Popen, handle: int | None) -> bool:
    """Return whether a process ends within POLL_SECONDS; without a handle Python looks every 50 ms."""
    if handle is not None:
        return bool(select.select([handle], [], [], POLL_SECONDS)[0]) and process.wait() is not None
    try:
        process.wait(POLL_SECONDS)
    except subprocess.TimeoutExpired:
        return False
    return True


def _check_triangles(folder: Path, expected: dict[str, int]) -> None:
    """Compare the triangles that the solver kept with those written; what is checked leaves `expected`."""
    for mesh, written in list(expected.items()):
        try:
            kept = reported_triangles(folder / SCREEN, mesh)
        except SolverLogError:
            continue
        if kept != written:
            raise SolverError(
                f"{folder / DECK}: LIGGGHTS keeps {kept} of the {written} triangles of mesh {mesh}; allowed is every "
                "one, because it drops degenerate ones silently and the ids of all later ones shift."
            )
        del expected[mesh]


def _last_words(folder: Path, code: int) -> str:
    text = (folder / SCREEN).read_text("utf-8", "replace")
    cause = failure(text) or f"LIGGGHTS {exit_words(code)}"
    if free_bytes(folder) < RESERVE_BYTES:
        cause = f"{cause}; {full_sentence(folder).removesuffix('.')}"
    lines = deque((line for line in text.splitlines() if line.strip()), maxlen=LAST_LINES)
    quoted = "\n".join(f"    {line}" for line in lines)
    return f"{folder / DECK}: {cause}. Its last lines ({folder / SCREEN}):\n{quoted}"


def signal_of(code: int) -> int | None:
    """Return the signal that ended a program, None where none did; a launcher tells that of a rank as 128 plus it."""
    number = -code if code < 0 else code - OF_LAUNCHER
    return number if number in set(signal.Signals) else None


def _error_of(code: int) -> type[SolverError]:
    """Return the kind of error that an exit code is."""
    number = signal_of(code)
    if number is None:
        return SolverError
    return SolverCrashedError if number in CRASHES else SolverStoppedError


def exit_words(code: int) -> str:
    """Return how a program ended, in words."""
    number = signal_of(code)
    if number is None:
        return f"stopped with exit code {code}"
    if number == signal.SIGKILL:
        return "was killed (signal 9): the memory was exhausted and the system ended it, or somebody did"
    if number in CRASHES:
        return f"crashed ({signal.Signals(number).name}, signal {number})"
    return f"was ended by {signal.Signals(number).name} (signal {number})"


def _stop(process: subprocess.Popen) -> None:
    """End a solver, by force where it does not end by itself; one that hangs in the system is left behind."""
    if process.poll() is None:
        process.terminate()
        for last_resort in (process.kill, lambda: None):
            try:
                process.wait(STOP_SECONDS)
            except subprocess.TimeoutExpired:
                last_resort()


def die_with(parent: int, by: signal.Signals = signal.SIGTERM) -> Callable[[], None]:
    """Return what lets the kernel stop a child, such as the solver, when its parent dies; mpirun then stops its ranks.

    To be called in the child; parent: id of the process that starts it; by: what the child then gets
    """

    def before_exec() -> None:
        if sys.platform == "linux":
            ctypes.CDLL(None).prctl(_PARENT_DEATH_SIGNAL, by)
        if os.getppid() != parent:  # it died before the kernel was asked
            os._exit(1)

    return before_exec
