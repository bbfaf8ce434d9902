"""Faults of a machine under a run: its driver killed, its disk full, its solver hanging."""

from __future__ import annotations

import pickle
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

import psutil

from benchmarks.chaos_files import Outcome
from benchmarks.runs import SMALL_BUMPS, STRAIGHT_RAMP, simulated_run
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.engine.chain import Chain
from bulkwear.workflows.engine.patience import Patience

SETTINGS = {
    **SMALL_BUMPS,
    "fidelity": "quick",
    "packings": 1,
    "particle_scale": 4,
    "sample": {"width_mm": 40, "length_mm": 40, "element_size_mm": 2, **STRAIGHT_RAMP},
    "bed": {"width_mm": 60, "ahead_mm": 20, "behind_mm": 20},
    "sliding": {"run_in_mm": 10, "travel_mm": 20, "cycles": 2},
    "solver": {"rayleigh_fraction": 0.2, "checkpoint_interval_steps": 200},
}
STUDY, RUN = "demo", "R9_convex"
WEAR, SOLVER = "wear.csv", "liggghts"
ROOM = 400  # MB, of a disk that is not full
STILL_S = 1.0  # that a solver stands still at most, and that it goes on
LOOK_S = 0.05  # between two looks for a solver
LONGEST_S = 1800.0  # that a run of seconds may take on a busy machine
# The reserve is put off, or a disk of the test would never come to be full.
DRIVER = """
import pickle, sys
from bulkwear.workflows.engine import disk, solver
from bulkwear.workflows.engine.cycles import run_chain
from bulkwear.workflows.engine.job import project_job
if len(sys.argv) > 2:
    disk.RESERVE_BYTES = solver.RESERVE_BYTES = 0
with project_job("/dev/null"):
    run_chain(pickle.load(open(sys.argv[1], "rb")))
"""


def undisturbed(folder: Path) -> Chain:
    """Return a small run of two cycles in pieces, simulated to its end."""
    study = load_study(STUDY, overrides=SETTINGS)
    bed = study.bed_of(RUN)
    (folder / RUN).mkdir(parents=True)
    return simulated_run(
        Chain(
            name=RUN,
            folder=folder / RUN,
            case=study.case,
            parameters=study.run(RUN).parameters,
            surface=folder / RUN / "surface.vtu",
            bed=study.beds[bed],
            bed_restart=folder / "beds" / bed / "bed.restart",
        ),
        bed,
    )


def twin(chain: Chain, folder: Path) -> Chain:
    """Return the same run, begun anew in another folder from the same surface and bed."""
    other = replace(
        chain, folder=folder / RUN, surface=folder / RUN / "surface.vtu", bed_restart=folder / "beds" / "bed.restart"
    )
    for old, new in ((chain.surface, other.surface), (chain.bed_restart, other.bed_restart)):
        new.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(old, new)
    return other


def driver(chain: Chain, folder: Path, *words: str) -> subprocess.Popen:
    """Start a driver of a run; folder: where its words go. Words after it put the reserve of the disk off."""
    (folder / "chain.pickle").write_bytes(pickle.dumps(chain))
    with open(folder / "said.txt", "ab") as said:
        return subprocess.Popen(
            [sys.executable, "-c", DRIVER, str(folder / "chain.pickle"), *words], stdout=said, stderr=said
        )


def finished(process: subprocess.Popen) -> bool:
    """Wait for a driver; whether it came to its end well. One that hangs is killed."""
    try:
        return process.wait(LONGEST_S) == 0
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return False


def judge(outcome: Outcome, chain: Chain, expected: Chain, folder: Path, ended: bool) -> None:
    """Count what became of a run after its faults: its table is that of the undisturbed one, bit for bit."""
    said = (folder / "said.txt").read_text("utf-8", "replace")
    if "Traceback" in said:
        outcome.note("tracebacks", said[-2000:])
    elif not ended:
        outcome.note("lost", said[-2000:])
    elif (chain.folder / WEAR).read_bytes() != (expected.folder / WEAR).read_bytes():
        outcome.note("wrong", str(chain.folder))
    else:
        outcome.note("unchanged")


def killed(expected: Chain, folder: Path, kills: int, chance: random.Random, longest_s: float) -> Outcome:
    """Kill -9 a run's driver at random moments and start it again at once, until it ends; then the next run.

    longest_s: about how long an undisturbed run takes
    """
    outcome, done, number = Outcome("runs after kill -9 at random moments"), 0, 0
    while done < kills:
        here = folder / f"killed_{number}"
        here.mkdir()
        chain, ended = twin(expected, here), False
        while done < kills and not ended:
            process = driver(chain, here)
            try:
                ended = process.wait(chance.uniform(0.0, longest_s)) == 0
                break  # it came to its end before
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
                done += 1
        judge(outcome, chain, expected, here, ended or finished(driver(chain, here)))
        shutil.rmtree(here)
        number += 1
    outcome.what = f"runs after {done} kill -9 at random moments"
    return outcome


@contextmanager
def small_disk(megabytes: float) -> Iterator[Path]:
    """Give a disk of its own of that size; only root can."""
    folder = Path(tempfile.mkdtemp(prefix="small_disk_"))
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={int(1024 * megabytes)}k", "tmpfs", folder], check=True)
    try:
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)
        folder.rmdir()


def enlarge(folder: Path) -> None:
    """Make room on a small disk."""
    subprocess.run(["mount", "-o", f"remount,size={ROOM}m", folder], check=True)


def filled(expected: Chain, levels: int, momentary: bool, chance: random.Random, longest_s: float) -> Outcome:
    """Run on disks that are full after less and more of what a run writes; then, or meanwhile, there is room again.

    momentary: room is made while the run goes on
    """
    outcome = Outcome(f"runs on a disk that is full {'for a moment' if momentary else 'until somebody makes room'}")
    begin = sum(path.stat().st_size for path in (expected.surface, expected.bed_restart)) / 1e6
    whole = sum(path.stat().st_size for path in expected.folder.rglob("*") if path.is_file()) / 1e6
    for level in range(1, levels + 1):
        with small_disk(begin + whole * level / (levels + 1)) as here:
            words = Path(tempfile.mkdtemp(prefix="words_"))
            chain = twin(expected, here)
            process = driver(chain, words, "no reserve")
            if momentary:
                time.sleep(chance.uniform(0.0, longest_s))
                enlarge(here)
            ended = finished(process)
            enlarge(here)
            judge(outcome, chain, expected, words, ended or finished(driver(chain, words)))
            shutil.rmtree(words)
    return outcome


def stuttering(expected: Chain, folder: Path, count: int, chance: random.Random) -> Outcome:
    """Stop a run's solver and let it go on, again and again, as a machine does that swaps or sleeps."""
    outcome = Outcome("runs whose solver stands still now and then")
    for number in range(count):
        here = folder / f"stuttering_{number}"
        here.mkdir()
        chain = twin(expected, here)
        process = driver(chain, here)
        while process.poll() is None:
            with suppress(psutil.NoSuchProcess):
                for child in psutil.Process(process.pid).children(recursive=True):
                    child.suspend()
                    time.sleep(chance.uniform(0.0, STILL_S))
                    child.resume()
            time.sleep(chance.uniform(0.0, STILL_S))
        judge(outcome, chain, expected, here, process.returncode == 0)
        shutil.rmtree(here)
    return outcome


def hanging(expected: Chain, folder: Path, count: int) -> Outcome:
    """Stop a run's solver for good, as soon as it is there: it is ended and that is said; another start goes on."""
    outcome = Outcome("runs whose solver hangs")
    for number in range(count):
        here = folder / f"hanging_{number}"
        here.mkdir()
        chain = replace(twin(expected, here), patience=Patience(said_min=0.02, stopped_min=0.05))
        process = driver(chain, here)
        while process.poll() is None:
            with suppress(psutil.NoSuchProcess):
                for child in psutil.Process(process.pid).children(recursive=True):
                    if SOLVER in child.name():
                        child.suspend()
            time.sleep(LOOK_S)
        said = (here / "said.txt").read_text()
        if process.returncode == 0 or "reported no step for" not in said:
            outcome.note("hangs", said)
        else:
            judge(outcome, chain, expected, here, finished(driver(replace(chain, patience=Patience()), here)))
        shutil.rmtree(here)
    return outcome
