"""What a study says of a part's motion, as the closed form that the solver and the wear step go by."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from bulkwear.postproc.motion import (
    AT_REST,
    Motion,
    angular_oscillation,
    belt,
    oscillation,
    rotation,
    translation,
    turning_surface,
)

# Kind of motion -> keys that it needs, in SI; those of a course are free.
NEEDED = {
    "rotation": ("point_m", "axis", "speed_rad_per_s"),
    "translation": ("velocity_m_per_s",),
    "oscillation": ("amplitude_m", "period_s"),
    "angular_oscillation": ("point_m", "axis", "amplitude_rad", "period_s"),
    "belt": ("velocity_m_per_s",),
    "turning_surface": ("point_m", "axis", "speed_rad_per_s"),
}
COURSE = ("start_s", "ramp_s", "stop_s")  # of what goes on for good
FREE = {"rotation": COURSE, "translation": COURSE, "oscillation": ("phase_rad",), "angular_oscillation": ("phase_rad",)}
RUNNING = ("belt", "turning_surface")  # whose mesh rests
MADE: dict[str, Callable[..., Motion]] = {
    "rotation": rotation,
    "translation": translation,
    "oscillation": oscillation,
    "angular_oscillation": angular_oscillation,
    "belt": belt,
    "turning_surface": turning_surface,
}


def motion_of(given: Mapping[str, Any] | None) -> Motion:
    """Return the motion that the section `motion` of a part describes, in SI; at rest without one.

    Raises ValueError where a direction has no length.
    """
    if given is None:
        return AT_REST
    kind = given["kind"]
    needed = [given[name] for name in NEEDED[kind]]
    return MADE[kind](*needed, **{name: given[name] for name in FREE.get(kind, ()) if name in given})


def motion_faults(given: Mapping[str, Any]) -> tuple[str, str] | None:
    """Return (key in SI, "missing" or "given") of what a motion lacks, or has and cannot use; None without a fault."""
    kind = given["kind"]
    missing = next((name for name in NEEDED[kind] if name not in given), None)
    if missing:
        return missing, "missing"
    known = {"kind", *NEEDED[kind], *FREE.get(kind, ())}
    odd = next((name for name in given if name not in known), None)
    return (odd, "given") if odd else None


def axis_point(given: Mapping[str, Any] | None) -> tuple[float, float, float]:
    """Return the point (m) that a part's torque is about: one of its axis, else the origin."""
    return tuple((given or {}).get("point_m", (0.0, 0.0, 0.0)))


def frame_turns(given: Mapping[str, Any] | None) -> bool:
    """Return whether a part turns for good and its frame with it, in which a force from outside has no mean."""
    return given is not None and given["kind"] == "rotation" and bool(given["speed_rad_per_s"])


def surface_runs(given: Mapping[str, Any] | None) -> bool:
    """Return whether a part stays where it is and its surface runs, as a belt's does."""
    return given is not None and given["kind"] in RUNNING


def turn_s(given: Mapping[str, Any] | None) -> float:
    """Return the time (s) of a turn or of a period; 0 where the part has none."""
    if not given:
        return 0.0
    speed = abs(given.get("speed_rad_per_s", 0.0))
    return 2.0 * math.pi / speed if speed else given.get("period_s", 0.0)


def full_speed_s(given: Mapping[str, Any]) -> float:
    """Return when (s) a motion has its full speed."""
    return given.get("start_s", 0.0) + given.get("ramp_s", 0.0)


def stands_s(given: Mapping[str, Any]) -> float:
    """Return from when on (s) a part stands for good, infinite where it goes on."""
    return given.get("stop_s", math.inf) + given.get("ramp_s", 0.0)


def last_change_s(given: Mapping[str, Any], start_up_s: float) -> float:
    """Return when (s) a motion last changes its pace in a start-up as long as may be: it stands, or has full speed."""
    stands = stands_s(given)
    return stands if stands <= start_up_s else full_speed_s(given)
