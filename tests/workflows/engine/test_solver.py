"""How the solver is started, watched and stopped."""

import os
import signal
import subprocess
import sys
import time
from collections import namedtuple
from pathlib import Path

import pytest

from bulkwear.workflows.engine import disk, solver
from bulkwear.workflows.engine.patience import LONGEST_LOOK_S, STOP_TIMES, Patience, Watch, patience_of
from bulkwear.workflows.engine.solver import SolverError, exit_words, run_deck

Usage = namedtuple("Usage", "total used free")
MINUTE = 60.0


def program(folder: Path, text: str) -> str:
    """A program that stands for the solver."""
    path = folder / "solver"
    path.write_text(f"#!{sys.executable}\nimport os, signal, sys, time\n{text}\n")
    path.chmod(0o755)
    return str(path)


@pytest.mark.parametrize("hangs", ["time.sleep(600)", "os.kill(os.getpid(), signal.SIGSTOP)"])
def test_a_hanging_solver_is_told_of_and_stopped(tmp_path, monkeypatch, hangs):
    """Without a step for a while that is said once; later the solver is stopped, also one that does not listen."""
    monkeypatch.setattr(solver, "STOP_SECONDS", 0.1)
    said = []
    patience = Patience(said_min=0.5 / MINUTE, stopped_min=1.0 / MINUTE, say=said.append)
    hanging = program(tmp_path, f"print('Step Atoms\\n7 10', flush=True)\n{hangs}")
    with pytest.raises(SolverError, match=r"deck.in: LIGGGHTS reported no step for .* minutes, after step 7, and was"):
        run_deck(tmp_path, executable=hanging, patience=patience)
    assert len(said) == 1 and "no step for" in said[0] and "after step 7" in said[0]


def test_a_slow_solver_is_no_hanging_one():
    """Every step begins the wait anew, and time in which the driver itself slept does not count."""
    now, said = [0.0], []
    watch = Watch(Patience(10.0, 120.0, said.append), clock=lambda: now[0])
    for step in range(200):
        now[0] += LONGEST_LOOK_S
        assert watch.look(step) is None
    now[0] += 1000.0 * MINUTE  # the machine was suspended
    assert watch.look(199) is None and not said
    while watch.look(199) is None:
        now[0] += LONGEST_LOOK_S
    assert len(said) == 1


def silent_minutes(watch: Watch, now: list[float], step: int | None) -> float:
    """How long a solver that hangs after a step is waited for, min."""
    began = now[0]
    while not (why := watch.look(step)):
        now[0] += LONGEST_LOOK_S
    assert f"after step {step}" in why if step else "since its start" in why
    return (now[0] - began) / MINUTE


@pytest.mark.parametrize("expected_min, taken_min", [(0.0, 0.0), (0.0, 20.0), (0.0, 100.0), (100.0, 0.0)])
def test_a_solver_of_few_lines_is_waited_for_longer(expected_min, taken_min):
    """Some times as long as it has taken between two steps, or is forecast to; one that hangs is stopped then."""
    now, said = [0.0], []
    patience = Patience(10.0, 120.0, said.append, expected_min)
    watch = Watch(patience, clock=lambda: now[0])
    for step in (1, 2):
        watch.look(step)
        for _ in range(round(taken_min * MINUTE / LONGEST_LOOK_S)):
            now[0] += LONGEST_LOOK_S
            assert watch.look(step) is None
    watch.look(3)
    said.clear()
    allowed = max(patience.stopped_min, STOP_TIMES * max(expected_min, taken_min))
    assert silent_minutes(watch, now, 3) == pytest.approx(allowed, abs=2.0 * LONGEST_LOOK_S / MINUTE)
    assert len(said) == 1 and f"is stopped after {allowed:.4g}" in said[0]


def test_a_solver_that_hangs_at_its_start_is_waited_for_by_the_forecast():
    """Before its first step nothing but the forecast is known."""
    now, expected_min = [0.0], 50.0
    watch = Watch(Patience(10.0, 120.0, lambda text: None, expected_min), clock=lambda: now[0])
    assert silent_minutes(watch, now, None) == pytest.approx(STOP_TIMES * expected_min, abs=LONGEST_LOOK_S / MINUTE)


def test_patience_is_a_setting_of_the_profile():
    """Resources of a job say it; what they do not say is the default. Ranks share what is expected."""
    assert patience_of({"no_step_said_min": 3, "no_step_stopped_min": 30}) == Patience(3.0, 30.0)
    assert patience_of({"threads": 2}) == Patience()
    assert patience_of({"step_core_min": 8}, ranks=4) == Patience(expected_min=2.0)


@pytest.mark.parametrize(
    "ends, said",
    [
        (signal.SIGKILL, "was killed .signal 9.: the memory was exhausted"),
        (signal.SIGSEGV, "crashed .SIGSEGV, signal 11."),
        (signal.SIGTERM, "was ended by SIGTERM"),
    ],
)
def test_a_crash_is_said_in_words(tmp_path, ends, said):
    """Signals end in words, of the solver itself and through a launcher, whose exit code holds them."""
    killed = program(tmp_path, f"os.kill(os.getpid(), {int(ends)})")
    with pytest.raises(SolverError, match=f"LIGGGHTS {said}"):
        run_deck(tmp_path, executable=killed)
    assert exit_words(128 + ends) == exit_words(-ends)


def test_a_solver_that_a_signal_ends_says_so_although_its_exit_code_is_0(tmp_path):
    """It writes a restart file of its own and reports no error: what it left is not the whole of its run."""
    ended = program(tmp_path, "print('WARNING: Forced restart written (./src/output.cpp:427)')")
    with pytest.raises(SolverError, match=r"deck.in: LIGGGHTS was ended by SIGTERM \(signal 15\)"):
        run_deck(tmp_path, executable=ended)
    run_deck(tmp_path, executable=program(tmp_path, "print('Loop time')"))


def test_other_exit_codes_are_numbers():
    """What is no signal stays a number."""
    assert exit_words(3) == "stopped with exit code 3"
    assert exit_words(255) == "stopped with exit code 255"


def test_a_solver_is_stopped_before_the_disk_is_full(tmp_path, monkeypatch):
    """With less than the reserve free, the solver is ended, and the sentence names the disk."""
    monkeypatch.setattr(disk.shutil, "disk_usage", lambda folder: Usage(10, 10, disk.RESERVE_BYTES - 1))
    started = time.monotonic()
    with pytest.raises(SolverError, match=r"stopped before its disk is full.*make room and start again"):
        run_deck(tmp_path, executable=program(tmp_path, "time.sleep(600)"))
    assert time.monotonic() - started < 300.0


def test_room_is_asked_for_before_a_cycle(tmp_path, monkeypatch):
    """A folder that is not there yet has its parent's disk; too little room is a sentence."""
    monkeypatch.setattr(disk.shutil, "disk_usage", lambda folder: Usage(10, 10, disk.RESERVE_BYTES + 1_000_000))
    disk.check_room(tmp_path / "new" / "folder", 900_000, "cycle 1")
    with pytest.raises(disk.DiskError, match=r"51 MB are free on the disk, allowed are at least 52 MB for cycle 1"):
        disk.check_room(tmp_path, 2_000_000, "cycle 1")


def test_a_full_disk_is_recognised_behind_other_faults():
    """Also where a library has wrapped it."""
    try:
        try:
            raise OSError(disk.errno.ENOSPC, os.strerror(disk.errno.ENOSPC))
        except OSError as fault:
            raise RuntimeError("cannot write") from fault
    except RuntimeError as fault:
        assert disk.is_full(fault)
    assert not disk.is_full(OSError(disk.errno.EACCES, "no"))


@pytest.mark.parametrize("handles", [True, False], ids=["by the kernel's handle", "by looking"])
def test_the_end_of_a_process_is_seen(monkeypatch, handles):
    """Where the kernel gives a handle, as here, and where it gives none; what still runs has not ended."""
    if not handles:
        monkeypatch.delattr(os, "pidfd_open")
    monkeypatch.setattr(solver, "POLL_SECONDS", 0.01)
    with subprocess.Popen(["cat"], stdin=subprocess.PIPE) as process, solver._handle(process) as handle:
        assert (handle is not None) == handles
        assert not solver._ended(process, handle)
        process.stdin.close()
        monkeypatch.setattr(solver, "POLL_SECONDS", 30.0)
        assert solver._ended(process, handle) and process.returncode == 0


DIES_S = 60.0  # s, at most: the kernel does it at once
PARENT = """\
import os, signal, subprocess, sys, time
from bulkwear.workflows.engine.solver import die_with
deaf = subprocess.Popen(
    ["sh", "-c", "trap '' TERM; echo; while :; do sleep 1; done"],
    stdout=subprocess.PIPE,
    preexec_fn=die_with(os.getpid(), signal.SIGKILL),
)
deaf.stdout.readline()
print(deaf.pid, flush=True)
time.sleep(600)
"""


def test_a_solver_that_heeds_no_signal_dies_with_its_driver():
    """As one whose handler of SIGTERM waits for a lock: the kernel kills it."""
    with subprocess.Popen([sys.executable, "-c", PARENT], stdout=subprocess.PIPE, text=True) as parent:
        deaf = int(parent.stdout.readline())
        parent.kill()
        parent.wait()
        deadline = time.monotonic() + DIES_S
        while is_alive(deaf):
            assert time.monotonic() < deadline, "it outlived its driver"
            time.sleep(0.01)


def is_alive(process: int) -> bool:
    """Whether a process is there and no zombie."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False
