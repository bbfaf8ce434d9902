"""Height and face angles of the lifters in a drum's liner, from its surface, new or worn.

Lifters are found in the profile: the distance of the inner surface from the axis by angle, the median of planes square
to the axis along the surface, so that neither a pit nor an end wall or neck counts. A lifter is where the surface is
nearer to the axis than half way between plates and crests. Its height is the largest less the smallest distance between
the middles of the plates on both sides of it. A face is the straight line, by least squares, through the profile
between 20 and 80 % of its height, so rounded edges and hollows at its foot do not count. Its angle is that to the
radius through the lifter's middle, as face angles are drawn: 0 of an upright face, larger the more it leans back. What
a crest hides from the axis is not seen: an upright face is told as the ray past its crest, 1 or 2 degrees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

PLANES = 15  # along the axis
ANGLES = 36_000  # of a turn: 0.4 mm apart in a mill of 4 m, a steep face has tens of them
EXTREMES = (0.02, 0.98)  # -, quantiles of the profile that tell crests and plates: single pits and burrs do not
SECTORS = 36  # of a turn, of which the FEWEST nearest to the axis tell narrow crests: one burr is in two at most
LEAST_HEIGHT = 0.003  # -, over the radius of the plates: a smooth drum of 41 facets or more varies less
FEWEST = 3  # lifters: an axis beside the middle looks like one, an oval drum like two
EITHER_WAY = 0.1  # -, of the height to both sides of half way: a rough face there is not counted as several
ON_FACE = (0.2, 0.8)  # -, of the height, between which a face is fitted
LEVELS = 101  # of the height there, evenly apart; the middle one is half way up
AT_END = 1e-6  # -, of the step of the angle: a ray so near beside a line's end meets it


@dataclass(frozen=True, eq=False)
class Lifters:
    """The lifters of a drum in the order in which they pass, none of a smooth drum.

    height_m: (k,) crest above plates
    leading_face_deg, trailing_face_deg: (k,) degrees of the face that looks ahead in the sense of rotation, and of the
        other, from the radius through the lifter's middle; positive where the foot is wider than the crest
    """

    height_m: np.ndarray
    leading_face_deg: np.ndarray
    trailing_face_deg: np.ndarray

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.height_m)


def lifter_profile(points: np.ndarray, triangles: np.ndarray, point: np.ndarray, axis: np.ndarray) -> Lifters:
    """Find the lifters of a drum.

    points: (n, 3) m; triangles: (m, 3), with or without the back of the liner
    point: (3,) m on the axis of the shell; axis: (3,), the rotation about it is right-handed
    A surface that does not close round the axis, and one whose crests stand less than LEAST_HEIGHT above its plates,
    has none. Where crests differ, those below half of the highest ones are not found.
    """
    profile = inner_profile(points, triangles, point, axis)
    ends = _plate_middles(profile) if np.isfinite(profile).all() else np.zeros(0, dtype=np.int64)
    if len(ends) < FEWEST:
        return Lifters(*np.zeros((3, 0)))
    spans = zip(ends, np.append(ends[1:], ends[0] + len(profile)), strict=True)
    return Lifters(*np.transpose([_lifter(profile[np.arange(low, high + 1) % len(profile)]) for low, high in spans]))


def inner_profile(points: np.ndarray, triangles: np.ndarray, point: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """Return the distance (ANGLES,) m of the inner surface from the axis by angle, infinite where there is none.

    Angles run evenly round in the sense of rotation, from no particular place; arguments as for `lifter_profile`
    """
    along = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    side = np.cross(along, np.eye(3)[np.abs(along).argmin()])
    side /= np.linalg.norm(side)
    places = (np.asarray(points, dtype=float) - point) @ np.array([side, np.cross(along, side), along]).T
    low, high = places[:, 2].min(), places[:, 2].max()
    planes = low + (np.arange(PLANES) + 0.5) / PLANES * (high - low)
    return np.median([_nearest(_section(places, triangles, plane)) for plane in planes], axis=0)


def _section(places: np.ndarray, triangles: np.ndarray, plane: float) -> np.ndarray:
    """Return the lines (k, 2, 2) m in which a surface meets the plane at a third coordinate."""
    height = places[:, 2][triangles] - plane
    above = height > 0.0
    cut = above.any(axis=1) & ~above.all(axis=1)
    height, above, corners = height[cut], above[cut], places[:, :2][triangles[cut]]
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), above.argmin(axis=1))
    rows, ends = np.arange(len(alone)), []
    for step in (1, 2):
        other = (alone + step) % 3
        share = height[rows, alone] / (height[rows, alone] - height[rows, other])
        ends.append(corners[rows, alone] + share[:, None] * (corners[rows, other] - corners[rows, alone]))
    return np.stack(ends, axis=1)


def _nearest(lines: np.ndarray) -> np.ndarray:
    """Return the distance (ANGLES,) m at which rays from the origin first meet lines (k, 2, 2) m."""
    step = 2.0 * math.pi / ANGLES
    angle = np.arctan2(lines[..., 1], lines[..., 0])
    turn = (angle[:, 1] - angle[:, 0] + math.pi) % (2.0 * math.pi) - math.pi
    start = np.where(turn >= 0.0, angle[:, 0], angle[:, 1])
    first = np.ceil(start / step - AT_END).astype(np.int64)
    last = np.floor((start + np.abs(turn)) / step + AT_END).astype(np.int64)
    count = np.maximum(last - first + 1, 0)
    own = np.repeat(np.arange(len(lines)), count)
    ray = first[own] + np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    x, y = np.cos(ray * step), np.sin(ray * step)
    beside = lines[own, :, 0] * y[:, None] - lines[own, :, 1] * x[:, None]  # of both ends, from the ray
    across = beside[:, 0] - beside[:, 1]
    share = np.clip(np.divide(beside[:, 0], across, out=np.zeros(len(ray)), where=across != 0.0), 0.0, 1.0)
    met = lines[own, 0] + share[:, None] * (lines[own, 1] - lines[own, 0])
    found = np.full(ANGLES, np.inf)
    np.minimum.at(found, ray % ANGLES, np.hypot(met[:, 0], met[:, 1]))
    return found


def _plate_middles(profile: np.ndarray) -> np.ndarray:
    """Return where in the profile the middle of the plate before each lifter is, (k,), in rising order."""
    crest, plate = _extremes(profile)
    if plate - crest < LEAST_HEIGHT * plate:
        return np.zeros(0, dtype=np.int64)
    outward = (profile - crest) / (plate - crest) - 0.5
    shift = int(profile.argmax())  # there is a plate
    side = np.roll(np.where(np.abs(outward) > EITHER_WAY, np.sign(outward), 0.0), -shift)
    sure = np.flatnonzero(side)
    begins, ends = sure[1:][np.diff(side[sure]) < 0.0], sure[np.diff(side[sure], append=1.0) > 0.0]
    ends = np.roll(ends, 1) - len(profile) * (np.arange(len(ends)) == 0)  # of the lifter before
    return shift + (begins + ends) // 2


def _extremes(profile: np.ndarray) -> tuple[float, float]:
    """Return the distances (m) of crests and plates from the axis. Lifters so narrow that the quantile of crests lies
    below half of their height, or on plates, come as near as the profile does in FEWEST sectors.
    """
    crest, plate = np.quantile(profile, EXTREMES)
    nearest = np.sort(profile.reshape(SECTORS, -1).min(axis=1))[FEWEST - 1]
    return float(crest if crest < 0.5 * (nearest + plate) else nearest), float(plate)


def _lifter(radii: np.ndarray) -> tuple[float, float, float]:
    """Return height (m) and angles (degrees) of the leading and trailing face of a lifter; radii: (k,) m of the profile
    from the middle of the plate that follows it to that of the plate it follows, in the sense of rotation.
    """
    crest = int(radii.argmin())
    ahead, behind = _face(radii[crest:]), _face(radii[crest::-1])
    step = 2.0 * math.pi / ANGLES
    middle = 0.5 * (ahead[0][LEVELS // 2] - behind[0][LEVELS // 2])
    leading, trailing = (
        _face_angle(step * (places - off), levels) for (places, levels), off in ((ahead, middle), (behind, -middle))
    )
    return float(radii.max() - radii[crest]), leading, trailing


def _face(radii: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the places (LEVELS,), in steps of the profile, where a face crosses levels of its height, and those
    levels (LEVELS,) m; radii: (k,) m of the profile from the crest to the middle of the plate.
    """
    crest, plate = radii[0], radii.max()
    share = ON_FACE[0] + (np.arange(LEVELS) + 0.5) / LEVELS * (ON_FACE[1] - ON_FACE[0])
    levels = plate - share * (plate - crest)
    half = int(np.argmax(radii >= 0.5 * (crest + plate)))
    before = np.array([_last_before(radii, half, level) for level in levels])
    return before + (levels - radii[before]) / (radii[before + 1] - radii[before]), levels


def _last_before(radii: np.ndarray, half: int, level: float) -> int:
    """Return the last place before a profile crosses a level, as near to the one half way up as may be, so that dents
    in crest and plate do not count.
    """
    if level <= radii[half]:
        return int(np.flatnonzero(radii[:half] < level)[-1])
    return half + int(np.argmax(radii[half:] >= level)) - 1


def _face_angle(angle: np.ndarray, radii: np.ndarray) -> float:
    """Return the degrees between a face and the radius at angle 0; angle: (k,) rad away from it; radii: (k,) m."""
    away, out = radii * np.sin(angle), radii * np.cos(angle)
    out -= out.mean()
    return math.degrees(math.atan((out @ away) / (out @ out)))
