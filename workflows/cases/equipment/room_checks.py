"""Checks of where material comes from, goes to and is simulated, that need no drawing."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bulkwear.postproc.wear.caps import GRAVITY
from bulkwear.workflows.cases.equipment.decks import FASTEST, SHELL_SHARE, room_round
from bulkwear.workflows.cases.equipment.motion_checks import TINY
from bulkwear.workflows.cases.equipment.parameters import start_up_blocks
from bulkwear.workflows.cases.equipment.placing import (
    LEAST_SIDE_DIAMETERS,
    filling_box,
    largest_diameter,
    largest_filling,
    largest_rate,
    normal_velocity,
    placing_room,
)
from bulkwear.workflows.cases.equipment.surfaces import rectangle
from bulkwear.workflows.config.run_checks import Check, CheckedRun, Fault, millimetres

LEAST_NORMAL_VELOCITY = 1e-3  # m/s, through an inlet: below it the solver stops
# Of a slice, and of a cylinder that is filled: in two diameters a particle may touch another one and its image at once,
# and the solver mixes what it knows of the two contacts.
LEAST_SLICE_DIAMETERS = 2.5
TOUCHING = 1e-6  # m; ends that are equal in the drawing and in the settings
LOOKING_UP = 0.5  # -, z of the unit normal of a rectangle that looks up
T_PER_H = 3.6  # of a kg/s
MILLISECONDS = 1e3  # of a s, to which a bound in a sentence is rounded up
AXES = "xyz"


def material_comes_in(run: CheckedRun) -> Fault | None:
    """Material comes through an inlet, or the machine is filled with it, or both."""
    if run.parameters["inlet"] or run.parameters["filling"]:
        return None
    return "inlet", "an inlet, a block `filling`, or both: there would be nothing to simulate"


def outlet_there(run: CheckedRun) -> Fault | None:
    """What comes in through an inlet leaves through an outlet: a slice lets nothing out."""
    if run.parameters["outlets"] or not run.parameters["inlet"]:
        return None
    return "outlets", "one outlet or more where there is an inlet, else material heaps up for ever"


def particles_fit_outlets(run: CheckedRun) -> Fault | None:
    """The sides of outlets are the diameter of the largest particles or more."""
    least = largest_diameter(run.parameters)
    for name, given in (run.parameters["outlets"] or {}).items():
        if min(given["size_m"]) < least:
            reason = "the largest particles, as coarse-grained; far larger ones cost nothing"
            return f"outlets.{name}.size_mm", f"sides of at least {millimetres(least)}, {reason}"
    return None


def outlets_are_reached(run: CheckedRun) -> Fault | None:
    """Where nothing moves, material falls: not all outlets are above it, and none below the inlet looks up."""
    outlets, inlet = run.parameters["outlets"] or {}, run.parameters["inlet"]
    if not inlet or any(part["motion"] for part in run.parameters["parts"]):
        return None
    for name, given in outlets.items():
        upward = given["normal"][2] / np.linalg.norm(given["normal"])
        if upward > LOOKING_UP and _heights(given).max() < _heights(inlet).min():
            reason = "whither material leaves: it falls, against the normal it would not be counted; turn it round"
            return f"outlets.{name}.normal", reason
    rise = 0.5 * float(np.dot(inlet["velocity_m_per_s"], inlet["velocity_m_per_s"])) / GRAVITY
    highest = float(max(placing_room(run.parameters)[:, 2].max(), _filled_up_to(run.parameters))) + rise
    if outlets and min(_heights(given).min() for given in outlets.values()) > highest:
        reason = "as high as material gets where no part moves"
        return f"outlets.{next(iter(outlets))}.centre_mm", f"a place below z = {millimetres(highest)}, {reason}"
    return None


def starts_up_till_it_leaves(run: CheckedRun) -> Fault | None:
    """A machine that is empty at first, and where nothing moves, starts up for as long as a fall to an outlet takes."""
    parameters, inlet, outlets = run.parameters, run.parameters["inlet"], run.parameters["outlets"] or {}
    if not inlet or parameters["filling"] or not outlets or any(part["motion"] for part in parameters["parts"]):
        return None
    deep = {name: max(_heights(inlet).min() - _heights(given).max(), 0.0) for name, given in outlets.items()}
    name = min(deep, key=deep.__getitem__)
    speed = float(np.linalg.norm(inlet["velocity_m_per_s"]))  # a wall may turn all of it downwards
    least = (np.sqrt(speed**2 + 2.0 * GRAVITY * deep[name]) - speed) / GRAVITY
    if start_up_blocks(parameters) * parameters["sampling"]["block_s"] >= least:
        return None
    return "start_up.most_s", (
        f"at least {math.ceil(MILLISECONDS * least) / MILLISECONDS:g} s, which a free fall from the inlet to"
        f" outlets.{name} takes: wear would be counted before anything could leave"
    )


def _heights(given: Mapping[str, Any]) -> np.ndarray:
    """Return z (m) of the corners of a rectangle."""
    return rectangle(given).points[:, 2]


def _filled_up_to(parameters: Mapping[str, Any]) -> float:
    return float(filling_box(parameters)[1, 2]) if parameters["filling"] else -np.inf


def outlets_apart(run: CheckedRun) -> Fault | None:
    """No two outlets lie on each other: the solver ends where it takes a particle out twice in a step."""
    least, seen = FASTEST * run.parameters["derived"]["time_step_s"], {}
    for name, given in (run.parameters["outlets"] or {}).items():
        for other, before in seen.items():
            away = _over(before, rectangle(given).points)
            if away is not None and np.abs(away).max() < least:
                key = f"outlets.{name}.centre_mm"
                return key, f"a place at least {millimetres(least)} before or behind outlets.{other}, or beside it"
        seen[name] = given
    return None


def filling_before_outlets(run: CheckedRun) -> Fault | None:
    """No part of the cylinder that is filled lies beyond an outlet, where particles are placed and never counted."""
    if not run.parameters["filling"]:
        return None
    box = np.array(list(itertools.product(*filling_box(run.parameters).T)))
    for name, given in (run.parameters["outlets"] or {}).items():
        away = _over(given, box)
        if away is not None and away.max() > TOUCHING:
            return "filling.centre_mm", (
                f"a place from which the cylinder that is filled does not stand out through outlets.{name}, as it does"
                f" by {millimetres(float(away.max()))}"
            )
    return None


def inlet_before_outlets(run: CheckedRun) -> Fault | None:
    """No outlet cuts through the room behind the inlet, in which particles are placed: they would leave at once."""
    if not run.parameters["inlet"]:
        return None
    room = placing_room(run.parameters)
    for name, given in (run.parameters["outlets"] or {}).items():
        away = _over(given, room)
        if away is not None and away.min() < -TOUCHING and away.max() > TOUCHING:
            return f"outlets.{name}.centre_mm", (
                "a place from which it does not cut through the room behind the inlet, in which particles are placed:"
                " they would leave before they come in"
            )
    return None


def _over(given: Mapping[str, Any], points: np.ndarray) -> np.ndarray | None:
    """Return how far (n,) m places (n, 3) m lie beyond the plane of a rectangle; None where they lie beside it."""
    corners = rectangle(given).points
    sides, normal = corners[[1, 3]] - corners[0], np.asarray(given["normal"]) / np.linalg.norm(given["normal"])
    along = (points - corners[0]) @ sides.T / (sides**2).sum(axis=1)
    beside = (along.min(axis=0) >= 1.0).any() or (along.max(axis=0) <= 0.0).any()
    return None if beside else (points - corners[0]) @ normal


def rectangles_look_somewhere(run: CheckedRun) -> Fault | None:
    """The normals of inlet and outlets have a length."""
    rectangles = {"inlet": run.parameters["inlet"]}
    rectangles |= {f"outlets.{name}": given for name, given in (run.parameters["outlets"] or {}).items()}
    found = next((key for key, given in rectangles.items() if given and max(map(abs, given["normal"])) <= TINY), None)
    return (f"{found}.normal", "a direction: three numbers that are not all 0") if found else None


def velocity_through_inlet(run: CheckedRun) -> Fault | None:
    """Material goes through the inlet along its normal, not back and not along it."""
    inlet = run.parameters["inlet"]
    if not inlet or normal_velocity(inlet) > LEAST_NORMAL_VELOCITY:
        return None
    normal = ", ".join(f"{each:g}" for each in inlet["normal"])
    return (
        "inlet.velocity_m_per_s",
        f"a velocity of more than {LEAST_NORMAL_VELOCITY:g} m/s along inlet.normal ({normal}), found"
        f" {normal_velocity(inlet):.4g} m/s; turn the one or the other round",
    )


def particles_fit_inlet(run: CheckedRun) -> Fault | None:
    """The inlet's sides are three of the largest particles or more."""
    inlet, least = run.parameters["inlet"], LEAST_SIDE_DIAMETERS * largest_diameter(run.parameters)
    if not inlet or min(inlet["size_m"]) >= least:
        return None
    return (
        "inlet.size_mm",
        f"sides of at least {millimetres(least)}, {LEAST_SIDE_DIAMETERS:g} of the largest particles, as coarse-grained",
    )


def rate_fits_inlet(run: CheckedRun) -> Fault | None:
    """The solver can place the feed before the inlet: what is more does not come in."""
    inlet = run.parameters["inlet"]
    if not inlet or inlet["rate_kg_per_s"] <= (most := largest_rate(run.parameters)):
        return None
    sides = " x ".join(f"{1e3 * side:.6g}" for side in inlet["size_m"])
    return (
        "inlet.rate_t_per_h",
        f"at most {T_PER_H * most:.4g} t/h, which is what can be placed before {sides} mm at"
        f" {normal_velocity(inlet):.4g} m/s; a larger inlet.size_mm or a faster inlet.velocity_m_per_s lets more in",
    )


def particles_fit_filling(run: CheckedRun) -> Fault | None:
    """The cylinder that is filled is two and a half of the largest particles long and across, or more."""
    filling, least = run.parameters["filling"], LEAST_SLICE_DIAMETERS * largest_diameter(run.parameters)
    if not filling:
        return None
    reason = f"{LEAST_SLICE_DIAMETERS:g} of the largest particles, as coarse-grained"
    if filling["length_m"] < least:
        return "filling.length_mm", f"at least {millimetres(least)}, {reason}"
    if 2.0 * filling["radius_m"] < least:
        return "filling.radius_mm", f"at least {millimetres(0.5 * least)}, half of {reason}"
    return None


def filled_at_once(run: CheckedRun) -> Fault | None:
    """The solver can place the filling at once, with room between the particles."""
    filling = run.parameters["filling"]
    if not filling or filling["fraction"] <= (most := largest_filling(run.parameters)):
        return None
    return (
        "filling.fraction",
        f"at most {most:.3g}, which is what can be placed at once in such a cylinder; an inlet may bring the rest",
    )


def slice_in_order(run: CheckedRun) -> Fault | None:
    """A slice is horizontal, and thick enough for a particle not to see another one twice."""
    periodic, least = run.parameters["periodic"], LEAST_SLICE_DIAMETERS * largest_diameter(run.parameters)
    if not periodic:
        return None
    if periodic["axis"] == "z":
        return "periodic.axis", "x or y: along z material would fall for ever"
    if periodic["high_m"] - periodic["low_m"] >= least:
        return None
    return (
        "periodic.high_mm",
        f"at least {millimetres(periodic['low_m'] + least)}, periodic.low_mm and {LEAST_SLICE_DIAMETERS:g} of the"
        " largest particles, as coarse-grained",
    )


def domain_in_order(run: CheckedRun) -> Fault | None:
    """The domain's corners are in order, with room for particles between the places where they count as strays."""
    if not run.parameters["domain"]:
        return None
    low, high = (np.asarray(run.parameters["domain"][name]) for name in ("low_m", "high_m"))
    least = 2.0 * SHELL_SHARE * room_round(run.parameters)
    axes = [axis for k, axis in enumerate(AXES) if not high[k] - low[k] > least and not _is_slice(run.parameters, k)]
    if not axes:
        return None
    return (
        "domain.high_mm",
        f"above domain.low_mm by more than {millimetres(least)} along {' and '.join(axes)}, the room at both ends in"
        " which particles count as strays",
    )


def inlet_in_domain(run: CheckedRun) -> Fault | None:
    """The inlet and the room behind it, in which particles are placed, lie in the given domain and in the slice."""
    if not run.parameters["inlet"]:
        return None
    room = "the room behind it, in which particles are placed,"
    return _outside(run, placing_room(run.parameters), "inlet.centre_mm", room)


def filling_in_domain(run: CheckedRun) -> Fault | None:
    """The cylinder that is filled lies in the given domain and in the slice."""
    if not run.parameters["filling"]:
        return None
    return _outside(run, filling_box(run.parameters), "filling.centre_mm", "the cylinder that is filled")


def outlets_in_domain(run: CheckedRun) -> Fault | None:
    """The middle of each outlet lies in the given domain and in the slice: beyond them there are no particles."""
    for name, given in (run.parameters["outlets"] or {}).items():
        key = f"outlets.{name}.centre_mm"
        if fault := _outside(run, np.asarray([given["centre_m"]]), key, "it"):
            return fault
    return None


def _outside(run: CheckedRun, points: np.ndarray, key: str, what: str) -> Fault | None:
    """Return the fault of places (n, 3) m that stand out of the domain that is given, or of the slice."""
    for axis, (name, low, high) in _known_ends(run.parameters).items():
        k = AXES.index(axis)
        beyond = max(low - points[:, k].min(), points[:, k].max() - high)
        if beyond > TOUCHING:
            return key, (
                f"a place from which {what} does not stand out of {name}, {millimetres(low)} to {millimetres(high)}"
                f" along {axis}, as it does by {millimetres(beyond)}"
            )
    return None


def _known_ends(parameters: Mapping[str, Any]) -> dict[str, tuple[str, float, float]]:
    """Return {axis: (section, low, high)} m of the ends of what is simulated that need no drawing."""
    ends = {}
    if domain := parameters["domain"]:
        ends = {axis: ("domain", domain["low_m"][k], domain["high_m"][k]) for k, axis in enumerate(AXES)}
    if periodic := parameters["periodic"]:
        ends[periodic["axis"]] = ("periodic", periodic["low_m"], periodic["high_m"])
    return ends


def _is_slice(parameters: Mapping[str, Any], axis: int) -> bool:
    return bool(parameters["periodic"]) and parameters["periodic"]["axis"] == AXES[axis]


ROOM_CHECKS: tuple[Check, ...] = (
    material_comes_in,
    outlet_there,
    rectangles_look_somewhere,
    particles_fit_outlets,
    outlets_are_reached,
    starts_up_till_it_leaves,
    outlets_apart,
    inlet_before_outlets,
    filling_before_outlets,
    velocity_through_inlet,
    particles_fit_inlet,
    rate_fits_inlet,
    particles_fit_filling,
    filled_at_once,
    slice_in_order,
    domain_in_order,
    inlet_in_domain,
    filling_in_domain,
    outlets_in_domain,
)
