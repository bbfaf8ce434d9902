"""How far a motion is at a time: courses that a translation or a turn follows, and the solver's formulas of their pace.

LIGGGHTS (3.8.0) adds up speeds step by step. The formulas are what a course goes in a step, over the step, so that the
sum is the course itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Steady:
    """A course whose pace grows from 0 to 1 (per s) within `ramp_s` after `start_s`, and back to 0 after `stop_s`."""

    start_s: float = 0.0
    ramp_s: float = 0.0
    stop_s: float = math.inf

    def __post_init__(self) -> None:
        if not (0.0 <= self.ramp_s < math.inf and -math.inf < self.start_s <= self.stop_s - self.ramp_s):
            raise ValueError(
                f"a motion starts at {self.start_s} s, with a ramp of {self.ramp_s} s, and stops at {self.stop_s} s; "
                "allowed are a ramp >= 0 s and a stop after the ramp"
            )

    @property
    def end_s(self) -> float:
        """When the course is over, s."""
        return self.stop_s + self.ramp_s

    def gone(self, time_s: float) -> float:
        """Return how far the course is at that time, s at full pace: a ramp counts half."""
        return self._since(time_s - self.start_s) - self._since(time_s - self.stop_s)

    def _since(self, time_s: float) -> float:
        if self.ramp_s == 0.0 or time_s <= 0.0:
            return max(time_s, 0.0)
        over = max(time_s - self.ramp_s, 0.0)
        return (time_s - over) * (time_s + over) / (2.0 * self.ramp_s)

    def pace(self, time_s: float) -> float | None:
        """Return the pace from that time on where it does not change any more, else None."""
        if time_s >= self.end_s:
            return 0.0
        return 1.0 if time_s >= self.start_s + self.ramp_s and math.isinf(self.stop_s) else None

    def mean_pace(self, end: str) -> str:
        """Return the solver's formula of the mean pace in the step that ends at the time in the variable `end`."""
        return f"({self._formula(end)}-({self._formula(f'{end}-dt')}))/dt"

    def _formula(self, time: str) -> str:
        moments = [self.start_s] if math.isinf(self.stop_s) else [self.start_s, self.stop_s]
        return "-".join(self._since_formula(time, moment) for moment in moments)

    def _since_formula(self, time: str, moment: float) -> str:
        since = _positive_part(f"{time}-{number(moment)}")
        if self.ramp_s == 0.0:
            return since
        over = _positive_part(f"{time}-{number(moment + self.ramp_s)}")
        return f"({since}-{over})*({since}+{over})/{number(2.0 * self.ramp_s)}"


@dataclass(frozen=True)
class Swinging:
    """A course that swings between -1 and 1, sin(2 pi time / period + phase)."""

    period_s: float
    phase_rad: float = 0.0

    def __post_init__(self) -> None:
        if not (0.0 < self.period_s < math.inf and math.isfinite(self.phase_rad)):
            raise ValueError(f"a motion swings with a period of {self.period_s} s, allowed is a number above 0 s")

    def gone(self, time_s: float) -> float:
        """Return where the course is at that time."""
        return math.sin(2.0 * math.pi * math.fmod(time_s, self.period_s) / self.period_s + self.phase_rad)

    def pace(self, time_s: float) -> float | None:
        """Return None: the pace always changes."""

    def mean_pace(self, end: str) -> str:
        """Return the solver's formula of the mean pace in the step that ends at the time in the variable `end`.

        sin a - sin b = 2 sin((a - b)/2) cos((a + b)/2): no digits are lost in a short step.
        """
        rate = number(2.0 * math.pi / self.period_s)
        return f"2.0*sin(0.5*{rate}*dt)*cos({rate}*({end}-0.5*dt)+{number(self.phase_rad)})/dt"


def pace_lines(name: str, course: Steady | Swinging, time_s: float) -> tuple[str, ...]:
    """Return the solver's variables of the time at the end of a step and of the mean pace in it."""
    return (
        f"variable {name}_first equal $(step)",
        f"variable {name}_time equal {number(time_s)}+(step-v_{name}_first)*dt",
        f"variable {name}_pace equal {course.mean_pace(f'v_{name}_time')}",
    )


def _positive_part(text: str) -> str:
    """Formula of max(text, 0); the solver has neither a maximum nor comparisons."""
    return f"(0.5*({text}+abs({text})))"


def number(value: float) -> str:
    """Return a number for the solver's formulas, exact; in brackets where it is negative."""
    return f"{value:.17g}" if value >= 0.0 else f"({value:.17g})"
