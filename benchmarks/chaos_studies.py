"""Faults round a study in Snakemake: it is killed or started twice, clocks jump, no network, nothing can be written."""

from __future__ import annotations

import os
import random
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.chaos_files import Outcome
from benchmarks.chaos_runs import finished

ROOT = Path(__file__).parents[1]
STUDY = "tiny"
SUMMARY = f"results/{STUDY}/summary.csv"
SETTINGS = """\
title: A tiny study
question: Does nothing get lost?
design: demo.csv
rows: [R9]
surfaces: [plain]
packings: 1
fidelities:
  quick:
    particle_scale: 4
    sample: {width_mm: 40, length_mm: 40, element_size_mm: 2}
    bed: {width_mm: 60, ahead_mm: 20, behind_mm: 20}
    sliding: {run_in_mm: 10, travel_mm: 20, cycles: 2}
"""
YEARS = 10.0 * 365.25 * 24 * 3600.0  # s, by which a clock jumps at most
# nothing but the machine itself, which MPI talks to
WITHOUT_NETWORK = ("unshare", "--net", "sh", "-c", 'ip link set lo up && exec "$@"', "sh")
# a user who owns nothing and has no home: the code can be read only
NOBODY_ID = 65534
NOBODY = ("setpriv", f"--reuid={NOBODY_ID}", f"--regid={NOBODY_ID}", "--clear-groups", "env", "HOME=/nonexistent")
AT_WORK = "another Snakemake"
READ_ONLY = ("Read-only file system", "Write-protected output files")  # as Snakemake says it where outputs are there


def new_study(folder: Path) -> Path:
    """Write a project with one tiny study into a folder, and return it."""
    (folder / "config" / "studies").mkdir(parents=True)
    (folder / "config" / "studies" / f"{STUDY}.yaml").write_text(SETTINGS, encoding="utf-8")
    return folder


def start(folder: Path, before: Sequence[str] = ()) -> subprocess.Popen:
    """Start Snakemake on the study of a folder; what it says goes to a file there. before: a command that starts it."""
    choices = ("--snakefile", ROOT / "Snakefile", "--workflow-profile", ROOT / "workflows/profiles/default")
    # jobs of a killed Snakemake live on and still speak
    with open(words(folder), "ab") as said:
        return subprocess.Popen(
            [*before, sys.executable, "-m", "snakemake", *choices, "--directory", folder, SUMMARY],
            stdout=said,
            stderr=said,
            start_new_session=True,
        )


def words(folder: Path) -> Path:
    """Return the file with all that was said on a study, which is not in its folder: that may be read-only."""
    return folder.with_suffix(".txt")


def finished_study(folder: Path) -> float:
    """Run a study undisturbed; return the seconds that it took. Raises RuntimeError where it fails."""
    started = time.monotonic()
    if not finished(start(new_study(folder))):
        raise RuntimeError(words(folder).read_text("utf-8", "replace")[-2000:])
    return time.monotonic() - started


def judge(outcome: Outcome, folder: Path, expected: Path, ended: bool) -> None:
    """Count what became of a study: its summary is that of the undisturbed one, bit for bit."""
    said = words(folder).read_text("utf-8", "replace")
    if "Traceback" in said:
        outcome.note("tracebacks", said[-2000:])
    elif not ended:
        outcome.note("lost", said[-2000:])
    elif (folder / SUMMARY).read_bytes() != (expected / SUMMARY).read_bytes():
        outcome.note("wrong", str(folder))
    else:
        outcome.note("unchanged")


def killed(expected: Path, folder: Path, kills: int, chance: random.Random, longest_s: float) -> Outcome:
    """Kill -9 Snakemake alone at random moments, its jobs live on, and start it again at once; the last one ends."""
    outcome = Outcome(f"studies after {kills} kill -9 of Snakemake alone")
    here = new_study(folder / "killed")
    for _ in range(kills):
        process = start(here)
        try:
            process.wait(chance.uniform(0.2, 1.0) * longest_s)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    judge(outcome, here, expected, finished(start(here)))
    return outcome


def twice(expected: Path, folder: Path, count: int, chance: random.Random, longest_s: float) -> Outcome:
    """Start a second Snakemake on a study while the first is at work."""
    outcome = Outcome("studies with two Snakemakes at once")
    for number in range(count):
        here = new_study(folder / f"twice_{number}")
        first = start(here)
        time.sleep(chance.uniform(0.0, longest_s))
        second = finished(start(here))  # refused, or there was nothing left to do
        told = second or AT_WORK in words(here).read_text("utf-8", "replace")
        judge(outcome, here, expected, finished(first) and told and finished(start(here)))
    return outcome


def clock_steps(expected: Path, folder: Path, steps: int, chance: random.Random, longest_s: float) -> Outcome:
    """Stop a study at random moments and date its files years back or ahead, each by its own step; then it ends."""
    outcome = Outcome(f"studies after {steps} steps of the clock, of every file")
    here = new_study(folder / "clock")
    for _ in range(steps):
        process = start(here)
        try:
            process.wait(chance.uniform(0.2, 1.0) * longest_s)
        except subprocess.TimeoutExpired:
            process.terminate()
            process.wait()
        for path in (here / "results").rglob("*"):
            if path.is_file():
                moment = time.time() + chance.uniform(-YEARS, YEARS)
                os.utime(path, (moment, moment))
    judge(outcome, here, expected, finished(start(here)))
    return outcome


def without_network(expected: Path, folder: Path) -> Outcome:
    """Run a study where no network is, not even the machine's own."""
    outcome = Outcome("studies without a network")
    here = new_study(folder / "offline")
    judge(outcome, here, expected, finished(start(here, WITHOUT_NETWORK)))
    return outcome


def is_open_to_nobody() -> bool:
    """Return whether a user who owns nothing can read this clone and run its Python."""
    tried = [*NOBODY, sys.executable, "-c", "import bulkwear.workflows"]
    return subprocess.run(tried, cwd="/", capture_output=True).returncode == 0


def as_nobody(expected: Path, folder: Path) -> Outcome:
    """Run a study as a user who owns nothing but the study's folder."""
    outcome = Outcome("studies of a user without a home, the code read-only")
    folder.chmod(0o755)  # temporary folders are their owner's
    here = new_study(folder / "nobody")
    (here / "cache").mkdir()
    for path in (here, *here.rglob("*")):
        os.chown(path, NOBODY_ID, NOBODY_ID)
    cache = ("env", f"XDG_CACHE_HOME={here / 'cache'}")
    judge(outcome, here, expected, finished(start(here, (*NOBODY, *cache))))
    return outcome


def unwritable(expected: Path, folder: Path) -> Outcome:
    """Start a study half of which is done where nobody may write; once somebody may again, it ends."""
    outcome = Outcome("studies in a folder that is read-only")
    here = new_study(folder / "unwritable")
    shutil.copytree(expected / "results", here / "results")
    shutil.rmtree(here / "results" / STUDY / "logs")
    (here / SUMMARY).unlink()
    (here / "results" / STUDY / "R9_plain" / "wear.csv").unlink()
    results = here / "results"
    subprocess.run(["mount", "--bind", results, results], check=True)
    try:
        subprocess.run(["mount", "-o", "remount,ro,bind", results], check=True)
        refused = not finished(start(here))
        said = words(here).read_text("utf-8", "replace")
    finally:
        subprocess.run(["umount", results], check=True)
    judge(outcome, here, expected, finished(start(here)) and refused and any(each in said for each in READ_ONLY))
    return outcome


def studies(folder: Path, counts: dict[str, int], chance: random.Random) -> Iterator[Outcome]:
    """Yield what came of all of them; those that need root are left out without it. counts: see `chaos.WHOLE`."""
    expected = folder / "expected"
    longest_s = finished_study(expected)
    given = (expected, folder)
    yield killed(*given, counts["snakemakes"], chance, longest_s)
    yield twice(*given, counts["twins"], chance, longest_s)
    yield clock_steps(*given, counts["clocks"], chance, longest_s)
    if os.geteuid() == 0:
        yield without_network(*given)
        yield unwritable(*given)
        if is_open_to_nobody():
            yield as_nobody(*given)
