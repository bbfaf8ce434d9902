"""What every job does alike: progress with the time left, faults and progress in its log, tables written whole."""

from __future__ import annotations

import contextlib
import csv
import errno
import os
import re
import resource
import sys
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, TextIO

import bulkwear
from bulkwear.workflows.engine.disk import full_sentence, is_full
from bulkwear.workflows.engine.machine import machine_facts
from bulkwear.workflows.engine.project import enter_project

SECONDS_BETWEEN_LINES = 15.0
WITHOUT_THREAD = ("can't start new thread", os.strerror(errno.EAGAIN))  # Python's words, and those of C++
STARTED = "--- started %Y-%m-%d %H:%M:%S"  # begins what a log says of a start of its job
STOPPED = "Stopped by Ctrl-C. The same command goes on after the last finished cycle or piece."
TOOK = "--- took %.2f s of processor time itself, programs that it ran %.2f s"  # ends the log of a job that went well
UNITS = {"s": 1, "min": 60, "h": 3600}  # s, of durations
INTERRUPTED = 130  # exit code of what Ctrl-C has ended
SMALLEST_BASIS = 0.01  # of the work; from less than that no time left is estimated


def let_jobs_import() -> None:
    """Let the Python scripts of all jobs import this very package, wherever Snakemake puts the scripts, and first what
    lies in `at_start`.
    """
    beside, at_start = str(Path(bulkwear.__file__).parents[1]), str(Path(__file__).parent / "at_start")
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [beside, at_start, os.environ.get("PYTHONPATH")]))


class _Both:
    """A text stream that writes to two."""

    def __init__(self, first: TextIO, second: TextIO):
        self.streams = (first, second)

    def write(self, text: str) -> int:
        for stream in self.streams:
            stream.write(text)
            stream.flush()
        return len(text)

    def flush(self) -> None:
        """Nothing is buffered here."""


@contextlib.contextmanager
def project_job(log_path: str | Path) -> Iterator[None]:
    """Work in the project of the working directory, and copy standard error to a log.

    A fault of the user's or the solver's ends the job with its sentence alone, exit code 1. Faults are ValueError,
    RuntimeError and OSError of our own modules: their messages are sentences. So are a full disk and exhausted memory,
    wherever they strike. The log gets the traceback too. Ctrl-C ends it with a line in the log alone: on the terminal
    it is said once for all jobs, see `terminal`.
    """
    with open(log_path, "a") as log, contextlib.redirect_stderr(_Both(sys.stderr, log)):
        print(time.strftime(STARTED), file=log)
        try:
            enter_project(Path.cwd())
            yield
            spent = (resource.getrusage(of) for of in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
            print(TOOK % tuple(each.ru_utime + each.ru_stime for each in spent), file=log)
        except KeyboardInterrupt:
            print(STOPPED, file=log)
            sys.exit(INTERRUPTED)
        except (ValueError, RuntimeError, OSError, MemoryError) as fault:
            print(f"\n{sentence(fault)}\n", file=sys.stderr)
            traceback.print_exc(file=log)
            sys.exit(1)
        except Exception:
            traceback.print_exc(file=log)
            raise


def processor_seconds_of(log: Path) -> tuple[float, float] | None:
    """Return the processor time (s) of a job itself and of the programs that it ran, of all its starts that went well;
    None where its log tells of none.
    """
    told = re.findall(re.escape(TOOK).replace(r"%\.2f", r"([\d.]+)"), log.read_text("utf-8", "replace"))
    return tuple(sum(map(float, times)) for times in zip(*told, strict=True)) if told else None


def is_exhausted(fault: BaseException) -> bool:
    """Return whether a fault is of the machine's memory; libraries tell a thread without memory by its errno alone."""
    of_threads = isinstance(fault, RuntimeError) and str(fault) in WITHOUT_THREAD
    return isinstance(fault, MemoryError) or of_threads or getattr(fault, "errno", None) == errno.ENOMEM


def sentence(fault: BaseException) -> str:
    """Return a fault in one sentence; those of the machine say what it lacks and what to do."""
    if is_full(fault):
        return full_sentence(Path.cwd())
    if is_exhausted(fault):
        return (
            f"The memory is exhausted, {machine_facts()['memory_gb']} GB for all jobs together; start again with fewer"
            " of them side by side (--cores 1), or with larger elements or a larger particle_scale. Finished cycles and"
            " pieces stay."
        )
    return str(fault)


def duration_text(seconds: float) -> str:
    """Return a duration as people say it: 45 s, 3 min 20 s, 2 h 5 min."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    minutes, rest = divmod(whole, 60)
    return f"{minutes} min {rest} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"


def seconds_of(text: str) -> float:
    """Return the seconds of a duration as `duration_text` says it; it rounds, so they are those of its last unit."""
    words = text.split()
    return float(sum(int(number) * UNITS[unit] for number, unit in zip(words[::2], words[1::2], strict=True)))


class Progress:
    """Prints the progress of `total` units of work, `done` of them finished before; the rate is this process's own."""

    def __init__(
        self,
        name: str,
        total: int,
        done: int = 0,
        stream: TextIO | None = None,
        clock: Callable[[], float] = time.monotonic,
    ):
        self.name, self.total, self.stream, self.clock = name, total, stream or sys.stderr, clock
        self.start, self.start_time = done, clock()
        self.last_line = float("-inf")

    def update(self, done: int, what: str) -> None:
        """Print a line if the last one is old enough; `what` names the present part of the work."""
        now = self.clock()
        if now - self.last_line < SECONDS_BETWEEN_LINES or done - self.start < SMALLEST_BASIS * self.total:
            return
        self.last_line = now
        left = (self.total - done) * (now - self.start_time) / (done - self.start)
        percent = 100.0 * done / max(self.total, 1)
        self.say(f"{what}, {percent:.0f} % of the run, about {duration_text(left)} left")

    def say(self, text: str) -> None:
        """Print a line at once."""
        print(f"{self.name}: {text}", file=self.stream, flush=True)


def write_table(path: Path, rows: list[Mapping[str, Any]]) -> None:
    """Write rows with the same keys as CSV, whole or not at all."""
    part = path.with_suffix(".csv.part")
    with open(part, "w", newline="") as stream:
        table = csv.DictWriter(stream, fieldnames=list(rows[0]))
        table.writeheader()
        table.writerows(rows)
    os.replace(part, path)
