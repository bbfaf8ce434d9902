"""What every job does alike: progress and faults go to the terminal and to the job's log."""

from __future__ import annotations

import contextlib
import os
import sys
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO


def let_jobs_import(root: Path) -> None:
    """Let the Python scripts of all jobs import this project's packages, wherever Snakemake puts the scripts."""
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(root), os.environ.get("PYTHONPATH")]))


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
def job_log(path: str | Path) -> Iterator[None]:
    """Copy standard error to a log. A fault of the user's or the solver's ends the job with its sentence alone.

    Faults are ValueError, RuntimeError and OSError of this project's own modules: their messages are sentences for
    people. The log gets the traceback too. Exit code 1.
    """
    with open(path, "a") as log, contextlib.redirect_stderr(_Both(sys.stderr, log)):
        print(time.strftime("--- started %Y-%m-%d %H:%M:%S"), file=log)
        try:
            yield
        except (ValueError, RuntimeError, OSError) as fault:
            print(f"\n{fault}\n", file=sys.stderr)
            traceback.print_exc(file=log)
            sys.exit(1)
        except Exception:
            traceback.print_exc(file=log)
            raise
