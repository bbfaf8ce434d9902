"""Check of where the feed of a machine goes first: to a part before an outlet, while the run lasts, none into nothing.

The feed is followed as free flight from places of its inlet. A part that moves is taken for all of the box in which it
moves: it may meet the feed there at any time.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh
from bulkwear.workflows.cases.equipment.decks import longest_s, moving_mesh
from bulkwear.workflows.cases.equipment.placing import filling_box, largest_diameter
from bulkwear.workflows.cases.equipment.room_checks import LOOKING_UP
from bulkwear.workflows.cases.equipment.surfaces import rectangle, room_needed
from bulkwear.workflows.config.layers import ConfigError

GRAVITY = np.array([0.0, 0.0, -9.81])  # m/s2
PATHS = 9  # along each side of an inlet
BEFORE = 1e-6  # s, that a flight starts before the inlet, so that what lies in its plane is met
RIM = 1e-9  # -, of the sides of a triangle


def check_stream(run: Mapping[str, Any], parts: Sequence[SurfaceMesh]) -> None:
    """Raise ConfigError for a feed that falls past all parts, gets to none within the longest run, or of which some
    falls past outlets too, and for an outlet that nothing falls through along its normal.

    run: the sections of its parameters that its surface depends on; parts: the surface of each
    """
    _check_outlets_look_down(run, parts)
    inlet = run["inlet"]
    if not inlet:
        _check_filling_falls(run, parts)
        return
    if _goes_round(run):
        return
    velocity = np.asarray(inlet["velocity_m_per_s"], dtype=np.float64)
    starts = _places(inlet) - BEFORE * velocity
    pairs = zip(run["parts"], parts, strict=True)
    met = np.min([_met(run, part, starts, velocity, mesh) for part, mesh in pairs], axis=0)
    gone = {name: first_met(starts, velocity, rectangle(given)) for name, given in (run["outlets"] or {}).items()}
    before = met < np.min(list(gone.values()), axis=0) if gone else np.isfinite(met)
    centre = ", ".join(f"{1e3 * value + 0.0:.4g}" for value in inlet["centre_m"])
    found = f"inlet.centre_mm is ({centre}) mm, allowed is a place from which what comes in"
    if not before.any():
        way = [f"through outlets.{name}" for name, times in gone.items() if np.isfinite(times).any()]
        raise ConfigError(f"{found} falls on a part: it falls past all of them, {(way or ['into nothing'])[0]}.")
    if (time := met[before].min()) > (longest := longest_s(run)):
        raise ConfigError(f"{found} gets to a part within the longest run, {longest:.3g} s: it takes {time:.3g} s.")
    if not np.isfinite(np.min([met, *gone.values()], axis=0)).all():
        _check_none_lost(run, parts, found)


def _check_outlets_look_down(run: Mapping[str, Any], parts: Sequence[SurfaceMesh]) -> None:
    """Raise ConfigError for an outlet that looks up from below all else: nothing throws material through it."""
    lows = [
        room_needed(mesh.points, part, longest_s(run))[0][2] for part, mesh in zip(run["parts"], parts, strict=True)
    ]
    lows += [rectangle(run["inlet"]).points[:, 2].min()] if run["inlet"] else []
    lows += [filling_box(run)[0][2]] if run.get("filling") else []
    for name, given in (run["outlets"] or {}).items():
        upward = given["normal"][2] / np.linalg.norm(given["normal"])
        if upward > LOOKING_UP and rectangle(given).points[:, 2].max() < min(lows):
            normal = ", ".join(f"{each:g}" for each in given["normal"])
            raise ConfigError(
                f"outlets.{name}.normal is ({normal}), allowed is whither material leaves: below all parts it falls,"
                " against the normal it would not be counted; turn it round."
            )


def _check_none_lost(run: Mapping[str, Any], parts: Sequence[SurfaceMesh], found: str) -> None:
    """Raise ConfigError for a feed of which some falls past all parts and outlets: the first stray stops the run.

    found: begin of the sentence. What grazes an edge by less than the largest radius is met.
    """
    inlet, diameter = run["inlet"], largest_diameter(run)
    velocity = np.asarray(inlet["velocity_m_per_s"], dtype=np.float64)
    lost = all_of_it = _places({**inlet, "size_m": [max(side - diameter, 0.0) for side in inlet["size_m"]]})
    corners = rectangle({**inlet, "size_m": [diameter, diameter]}).points - np.asarray(inlet["centre_m"])
    for beside in np.concatenate([np.zeros((1, 3)), corners, 0.5 * (corners + np.roll(corners, 1, axis=0))]):
        starts = lost + beside - BEFORE * velocity
        ends = [_met(run, part, starts, velocity, mesh) for part, mesh in zip(run["parts"], parts, strict=True)]
        ends += [first_met(starts, velocity, rectangle(given)) for given in (run["outlets"] or {}).values()]
        lost = lost[~np.isfinite(np.min(ends, axis=0))]
        if not len(lost):
            return
    place = ", ".join(f"{1e3 * value + 0.0:.4g}" for value in lost[0])
    raise ConfigError(
        f"{found} all falls on a part or through an outlet: {len(lost)} of {len(all_of_it)} flights, as from ({place})"
        " mm, meet neither, and a particle that leaves elsewhere stops the run: move or narrow the inlet, or widen a"
        " part or an outlet."
    )


def _check_filling_falls(run: Mapping[str, Any], parts: Sequence[SurfaceMesh]) -> None:
    """Raise ConfigError for a filling of which nothing falls on a part."""
    if not (filling := run.get("filling")):
        return
    starts = _places_within(filling)
    pairs = zip(run["parts"], parts, strict=True)
    if not np.isfinite([_met(run, part, starts, np.zeros(3), mesh) for part, mesh in pairs]).any():
        centre = ", ".join(f"{1e3 * value + 0.0:.4g}" for value in filling["centre_m"])
        raise ConfigError(
            f"filling.centre_mm is ({centre}) mm, allowed is a place from which what is filled in falls on a part: it"
            " falls past all of them."
        )


def _places_within(filling: Mapping[str, Any]) -> np.ndarray:
    """Return places (n, 3) m within the cylinder of a filling: on its axis, and halfway from there to its side."""
    axis = "xyz".index(filling["axis"])
    ends = 0.5 * filling["length_m"] * np.linspace(-1.0, 1.0, PATHS)
    half = 0.5 * filling["radius_m"] * np.array([-1.0, 0.0, 1.0])
    sides = [ends if k == axis else half for k in range(3)]
    return np.asarray(filling["centre_m"]) + np.array(list(itertools.product(*sides)))


def _met(
    run: Mapping[str, Any], part: Mapping[str, Any], starts: np.ndarray, velocity: np.ndarray, mesh: SurfaceMesh
) -> np.ndarray:
    """Return when (n,) s the feed may first meet a part, infinite where it does not."""
    if not moving_mesh(part):
        return first_met(starts, velocity, mesh)
    low, high = room_needed(mesh.points, part, longest_s(run))
    within = ((starts >= low) & (starts <= high)).all(axis=1)
    return np.where(within, 0.0, first_met(starts, velocity, _box(low, high)))


def _box(low: np.ndarray, high: np.ndarray) -> SurfaceMesh:
    """Return the surface of a box; low, high: (3,) m."""
    corners = np.array(list(itertools.product(*zip(low, high, strict=True))))
    sides = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
    return SurfaceMesh(corners, np.array([half for a, b, c, d in sides for half in ((a, b, c), (a, c, d))]))


def _goes_round(run: Mapping[str, Any]) -> bool:
    """Return whether the feed may leave a slice at one end and come in at the other."""
    return bool(run["periodic"]) and run["inlet"]["velocity_m_per_s"]["xyz".index(run["periodic"]["axis"])] != 0.0


def _places(inlet: Mapping[str, Any]) -> np.ndarray:
    """Return places (n, 3) m all over an inlet, its corners among them."""
    corners = rectangle(inlet).points
    across, along = (each.reshape(-1, 1) for each in np.meshgrid(*[np.linspace(0.0, 1.0, PATHS)] * 2))
    return corners[0] + across * (corners[1] - corners[0]) + along * (corners[3] - corners[0])


def first_met(starts: np.ndarray, velocity: np.ndarray, mesh: SurfaceMesh) -> np.ndarray:
    """Return when (n,) s what starts at places (n, 3) m with a velocity (3,) m/s first flies through a surface.

    Infinite where it never does.
    """
    corners = mesh.points[mesh.triangles]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(first, second)
    squared = np.einsum("ij,ij->i", normal, normal)
    a, b = 0.5 * normal @ GRAVITY, normal @ velocity
    found = []
    for start in starts:
        away = start - corners[:, 0]
        times = _roots(a, b, np.einsum("ij,ij->i", normal, away))
        place = away + velocity * times[..., None] + 0.5 * GRAVITY * times[..., None] ** 2
        u = np.einsum("kij,ij->ki", np.cross(place, second), normal) / squared
        v = np.einsum("kij,ij->ki", np.cross(first, place), normal) / squared
        inside = (u >= -RIM) & (v >= -RIM) & (u + v <= 1.0 + RIM) & (times > 0.0)
        found.append(np.where(inside, times, np.inf).min(initial=np.inf))
    return np.array(found)


def _roots(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Return both solutions (2, m) of a t^2 + b t + c = 0, NaN where there is none; of a linear one twice the same."""
    with np.errstate(invalid="ignore", divide="ignore"):
        q = -0.5 * (b + np.copysign(np.sqrt(b**2 - 4.0 * a * c), b))
        found = np.array([np.where(a == 0.0, -c / b, q / a), c / q])
    return np.where(np.isfinite(found), found, np.nan)
