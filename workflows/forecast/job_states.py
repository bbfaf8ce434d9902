"""State of the jobs of a study that runs, from the files that they leave: nothing is locked or written."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from bulkwear.postproc.readers.cycle_folders import cycle_folders
from bulkwear.workflows.engine.job import STARTED, seconds_of
from bulkwear.workflows.engine.job import STOPPED as STOPPED_LINE
from bulkwear.workflows.engine.records import RecordError, read_record
from bulkwear.workflows.engine.solver import LOG
from bulkwear.workflows.engine.state import LOCK, STATE

DONE, RUNNING, WAITING, STOPPED, FAILED = "done", "running", "waiting", "stopped", "failed"
RUN, BED = "worn_run_", "settled_bed_"  # begin the names of jobs that have a folder of their own
PRODUCTS = {RUN: ("wear.csv", "cost.csv"), BED: ("bed.restart", "cost.csv")}  # Snakemake removes them before a job
# Jobs whose simulations have folders within one of the study's: folder by job. Its lock does not tell which job has it.
BULK_TESTS = {"calibrated_parameters": "simulations", "box_sizes": "simulations", "packing_profiles": "packings"}
RECENT = 60.0  # s, in which the log of a job on another machine changes; solvers write a line every few seconds
LOCKS = Path("/proc/locks")
LEFT = re.compile(r", (\d+) % of the run, about (.+) left$", re.MULTILINE)
RESUMED = re.compile(r": resumes after |goes on after step ")
TRACEBACK = "Traceback (most recent call last)"
KIND_OF_FAULT = re.compile(r"^[\w.]+(?:Error|Exception): ")


@dataclass(frozen=True)
class JobState:
    """A job as its files tell it.

    job, name: as in forecasts, and of its run or bed; state: one of the words above
    cycles: finished wear cycles, None before the first cycle 0 and for jobs without cycles; worn_m3: by the wear law,
    of all of them; left_s, taken_s: time left by its own log, and wall time so far, of a whole job only; None where
    they are not known; said: why it failed
    """

    job: str
    name: str
    state: str
    cycles: int | None = None
    worn_m3: float | None = None
    left_s: float | None = None
    taken_s: float | None = None
    said: str = ""


def locked_files(table: Path = LOCKS) -> set[tuple[int, int]]:
    """Return (device, inode) of the files that processes of this machine have locked; none where Linux tells none."""
    try:
        lines = table.read_text("utf-8").splitlines()
    except OSError:
        return set()
    places = [line.split()[-3].split(":") for line in lines if " FLOCK " in line and " -> " not in line]
    return {(os.makedev(int(major, 16), int(minor, 16)), int(inode)) for major, minor, inode in places}


def job_state(study: Path, job: str, locked: Collection[tuple[int, int]], now: float | None = None) -> JobState:
    """Return the state of a job. study: results/<study>; locked: as from `locked_files`; now: s since 1970"""
    kind = next((kind for kind in PRODUCTS if job.startswith(kind)), "")
    name = job.removeprefix(kind)
    folder = {RUN: study / name, BED: study / "beds" / name}.get(kind)
    log, now = study / "logs" / f"{job}.log", time.time() if now is None else now
    said, changed = _last_start(log), _changed(log, [folder] if folder else _bulk_tests(study, job))
    cycles, worn = _worn(folder) if kind == RUN else (None, None)
    told = JobState(job, name, WAITING, cycles, worn)
    if folder and _is_locked(folder / LOCK, locked):
        return _running(told, said, log, now)
    if _is_done(study, job, folder, kind):
        return _with(told, state=DONE, taken_s=_seconds_taken(study, job, folder))
    if TRACEBACK in said:
        return _with(told, state=FAILED, said=_fault(said))
    if STOPPED_LINE in said:
        return _with(told, state=STOPPED)
    if said and now - changed < RECENT:
        return _running(told, said, log, now)
    return _with(told, state=STOPPED) if said else told


def _with(told: JobState, **changes: object) -> JobState:
    return JobState(**{**vars(told), **changes})


def _running(told: JobState, said: str, log: Path, now: float) -> JobState:
    """Return a job that runs: what its last line of progress says, less the time since then."""
    lines = LEFT.findall(said)
    if not lines:
        return _with(told, state=RUNNING)
    written = log.stat().st_mtime
    left = max(seconds_of(lines[-1][1]) - (now - written), 0.0)
    begun = time.mktime(time.strptime(said.splitlines()[0], STARTED))
    return _with(told, state=RUNNING, left_s=left, taken_s=None if RESUMED.search(said) else max(now - begun, 0.0))


def _last_start(log: Path) -> str:
    """Return what a log says since its job was last started, "" where it was not."""
    try:
        text = log.read_text("utf-8", "replace")
    except OSError:
        return ""
    begin = STARTED.partition("%")[0]
    return begin + text.rpartition(begin)[2] if begin in text else ""


def _bulk_tests(study: Path, job: str) -> list[Path]:
    """Return the folders of a job's bulk tests, none of a job without."""
    return list((study / BULK_TESTS[job]).glob("*/")) if job in BULK_TESTS else []


def _changed(log: Path, folders: Iterable[Path]) -> float:
    """Return when a job last wrote into its log, or its solver into its own; 0 where neither is there."""
    solver = [path for folder in folders for path in (*folder.glob(f"cycle_*.part/{LOG}"), folder / LOG)]
    return max((path.stat().st_mtime for path in (log, *solver) if path.is_file()), default=0.0)


def _is_locked(lock: Path, locked: Collection[tuple[int, int]]) -> bool:
    try:
        found = lock.stat()
    except OSError:
        return False
    return (found.st_dev, found.st_ino) in locked


def _is_done(study: Path, job: str, folder: Path | None, kind: str) -> bool:
    if folder:
        return all((folder / name).is_file() for name in PRODUCTS[kind])
    measured, log = study / "logs" / f"{job}.benchmark.tsv", study / "logs" / f"{job}.log"  # Snakemake's, at the end
    return measured.is_file() and not (log.is_file() and log.stat().st_mtime > measured.stat().st_mtime)


def _worn(folder: Path) -> tuple[int | None, float | None]:
    """Return how many wear cycles of a run are finished, and what they wore (m3); None where that is not known."""
    found = cycle_folders(folder)
    if not found:
        return None, None
    try:
        row = read_record(found[-1] / STATE).get("wear", {})
    except (OSError, RecordError):  # moved, or damaged, which the run itself will tell
        row = {}
    return len(found) - 1, row.get("total_worn_volume_m3")


def _seconds_taken(study: Path, job: str, folder: Path | None) -> float | None:
    """Return the wall time (s) of a job that is done, of all its starts."""
    if folder:
        table = pd.read_csv(folder / "cost.csv")
        return float(table[[name for name in ("solver_s", "other_s") if name in table]].sum().sum())
    return float(pd.read_csv(study / "logs" / f"{job}.benchmark.tsv", sep="\t")["s"].sum())


def _fault(said: str) -> str:
    """Return the last line of a log with a traceback, which is the fault's sentence."""
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    return KIND_OF_FAULT.sub("", lines[-1])
