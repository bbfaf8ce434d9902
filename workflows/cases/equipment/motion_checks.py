"""Checks of how the parts of a run move, that need no drawing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bulkwear.workflows.cases.equipment.motions import FREE, NEEDED, motion_faults, motion_of
from bulkwear.workflows.cases.equipment.parameters import most_blocks
from bulkwear.workflows.config.run_checks import Check, CheckedRun, Fault
from bulkwear.workflows.config.units import to_si

TINY = 1e-12  # of a component of a direction; its square is lost beside 1
STILL = 1e-6  # rad/s, rad, m/s or m: a part that moves by no more stands still for as long as anything is simulated
FEWEST_STEPS_OF_PERIOD = 20.0  # in which a part swings once
# keys of a motion as parameters have them -> as a study has them
WRITTEN = {
    next(iter(to_si({key: 0.0}))): key
    for key in ("point_mm", "speed_rpm", "amplitude_mm", "amplitude_deg", "phase_deg")
}
DIRECTIONS = ("axis", "velocity_m_per_s", "amplitude_m")  # of a motion, which must not be 0
PACES = ("speed_rad_per_s", "amplitude_rad")  # neither


def motions_complete(run: CheckedRun) -> Fault | None:
    """Each motion has the keys that its kind needs, and none that it cannot use."""
    for part, motion in _moving(run):
        if fault := motion_faults(motion):
            name, kind = WRITTEN.get(fault[0], fault[0]), motion["kind"]
            known = [WRITTEN.get(each, each) for each in (*NEEDED[kind], *FREE.get(kind, ()))]
            needed = ", ".join(known[: len(NEEDED[kind])])
            free = f", and as you like {', '.join(known[len(NEEDED[kind]) :])}" if kind in FREE else ""
            key = f"parts.{part}.motion.{name}"
            if fault[1] == "missing":
                return key, f"{kind} with {needed}{free}"
            return key, f"none for the kind {kind}, which has {needed}{free}"
    return None


def motions_move(run: CheckedRun) -> Fault | None:
    """Motions have a direction and a pace, stop after they have started, and start while the machine starts up."""
    start_up = run.parameters["start_up"]["most_s"]
    for part, motion in _moving(run):
        given = {name: np.abs(motion[name]).max() for name in (*DIRECTIONS, *PACES) if name in motion}
        still = next((name for name, size in given.items() if size <= (TINY if name == "axis" else STILL)), None)
        key = f"parts.{part}.motion"
        if still:
            many = "numbers that are not all 0" if still in DIRECTIONS else "a number other than 0"
            slow = " or nearly" if given[still] else ""
            return f"{key}.{WRITTEN.get(still, still)}", f"{many}{slow}, or a part without motion"
        full = motion.get("start_s", 0.0) + motion.get("ramp_s", 0.0)
        if bound := _allowed_stop(run.parameters, motion, full):
            return f"{key}.stop_s", bound
        if full > start_up:
            late = "start_s" if "start_s" in motion else "ramp_s"
            return f"{key}.{late}", f"full speed within start_up.most_s, {start_up:g} s, found {full:g} s"
        motion_of(motion)  # raises ValueError for what is not known here
    return None


def _allowed_stop(parameters: Mapping[str, Any], motion: Mapping[str, Any], full: float) -> str | None:
    """Return when a motion that has its full speed after `full` (s) may stop, None where it stops then or never.

    It stands before wear is counted, or not in the longest run: the mean wear of a part that moves for a while is that
    of no operation.
    """
    stop, start_up = motion.get("stop_s", math.inf), parameters["start_up"]["most_s"]
    if stop < full or not stop:
        return f"at least {full:g} s, start_s and ramp_s together" if full else "above 0 s: the part would never move"
    longest = most_blocks(parameters) * parameters["sampling"]["block_s"]
    if stop + motion.get("ramp_s", 0.0) <= start_up or stop >= longest:
        return None
    with_ramp = ", less ramp_s" if "ramp_s" in motion else ""
    return (
        f"at most start_up.most_s, {start_up:g} s{with_ramp}, or at least the longest that the run may get,"
        f" {longest:.4g} s: hours are told of a part that moves or stands all the time that wear is counted"
    )


def swings_are_seen(run: CheckedRun) -> Fault | None:
    """A part swings once within a run, or more often, and a swing takes many time steps."""
    derived, block_s = run.parameters["derived"], run.parameters["sampling"]["block_s"]
    least, most = FEWEST_STEPS_OF_PERIOD * derived["time_step_s"], most_blocks(run.parameters) * block_s
    for part, motion in _moving(run):
        if "period_s" in motion and not least <= motion["period_s"] <= most:
            reason = f"{FEWEST_STEPS_OF_PERIOD:g} time steps to the longest that the run may get"
            return f"parts.{part}.motion.period_s", f"from {least:.3g} to {most:.4g} s, {reason}"
    return None


def _moving(run: CheckedRun) -> list[tuple[str, Mapping[str, Any]]]:
    return [(part["name"], part["motion"]) for part in run.parameters["parts"] if part["motion"]]


MOTION_CHECKS: tuple[Check, ...] = (motions_complete, motions_move, swings_are_seen)
