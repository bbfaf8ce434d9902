"""Toe and shoulder of the charge of a tumbling mill, from where its particles are.

Both are where the charge meets the shell: at the toe falling particles join it, at the shoulder it leaves the shell.
They are told as degrees from 12 o'clock in the sense of rotation, as Kalala (2008) does: 180 is the bottom, 270 the
horizontal through the axis on the rising side, 90 that on the falling one. His 303 and 128 degrees for a mill of 4,267
mm at 15.7 rpm, three quarters of its critical speed, are then a charge from 38 degrees below the horizontal on one side
to 33 degrees above it on the other. Two things say that this is his convention. The chord from toe to shoulder has a
slope of (303 + 128) / 2 - 180 = 35.5 degrees in it, and 34.7 degrees is the third angle that the Rocky verification
case (2.3, tumbling mill wear) quotes of him. And the fits to charges in mills by Morrell (1996) give a shoulder of 318
and a toe of 142 degrees in it at that speed and a filling of 0.3, but 48 and 232 from his own origin, 3 o'clock.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

BIN_DEG = 2.0  # width of an interval of angle: finer than the balls of a mill, wide enough to hold many of them
LAYER_DIAMETERS = 2.0  # -, thickness of the layer at the shell over the mean diameter: lifters stand in it
OUTERMOST = 0.999  # -, of the particles do not reach further out than the shell is taken to be
HALF = 0.5  # -, of a full interval: there the charge ends, as a profile with rounded ends does
PARTICLES_EVENED = 50.0  # of which the filling at an angle is told: it scatters by a seventh then
BELL_WIDTH = 2.0 * math.sqrt(math.pi)  # -, intervals that a bell evens out over its standard deviation
SPREADS = (0.7, 8.0)  # intervals, least and most of that deviation
BRIDGED_DEG = 8.0  # a gap in the charge up to this is a lifter, not its end


@dataclass(frozen=True, eq=False)
class ChargeAngles:
    """Where a charge begins and ends at the shell.

    toe_deg, shoulder_deg: from 12 o'clock in the sense of rotation; NaN where it has no ends, as it centrifuges
    angle_deg: (k,) middles of intervals, from 0 to 360; filling: (k,) of the layer at the shell there, over a full one
    shell_m, layer_m: radius of the shell that the particles reach, and thickness of the layer
    """

    toe_deg: float
    shoulder_deg: float
    angle_deg: np.ndarray
    filling: np.ndarray
    shell_m: float
    layer_m: float


def turning_frame(axis: np.ndarray, up: np.ndarray = (0.0, 0.0, 1.0)) -> tuple[np.ndarray, np.ndarray]:
    """Return unit vectors (3,) across an axis: to 12 o'clock, and to where 12 o'clock moves with the rotation.

    axis: (3,) of a right-handed rotation; up: (3,) against gravity. Raises ValueError for an upright axis.
    """
    along = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    top = np.asarray(up, dtype=float) - (np.asarray(up, dtype=float) @ along) * along
    length = np.linalg.norm(top)
    if length < 1e-6 * np.linalg.norm(up):
        raise ValueError(f"the axis {np.asarray(axis).tolist()} is upright, allowed is one with a highest side")
    top /= length
    return top, np.cross(along, top)


def polar_places(
    positions: np.ndarray, point: np.ndarray, axis: np.ndarray, up: np.ndarray = (0.0, 0.0, 1.0)
) -> tuple[np.ndarray, np.ndarray]:
    """Return distances (n,) m from an axis and angles (n,) degrees from 12 o'clock in the sense of rotation, 0 to 360.

    positions: (n, 3) m; point: (3,) m on the axis; axis: (3,), the rotation about it is right-handed
    """
    top, ahead = turning_frame(axis, up)
    from_axis = np.asarray(positions, dtype=float) - np.asarray(point, dtype=float)
    high, forward = from_axis @ top, from_axis @ ahead
    return np.hypot(high, forward), np.degrees(np.arctan2(forward, high)) % 360.0


def charge_angles(
    positions: np.ndarray,
    radii: np.ndarray,
    point: np.ndarray,
    axis: np.ndarray,
    up: np.ndarray = (0.0, 0.0, 1.0),
) -> ChargeAngles:
    """Find toe and shoulder of a charge.

    positions, radii: (n, 3) and (n,) m, of the particles of many instants together, so that lifters have been anywhere
    point: (3,) m on the axis; axis: (3,), the rotation about it is right-handed; up: (3,) against gravity

    The volume of the particles in the layer at the shell is told by angle, evened out where they are few. The charge is
    the longest arc that is at least half as full as most of it is; gaps as narrow as a lifter do not end it. Ends lie
    between intervals, on the straight line. Particles in flight fill the layer too little to count. Instants should
    find the lifters in different places: where one stands at every instant there is nothing, and an end there is wrong
    by up to its width. Raises ValueError without particles.
    """
    positions, radii = np.asarray(positions, dtype=float), np.asarray(radii, dtype=float)
    if not len(positions):
        raise ValueError("angles of a charge need particles, found none")
    distance, angle = polar_places(positions, point, axis, up)
    shell = float(np.quantile(distance + radii, OUTERMOST))
    layer = LAYER_DIAMETERS * 2.0 * float(radii.mean())
    near = distance > shell - layer
    count = round(360.0 / BIN_DEG)
    volume, _ = np.histogram(angle[near], count, (0.0, 360.0), weights=radii[near] ** 3)
    volume = gaussian_filter1d(volume, _spread(angle[near], count), mode="wrap")
    filling = volume / max(_full(volume), np.finfo(float).tiny)
    middles = (np.arange(count) + 0.5) * BIN_DEG
    return ChargeAngles(*_ends(filling, middles), middles, filling, shell, layer)


def _spread(angle: np.ndarray, count: int) -> float:
    """Return over how many intervals, standard deviation of a bell, a profile is evened out, so that scatter does not
    end the charge; a bell leaves the half of a step where it is.
    """
    held, _ = np.histogram(angle, count, (0.0, 360.0))
    in_charge = held[held >= HALF * held.mean()].mean()
    return float(np.clip(PARTICLES_EVENED / (BELL_WIDTH * in_charge), *SPREADS))


def _full(volume: np.ndarray) -> float:
    """Return what a full interval holds: the median of those that hold at least half of the fullest one."""
    return float(np.median(volume[volume >= HALF * volume.max()]))


def _ends(filling: np.ndarray, middles: np.ndarray) -> tuple[float, float]:
    """Return where the longest arc of at least half full intervals begins and ends; NaN where it goes all round."""
    inside = _bridged(filling >= HALF, round(BRIDGED_DEG / BIN_DEG))
    if inside.all():
        return np.nan, np.nan
    count, outside = len(inside), np.flatnonzero(~inside)
    gaps = np.diff(np.append(outside, outside[0] + count)) - 1  # lengths of the arcs between
    before = int(outside[gaps.argmax()])
    first, last = before + 1, before + int(gaps.max())
    return _crossing(filling, middles, first, -1), _crossing(filling, middles, last, 1)


def _bridged(inside: np.ndarray, widest: int) -> np.ndarray:
    """Return the mask (k,) of a closed ring with its gaps of up to `widest` intervals filled."""
    if not inside.any():
        return inside
    filled, places = inside.copy(), np.flatnonzero(inside)
    for start, end in zip(places, np.append(places[1:], places[0] + len(inside)), strict=True):
        if 1 < end - start <= widest + 1:
            filled[np.arange(start, end) % len(inside)] = True
    return filled


def _crossing(filling: np.ndarray, middles: np.ndarray, place: int, step: int) -> float:
    """Return the angle at which the filling falls through half beside an interval, on the side of `step`."""
    count = len(filling)
    here, beside = filling[place % count], filling[(place + step) % count]
    share = (here - HALF) / (here - beside) if here > beside else 0.5
    return float((middles[place % count] + step * share * BIN_DEG) % 360.0)
