"""Checks of how the parts of a run move, that need no drawing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.equipment.motions import (
    FREE,
    NEEDED,
    frame_turns,
    full_speed_s,
    motion_faults,
    motion_of,
    stands_s,
    turn_s,
)
from bulkwear.workflows.cases.equipment.parameters import most_blocks
from bulkwear.workflows.config.run_checks import Check, CheckedRun, Fault
from bulkwear.workflows.config.units import to_si

TINY = 1e-12  # of a component of a direction; its square is lost beside 1
STILL = 1e-6  # rad/s, rad, m/s or m: a part that moves by no more stands still for as long as anything is simulated
FEWEST_STEPS_OF_PERIOD = 20.0  # in which a part swings once
FELT = 0.01  # -, of the smallest diameter or of gravity: by less a swing hardly moves particles, as of one given in m
PART_OF_SWING = 0.05  # of a block, by which it may differ from whole swings
SECONDS_PER_MINUTE = 60.0
LEAST_TURNS = 1.0 - 1e-3  # of a part that wears, in the longest run
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
        full = full_speed_s(motion)
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
    longest = _longest_s(parameters)
    if stands_s(motion) <= start_up or stop >= longest:
        return None
    with_ramp = ", less ramp_s" if "ramp_s" in motion else ""
    return (
        f"at most start_up.most_s, {start_up:g} s{with_ramp}, or at least the longest that the run may get,"
        f" {longest:.4g} s: hours are told of a part that moves or stands all the time that wear is counted"
    )


def swings_are_seen(run: CheckedRun) -> Fault | None:
    """A part swings once within a run, or more often, and a swing takes many time steps."""
    least, most = FEWEST_STEPS_OF_PERIOD * run.parameters["derived"]["time_step_s"], _longest_s(run.parameters)
    for part, motion in _moving(run):
        if "period_s" in motion and not least <= motion["period_s"] <= most:
            reason = f"{FEWEST_STEPS_OF_PERIOD:g} time steps to the longest that the run may get"
            return f"parts.{part}.motion.period_s", f"from {least:.3g} to {most:.4g} s, {reason}"
    return None


def swings_are_felt(run: CheckedRun) -> Fault | None:
    """What swings does so by a hundredth of the smallest diameter, or pushes with a hundredth of gravity, or more."""
    smallest = min(run.parameters["particle"]["diameters_m"])
    for part, motion in _moving(run):
        if motion["kind"] != "oscillation":
            continue
        least = FELT * min(smallest, GRAVITY * (motion["period_s"] / (2.0 * math.pi)) ** 2)
        if (found := float(np.linalg.norm(motion["amplitude_m"]))) < least:
            return f"parts.{part}.motion.amplitude_mm", (
                f"at least {1e3 * least:.3g} mm long at {motion['period_s']:g} s, a hundredth of the smallest diameter"
                f" or of gravity, found {1e3 * found:.3g} mm: it would hardly move a particle; lengths are in mm"
            )
    return None


def blocks_are_whole_swings(run: CheckedRun) -> Fault | None:
    """A block has whole swings of each part that swings, or so many that a part of one hardly counts."""
    block_s = run.parameters["sampling"]["block_s"]
    for part, motion in _moving(run):
        swings = block_s / motion.get("period_s", block_s)
        if abs(swings - max(round(swings), 1)) > PART_OF_SWING * swings:
            nearest = max(round(swings), 1) * motion["period_s"]
            return "sampling.block_s", (
                f"a whole number of swings of parts.{part}, {motion['period_s']:g} s each, within"
                f" {100.0 * PART_OF_SWING:g} % of the block, such as {nearest:.6g} s: the wear of a part of a swing is"
                " not that of hours of operation"
            )
    return None


def turned_once(run: CheckedRun) -> Fault | None:
    """A part that wears and turns as a rotation makes a turn or more in the longest run."""
    longest, start_up = _longest_s(run.parameters), run.parameters["start_up"]["most_s"]
    for part in run.parameters["parts"]:
        motion = part["motion"]
        stands = (motion or {}).get("stop_s", math.inf) <= start_up
        if not part["wears"] or not frame_turns(motion) or stands or longest >= LEAST_TURNS * turn_s(motion):
            continue
        least = SECONDS_PER_MINUTE / longest
        return f"parts.{part['name']}.motion.speed_rpm", (
            f"at least {least:.4g} rpm, a turn in the longest that the run may get, {longest:.4g} s: wear would be"
            " counted in one attitude of the part; or a longer sampling.block_s; or kind: turning_surface, of a part"
            " that looks alike all round"
        )
    return None


def something_moves(run: CheckedRun) -> Fault | None:
    """While wear is counted material comes in, flows out, or is moved by a part."""
    parameters, start_up = run.parameters, run.parameters["start_up"]["most_s"]
    moving = [motion for _, motion in _moving(run) if motion.get("stop_s", math.inf) > start_up]
    if parameters["inlet"] or parameters["outlets"] or moving:
        return None
    stopped = next((part for part, motion in _moving(run)), None)
    allowed = f"above start_up.most_s, {start_up:g} s, or none: nothing would move while wear is counted"
    if stopped is None:
        return "parts", "a part with a motion where there is neither inlet nor outlet: nothing would move"
    return f"parts.{stopped}.motion.stop_s", allowed


def _longest_s(parameters: Mapping[str, Any]) -> float:
    """Return the longest (s) that a run may get."""
    return most_blocks(parameters) * parameters["sampling"]["block_s"]


def _moving(run: CheckedRun) -> list[tuple[str, Mapping[str, Any]]]:
    return [(part["name"], part["motion"]) for part in run.parameters["parts"] if part["motion"]]


MOTION_CHECKS: tuple[Check, ...] = (motions_complete, motions_move, swings_are_seen, swings_are_felt)
# of blocks that are long enough
COUNTED_MOTION_CHECKS: tuple[Check, ...] = (something_moves, blocks_are_whole_swings, turned_once)
