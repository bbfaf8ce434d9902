"""The folder of a study before Snakemake works in it: nobody else does, it can be written, no file is of the future."""

from __future__ import annotations

import fcntl
import os
import time
from pathlib import Path
from typing import TextIO

from bulkwear.workflows.engine.state import HELD_BY_ANOTHER, no_lock

LOCK = ".snakemake_lock"
AHEAD_S = 2.0  # by which the clock of a file server may be ahead


class StudyFolderError(Exception):
    """A study's folder cannot be worked in."""


def take(folder: Path) -> TextIO:
    """Return the lock of a study's folder, held until it is closed or the process ends, however it does.

    Raises StudyFolderError where another Snakemake holds it, or nothing can be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = open(folder / LOCK, "a+", encoding="utf-8")  # noqa: SIM115  held until the process ends
    except OSError as fault:
        raise StudyFolderError(f"{folder}: {fault.strerror}; a study needs a folder that it can write to.") from None
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as fault:
        if fault.errno not in HELD_BY_ANOTHER:
            lock.close()
            raise StudyFolderError(no_lock(folder, fault)) from None
        lock.seek(0)
        other = lock.read().strip() or "unknown"
        lock.close()
        raise StudyFolderError(
            f"{folder}: another Snakemake (process {other}) is at work on this study; nothing was changed, start again"
            " when it has ended."
        ) from None
    lock.truncate(0)
    lock.write(str(os.getpid()))
    lock.flush()
    return lock


def date_back(folder: Path) -> int:
    """Date files of a folder that are of the future now, and return how many they were.

    They are left by a clock that was set back. Snakemake refuses what it makes of them: it would be older than they.
    """
    now = time.time()
    ahead = [path for path in folder.rglob("*") if path.is_file() and path.stat().st_mtime > now + AHEAD_S]
    for path in ahead:
        os.utime(path)
    return len(ahead)
