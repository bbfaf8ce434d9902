"""Drivers that a test kills, and the solvers that they leave."""

import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path

from tests import REPOSITORY
from tests.support.patience import LONGEST_S

DRIVER = """
import pickle, sys
from bulkwear.workflows.engine.cycles import run_chain
run_chain(pickle.load(open(sys.argv[1], "rb")))
"""


def start_driver(chain, folder: Path) -> subprocess.Popen:
    task = folder / "chain.pickle"
    task.write_bytes(pickle.dumps(chain))
    return subprocess.Popen([sys.executable, "-c", DRIVER, str(task)], cwd=REPOSITORY)


def kill_when(process: subprocess.Popen, moment) -> None:
    """SIGKILL the driver at a moment, and wait until its solver is gone too."""
    deadline = time.monotonic() + LONGEST_S
    while not moment():
        assert process.poll() is None, "the driver ended before the moment to kill it"
        assert time.monotonic() < deadline, "the moment to kill the driver never came"
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()


def solver_processes(folder: Path) -> list[int]:
    """Process ids of solvers that work below a folder."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and str(folder) in os.readlink(entry / "cwd"):
                found.append(int(entry.name))
        except OSError:
            continue
    return found


def wait_until_no_solver(folder: Path) -> None:
    deadline = time.monotonic() + LONGEST_S
    while solver_processes(folder):
        assert time.monotonic() < deadline, "a solver outlived its driver"
        time.sleep(0.05)
