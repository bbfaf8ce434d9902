"""The frame of a mesh's own file beside that of the simulation, and the frames of its facets."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Pose = Callable[[int], tuple[np.ndarray, np.ndarray]]


def facet_frames(corners: np.ndarray) -> np.ndarray:
    """Return the frames of facets, (m, 3, 3): rows are the unit vectors along the edge from corner 0 to corner 1,
    across it in the facet (normal x along), and normal to the facet.

    corners: (m, 3, 3) m
    The solver sums vectors in these frames (solver/facet.h): they turn with the mesh.
    """
    along = corners[:, 1] - corners[:, 0]
    normal = np.cross(along, corners[:, 2] - corners[:, 0])
    frames = np.stack([along, np.cross(normal, along), normal], axis=1)
    return frames / np.linalg.norm(frames, axis=2, keepdims=True)


class MeshFrame:
    """Where a mesh stands in the simulation, contact by contact.

    rotation, translation: (n, 3, 3) and (n, 3) m of each contact, x_space = rotation @ x_body + translation; None for
        a mesh at rest
    """

    def __init__(self, rotation: np.ndarray | None = None, translation: np.ndarray | None = None):
        self.rotation, self.translation = rotation, translation

    @classmethod
    def at(cls, pose: Pose | None, steps: np.ndarray, sample: np.ndarray) -> MeshFrame:
        """Return the frame of contacts that were sampled at `steps`, (f,) int, in the samples `sample`, (n,) int."""
        if pose is None:
            return cls()
        poses = [pose(int(step)) for step in steps]
        rotations = np.array([rotation for rotation, _ in poses], np.float64).reshape(-1, 3, 3)
        translations = np.array([translation for _, translation in poses], np.float64).reshape(-1, 3)
        return cls(rotations[sample], translations[sample])

    def of(self, contacts: np.ndarray) -> MeshFrame:
        """Return the frame of some of the contacts, (k,) int."""
        return self if self.rotation is None else MeshFrame(self.rotation[contacts], self.translation[contacts])

    def in_body(self, vectors: np.ndarray) -> np.ndarray:
        """Return vectors (n, 3) of the simulation's frame in the mesh's own."""
        return vectors if self.rotation is None else np.einsum("nji,nj->ni", self.rotation, vectors)

    def in_space(self, vectors: np.ndarray) -> np.ndarray:
        """Return vectors (n, 3) of the mesh's own frame in the simulation's."""
        return vectors if self.rotation is None else np.einsum("nij,nj->ni", self.rotation, vectors)

    def body_points(self, points: np.ndarray) -> np.ndarray:
        """Return points (n, 3) m of the simulation's frame in the mesh's own."""
        return points if self.rotation is None else self.in_body(points - self.translation)

    def images_near(self, points: np.ndarray, places: np.ndarray, periods: np.ndarray) -> np.ndarray:
        """Return points (n, 3) m of the mesh's own frame, each moved to its periodic image nearest to a place.

        places: (n, 3) m, in the mesh's own frame; periods: (3,) m, lengths of the simulation's box in its periodic
        directions, 0 in others
        """
        if not periods.any():
            return points
        offset = self.in_space(points - places)
        turns = np.rint(np.divide(offset, periods, out=np.zeros_like(offset), where=periods > 0.0))
        return points - self.in_body(turns * periods)
