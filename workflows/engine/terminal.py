"""What the terminal says besides Snakemake's own lines: one line after Ctrl-C, and what follows from jobs that end."""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import sys
from collections.abc import Callable
from types import FrameType, TracebackType

from bulkwear.workflows.engine.job import INTERRUPTED, STOPPED

FINISHED = "job_finished"  # as Snakemake names the event
LONGEST_REASON = 300  # letters, of why a job runs; a page's would name a hundred files


class Terminal(logging.Filter):
    """Listens to a logger and shortens long reasons; lets no line through once Ctrl-C was pressed, as errors
    of all jobs would follow.

    on_finished: called with the id of each job that ends
    """

    def __init__(self, say: Callable[[str], None] = lambda text: print(text, file=sys.stderr, flush=True)):
        super().__init__()
        self.say, self.stopped = say, False
        self.on_finished: Callable[[int], None] = lambda job: None

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether a line is shown."""
        reason = getattr(record, "reason", None)
        if isinstance(reason, str) and len(reason) > LONGEST_REASON:
            shown = reason[:LONGEST_REASON].rpartition(", ")[0]
            record.reason = f"{shown} and {reason.count(', ', len(shown))} more"
        if str(getattr(record, "event", "")) == FINISHED and not self.stopped:
            self.on_finished(record.job_id)
        return not self.stopped

    def stop(self, number: int, frame: FrameType | None) -> None:
        """Handle Ctrl-C: say how to go on and let Snakemake end its jobs; pressed once more, end at once."""
        if self.stopped:
            os._exit(INTERRUPTED)
        self.stopped = True
        self.say(f"\n{STOPPED}")
        raise KeyboardInterrupt

    def unhandled(self, kind: type[BaseException], fault: BaseException, trace: TracebackType | None) -> None:
        """Show what nothing has handled, but Ctrl-C."""
        if not (self.stopped and issubclass(kind, KeyboardInterrupt)):
            sys.__excepthook__(kind, fault, trace)


def listen(logger: logging.Logger) -> Terminal:
    """Return what listens to a logger and to Ctrl-C from now on; to Ctrl-C where that is the main thread's."""
    terminal = Terminal()
    logger.addFilter(terminal)
    with contextlib.suppress(ValueError):
        signal.signal(signal.SIGINT, terminal.stop)
    sys.excepthook = terminal.unhandled
    return terminal
