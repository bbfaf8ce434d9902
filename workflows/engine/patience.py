"""How long a solver that makes no step is waited for: it may hang, or its file system may be gone."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

SAY_RESOURCE, STOP_RESOURCE = "no_step_said_min", "no_step_stopped_min"  # minutes, default-resources of a profile
EXPECTED_RESOURCE = "step_core_min"  # by the forecast, of a job's rule
SAY_TIMES, STOP_TIMES = 2.0, 4.0  # -, over the longest wait so far or forecast: what a healthy solver may take
LONGEST_LOOK_S = 5.0  # that counts between two looks: a driver that slept itself has not seen the solver idle
SECONDS_PER_MINUTE = 60.0


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


@dataclass(frozen=True)
class Patience:
    """Minutes without a step after which that is said, and after which the solver is stopped; say: how it is said.

    expected_min: minutes between two steps that the solver reports, by the forecast; both limits grow with it
    """

    said_min: float = 10.0
    stopped_min: float = 120.0
    say: Callable[[str], None] = _say
    expected_min: float = 0.0


PATIENCE = Patience()


def patience_of(resources: Mapping[str, Any], ranks: int = 1) -> Patience:
    """Return the patience that a job's resources ask for, as a profile and its rule set them."""
    given = {"said_min": SAY_RESOURCE, "stopped_min": STOP_RESOURCE}
    minutes = {name: float(resources[key]) for name, key in given.items() if resources.get(key) is not None}
    return Patience(**minutes, expected_min=float(resources.get(EXPECTED_RESOURCE) or 0.0) / ranks)


class Watch:
    """Counts for how long the solver has made no step; only time that the driver itself was awake counts.

    A solver that has taken long between two steps, or is expected to, is waited for longer than a profile says.
    """

    def __init__(self, patience: Patience, clock: Callable[[], float] = time.monotonic):
        self.patience, self.clock = patience, clock
        self.step: int | None = None
        self.last_look, self.silent_s, self.said = clock(), 0.0, False
        self.longest_min = patience.expected_min

    def look(self, step: int | None) -> str | None:
        """Take the last step that the solver has reported; return why it is to be stopped, None where it is not."""
        now = self.clock()
        self.silent_s += min(now - self.last_look, LONGEST_LOOK_S)
        self.last_look = now
        if step != self.step:
            self.longest_min = max(self.longest_min, self.silent_s / SECONDS_PER_MINUTE)
            self.step, self.silent_s, self.said = step, 0.0, False
        minutes, patience = self.silent_s / SECONDS_PER_MINUTE, self.patience
        after = "since its start" if step is None else f"after step {step}"
        stopped_min, why = max(
            (patience.stopped_min, f"{STOP_RESOURCE} of the profile"),
            (STOP_TIMES * self.longest_min, f"{STOP_TIMES:g} times the longest wait so far or forecast"),
        )
        if minutes >= stopped_min:
            return f"LIGGGHTS reported no step for {minutes:.3g} minutes, {after}, and was stopped ({why})"
        if minutes >= max(patience.said_min, SAY_TIMES * self.longest_min) and not self.said:
            self.said = True
            patience.say(
                f"no step for {minutes:.3g} minutes, {after}; the solver is stopped after {stopped_min:.4g} ({why})"
            )
        return None
