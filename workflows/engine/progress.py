"""Progress of long work: what fraction is done and how long the rest will take, a line at a time."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TextIO

SECONDS_BETWEEN_LINES = 15.0
SMALLEST_BASIS = 0.01  # of the work; from less than that no time left is estimated


def duration_text(seconds: float) -> str:
    """Return a duration as people say it: 45 s, 3 min 20 s, 2 h 5 min."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    minutes, rest = divmod(whole, 60)
    return f"{minutes} min {rest} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"


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
