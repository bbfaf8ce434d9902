"""Room on the disk: a full disk is recognised in whatever went wrong, and seen before it is full."""

from __future__ import annotations

import errno
import shutil
from pathlib import Path

from bulkwear.postproc.readers.restart_file import RestartFile, RestartFileError, read_restart

FULL = {errno.ENOSPC, errno.EDQUOT}
RESERVE_BYTES = 50_000_000  # that stay free: logs, states and tables of a cycle that ends, of all runs side by side
MEGABYTE, GIGABYTE = 1e6, 1e9
FEW = "few"  # value of solver.kept_restarts
LAST_RESTARTS, RESTART_EVERY = 2, 10  # cycles that keep their restart files then: the last ones, and every tenth


class DiskError(RuntimeError):
    """There is too little room on the disk; the message names the folder, what is free and what is allowed."""


def free_bytes(folder: Path) -> int:
    """Return how much a folder's disk still takes; of a folder that is to be made, its nearest parent's."""
    while not folder.exists():
        folder = folder.parent
    return shutil.disk_usage(folder).free


def is_full(fault: BaseException) -> bool:
    """Return whether a fault, or what caused it, is that of a full disk or a used-up quota."""
    seen: BaseException | None = fault
    while seen is not None:
        if isinstance(seen, OSError) and seen.errno in FULL:
            return True
        seen = seen.__cause__ or seen.__context__
    return False


def full_sentence(folder: Path) -> str:
    """Return in one sentence that a folder's disk is full, and what to do."""
    return (
        f"{folder}: the disk is full, nearly full, or a quota is used up, {bytes_text(free_bytes(folder))} are free;"
        " make room and start again, finished cycles and pieces stay."
    )


def check_room(folder: Path, needed: float, what: str) -> None:
    """Raise DiskError where a folder's disk has not so many bytes besides the reserve. what: that needs them"""
    if (free := free_bytes(folder)) < needed + RESERVE_BYTES:
        raise DiskError(
            f"{folder}: {bytes_text(free)} are free on the disk, allowed are at least"
            f" {bytes_text(needed + RESERVE_BYTES)} for {what}; make room and start again, finished cycles and pieces"
            " stay."
        )


def whole_restart(path: Path) -> RestartFile:
    """Return what a restart file of the solver holds. Raises DiskError for one that is not whole on a full disk,
    RestartFileError for one on any other.
    """
    try:
        return read_restart(path)
    except RestartFileError as fault:
        if free_bytes(path.parent) < RESERVE_BYTES:
            raise DiskError(f"{fault} {full_sentence(path.parent)}") from fault
        raise RestartFileError(
            f"{fault} The disk was full for a moment, or the file was changed; start again, finished cycles and pieces"
            " stay."
        ) from fault


def folder_bytes(folder: Path) -> int:
    """Return the bytes of a folder's files, 0 without it."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def bytes_text(count: float) -> str:
    """Return a number of bytes as people say it."""
    return f"{count / GIGABYTE:.3g} GB" if count >= GIGABYTE else f"{count / MEGABYTE:.3g} MB"
