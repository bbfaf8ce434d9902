"""Rigid motions in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation


@dataclass(frozen=True, eq=False)
class RigidMotion:
    """A rotation (3, 3) and then a translation (3,) m: x becomes rotation x + translation."""

    rotation: np.ndarray
    translation: np.ndarray

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Return moved points (k, 3) m."""
        return points @ self.rotation.T + self.translation

    def after(self, first: RigidMotion) -> RigidMotion:
        """Return the motion that does `first` and then this one."""
        return RigidMotion(self.rotation @ first.rotation, self(first.translation[None])[0])

    @property
    def inverse(self) -> RigidMotion:
        """The motion back."""
        return RigidMotion(self.rotation.T, -self.rotation.T @ self.translation)

    @property
    def angle(self) -> float:
        """Angle of the rotation, rad."""
        return float(Rotation.from_matrix(self.rotation).magnitude())


IDENTITY = RigidMotion(np.eye(3), np.zeros(3))


def turned_about(vector: np.ndarray, centre: np.ndarray, translation: np.ndarray) -> RigidMotion:
    """Return the rotation by `vector` (3,) rad about a centre (3,) m, followed by a translation (3,) m."""
    rotation = Rotation.from_rotvec(vector).as_matrix()
    return RigidMotion(rotation, centre - rotation @ centre + translation)


def largest_distance(first: RigidMotion, second: RigidMotion, points: np.ndarray) -> float:
    """Return how far apart two motions put any of the points (k, 3) m, at most, m."""
    return float(np.linalg.norm(first(points) - second(points), axis=1).max())
