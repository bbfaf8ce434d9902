"""How a part moves: its pose at any time in closed form, and the solver's lines that go on with the motion from then.

Wear lives in the part's own (body) frame, the one its surface was drawn in. The solver gets the surface where the part
stands when a wear cycle begins (`Motion.placed`), and lines that move it from there (`Motion.deck_lines`).

LIGGGHTS (3.8.0) adds up what its movers tell it step by step. Its `wiggle` and `riggle` begin at phase 0 wherever they
are defined: a restarted part would swing about another place. They also take the speed at the end of a step for that of
the whole step. Here a speed that changes is a variable: what the closed form goes in the step, over the step. What the
solver adds up is then the closed form itself, in phase after a restart.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from bulkwear.postproc.courses import Steady, Swinging, course_lines, number

PARALLEL = 1e-12  # -, sine of the angle between two directions that count as parallel: rounding of unit vectors

Vector: TypeAlias = tuple[float, float, float]
Pose: TypeAlias = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Motion:
    """How a part moves; this one stays where it was drawn."""

    def pose(self, time_s: float) -> Pose:
        """Return rotation (3, 3) and translation (3,) m at that time: x_space = rotation @ x_body + translation."""
        return np.eye(3), np.zeros(3)

    def placed(self, points: np.ndarray, time_s: float) -> np.ndarray:
        """Return where points (n, 3) m of the body are at that time (s), (n, 3) m."""
        rotation, translation = self.pose(time_s)
        return np.asarray(points, dtype=np.float64) @ rotation.T + translation

    def mesh_words(self) -> str:
        """Return the words that end the solver's line of the mesh (`fix mesh/surface`); most motions have none."""
        return ""

    def deck_lines(self, mesh_id: str, time_s: float) -> tuple[str, ...]:
        """Return the solver's lines that move a mesh on from where the part stands at that time (s).

        They go on from the step where they stand, so they stand behind the mesh and `reset_timestep`, before the `run`
        that moves. Fixes and variables begin with `move_<mesh_id>`.
        """
        return self._lines(f"move_{mesh_id}", mesh_id, time_s)

    def _lines(self, name: str, mesh_id: str, time_s: float) -> tuple[str, ...]:
        return ()


@dataclass(frozen=True)
class Straight(Motion):
    """Moves along `vector` (m; m/s on a steady course) times how far the course is."""

    vector: Vector
    course: Steady | Swinging

    def __post_init__(self) -> None:
        _check_vector("direction", self.vector)

    def pose(self, time_s: float) -> Pose:
        """Return rotation (3, 3) and translation (3,) m, see `Motion.pose`."""
        return np.eye(3), np.asarray(self.vector, dtype=np.float64) * self.course.gone(time_s)

    def _lines(self, name: str, mesh_id: str, time_s: float) -> tuple[str, ...]:
        fix = f"fix {name} all move/mesh mesh {mesh_id}"
        pace = self.course.pace(time_s)
        if pace is not None:
            return (f"{fix} linear {_numbers(self.vector)}",) if pace else ()
        speeds = [
            f"variable {name}_{axis} equal {number(value)}*v_{name}_pace"
            for axis, value in zip("xyz", self.vector, strict=True)
        ]
        return (
            *course_lines(name, self.course, time_s),
            *speeds,
            f"{fix} linear/variable v_{name}_x v_{name}_y v_{name}_z",
        )


@dataclass(frozen=True)
class Turning(Motion):
    """Turns about `vector` through `point_m` by `angle` (rad; rad/s on a steady course) times how far the course is."""

    point_m: Vector
    vector: Vector
    angle: float
    course: Steady | Swinging

    def __post_init__(self) -> None:
        _check_vector("axis", self.vector)
        if not (np.all(np.isfinite(self.point_m)) and math.isfinite(self.angle) and self.angle != 0.0):
            raise ValueError(f"a part turns about {self.point_m} by {self.angle}, allowed are finite numbers, not 0")

    def pose(self, time_s: float) -> Pose:
        """Return rotation (3, 3) and translation (3,) m, see `Motion.pose`."""
        rotation = _rotation(self.vector, self.angle * self.course.gone(time_s))
        point = np.asarray(self.point_m, dtype=np.float64)
        return rotation, point - rotation @ point

    def _lines(self, name: str, mesh_id: str, time_s: float) -> tuple[str, ...]:
        fix = f"fix {name} all move/mesh mesh {mesh_id}"
        about = f"origin {_numbers(self.point_m)} axis {_numbers(self.vector)}"
        pace = self.course.pace(time_s)
        if pace is not None:
            return (f"{fix} rotate {about} period {2.0 * math.pi / self.angle:.17g}",) if pace else ()
        return (
            *course_lines(name, self.course, time_s),
            f"variable {name}_omega equal {number(self.angle)}*v_{name}_pace",
            f"{fix} rotate/variable {about} omega v_{name}_omega",
        )


@dataclass(frozen=True)
class Belt(Motion):
    """A surface that moves within itself while the mesh rests; `words` tell the solver its velocity."""

    words: str

    def mesh_words(self) -> str:
        """Return the velocity of the surface in the solver's words."""
        return self.words


@dataclass(frozen=True)
class Combined(Motion):
    """Motions carried by one another: the first carries the second, and so on; the last one moves the body itself."""

    motions: tuple[Straight | Turning, ...]

    def __post_init__(self) -> None:
        for k, motion in enumerate(self.motions):
            if not isinstance(motion, Straight | Turning):
                raise ValueError(f"motion {k} of a combination is a {type(motion).__name__}, allowed are moving ones")
            for earlier in self.motions[:k]:
                if not _may_carry(earlier, motion):
                    raise ValueError(
                        f"motion {k} of a combination is along {motion.vector} and carried round {earlier.vector}; the "
                        "solver keeps directions in space, allowed are parallel ones, or one that is over before"
                    )

    def pose(self, time_s: float) -> Pose:
        """Return rotation (3, 3) and translation (3,) m, see `Motion.pose`."""
        rotation, translation = np.eye(3), np.zeros(3)
        for motion in self.motions:
            own, shift = motion.pose(time_s)
            rotation, translation = rotation @ own, rotation @ shift + translation
        return rotation, translation

    def _lines(self, name: str, mesh_id: str, time_s: float) -> tuple[str, ...]:
        lines: list[str] = []
        for k, motion in enumerate(self.motions):
            if isinstance(motion, Turning):  # its axis stands where the earlier ones have carried it
                point = Combined(self.motions[:k]).placed([motion.point_m], time_s)[0]
                motion = replace(motion, point_m=tuple(point))
            lines += motion._lines(f"{name}_{k + 1}", mesh_id, time_s)
        return tuple(lines)


AT_REST = Motion()


def translation(
    velocity_m_per_s: Vector, start_s: float = 0.0, ramp_s: float = 0.0, stop_s: float = math.inf
) -> Motion:
    """Return a motion with a velocity (3,) m/s, which grows linearly within `ramp_s` after the start.

    It goes down to 0 within as long after the stop. Times in s.
    """
    return Straight(velocity_m_per_s, Steady(start_s, ramp_s, stop_s))


def rotation(
    point_m: Vector,
    axis: Vector,
    angular_velocity_rad_per_s: float,
    start_s: float = 0.0,
    ramp_s: float = 0.0,
    stop_s: float = math.inf,
) -> Motion:
    """Return a right-handed rotation about an axis (3,) through a point (3,) m; starts and stops as `translation`."""
    return Turning(point_m, axis, angular_velocity_rad_per_s, Steady(start_s, ramp_s, stop_s))


def oscillation(amplitude_m: Vector, period_s: float, phase_rad: float = 0.0) -> Motion:
    """Return a swing of amplitude (3,) m about where the part was drawn: amplitude sin(2 pi t / period + phase)."""
    return Straight(amplitude_m, Swinging(period_s, phase_rad))


def angular_oscillation(
    point_m: Vector, axis: Vector, amplitude_rad: float, period_s: float, phase_rad: float = 0.0
) -> Motion:
    """Return a swing about an axis (3,) through a point (3,) m, by amplitude sin(2 pi t / period + phase)."""
    return Turning(point_m, axis, amplitude_rad, Swinging(period_s, phase_rad))


def belt(velocity_m_per_s: Vector) -> Motion:
    """Return a conveyor: the surface has this velocity (3,) m/s, the mesh rests."""
    _check_vector("velocity of a belt", velocity_m_per_s)
    return Belt(f"surface_vel {_numbers(velocity_m_per_s)}")


def turning_surface(point_m: Vector, axis: Vector, angular_velocity_rad_per_s: float) -> Motion:
    """Return a body of revolution that turns within its surface about an axis (3,) through a point (3,) m."""
    _check_vector("axis", axis)
    words = f"origin {_numbers(point_m)} axis {_numbers(axis)} omega {angular_velocity_rad_per_s:.17g}"
    return Belt(f"surface_ang_vel {words}")


def combined(*motions: Motion) -> Motion:
    """Return motions that carry one another, the first one outermost, as on a slide that carries a turning shaft.

    Raises ValueError for belts, and where a turning motion carries one that is not parallel to its axis and not over
    when the turn starts: the solver would keep its direction in space.
    """
    return Combined(motions)


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def _check_vector(what: str, vector: Vector) -> None:
    values = np.asarray(vector, dtype=np.float64)
    if values.shape != (3,) or not np.all(np.isfinite(values)) or not values.any():
        raise ValueError(f"the {what} of a motion is {vector}, allowed are three finite numbers that are not all 0")


def _may_carry(outer: Straight | Turning, inner: Straight | Turning) -> bool:
    """Whether the solver does what is meant when `outer` carries `inner`: it never turns a direction."""
    if not isinstance(outer, Turning) or _are_parallel(outer.vector, inner.vector):
        return True
    courses = (outer.course, inner.course)
    return all(isinstance(course, Steady) for course in courses) and inner.course.end_s <= outer.course.start_s


def _are_parallel(first: Vector, second: Vector) -> bool:
    a, b = (np.asarray(v, dtype=np.float64) / np.linalg.norm(v) for v in (first, second))
    return bool(np.linalg.norm(np.cross(a, b)) <= PARALLEL)


def _rotation(axis: Vector, angle: float) -> np.ndarray:
    """Matrix (3, 3) of a turn by `angle` (rad) about an axis, by Rodrigues' formula."""
    x, y, z = np.asarray(axis, dtype=np.float64) / np.linalg.norm(axis)
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * across + 2.0 * math.sin(0.5 * angle) ** 2 * (across @ across)
