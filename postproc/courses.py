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

    def pace_lines(self, name: str) -> tuple[str, ...]:
        """Return the solver's variables that end in the mean pace of a step, `<name>_pace`; see `course_lines`."""
        if math.isinf(self.stop_s):
            return (f"variable {name}_pace equal {self._ramp(f'v_{name}_time', self.start_s)}",)
        return (
            f"variable {name}_up equal {self._ramp(f'v_{name}_time', self.start_s)}",
            f"variable {name}_down equal {self._ramp(f'v_{name}_time', self.stop_s)}",
            f"variable {name}_pace equal v_{name}_up-v_{name}_down",
        )

    def _ramp(self, end: str, start_s: float) -> str:
        """Formula of the mean pace of a ramp that starts then, in the step to the time `end`, a variable.

        The pace is 1/2 + (|t - a| - |t - b|) / (2 (b - a)) for a ramp from a to b; |x| x / 2 is the integral of |x|.
        The solver's formulas have neither a maximum nor comparisons.
        """
        a, b = number(start_s), number(start_s + self.ramp_s)
        if self.ramp_s == 0.0:
            return f"0.5+0.5*(abs({end}-{a})-abs({end}-dt-{a}))/dt"
        signed = [f"({time}-{moment})*abs({time}-{moment})" for time in (end, f"{end}-dt") for moment in (a, b)]
        return f"0.5+({signed[0]}-{signed[1]}-{signed[2]}+{signed[3]})/{number(4.0 * self.ramp_s)}/dt"


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

    def pace_lines(self, name: str) -> tuple[str, ...]:
        """Return the solver's variable of the mean pace of a step, `<name>_pace`; see `course_lines`.

        sin a - sin b = 2 sin((a - b)/2) cos((a + b)/2): no digits are lost in a short step.
        """
        rate, phase = number(2.0 * math.pi / self.period_s), number(self.phase_rad)
        return (f"variable {name}_pace equal 2.0*sin(0.5*{rate}*dt)*cos({rate}*(v_{name}_time-0.5*dt)+{phase})/dt",)


def course_lines(name: str, course: Steady | Swinging, time_s: float) -> tuple[str, ...]:
    """Return the solver's variables of the time at the end of a step, and of the mean pace in it, `<name>_pace`."""
    return (
        f"variable {name}_first equal $(step)",
        f"variable {name}_time equal {number(time_s)}+(step-v_{name}_first)*dt",
        *course.pace_lines(name),
    )


def number(value: float) -> str:
    """Return a number for the solver's formulas, exact; in brackets where it is negative."""
    return f"{value:.17g}" if value >= 0.0 else f"({value:.17g})"
