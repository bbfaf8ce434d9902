"""Plane cuts through triangulated parts: the plane of a section at a place, and the lines that it cuts out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, areas

ON_PLANE = 1e-9  # -, of the size of a mesh: a node so near to the plane counts as beside it
PARALLEL = 0.1  # -, sine between a part's long direction and a face's normal below which its next longest one counts


@dataclass(frozen=True, eq=False)
class SectionPlane:
    """A plane through a place, with two directions in it.

    place: (3,) m; along, out: (3,) unit vectors in it, out of the body; across: (3,) unit vector square to it
    """

    place: np.ndarray
    along: np.ndarray
    out: np.ndarray

    @property
    def across(self) -> np.ndarray:
        """Return the unit normal (3,) of the plane."""
        return np.cross(self.along, self.out)

    def places(self, points: np.ndarray) -> np.ndarray:
        """Return points (n, ..., 3) m of the plane as (n, ..., 2) m along and out of the body, from its place."""
        from_place = np.asarray(points) - self.place
        return np.stack([from_place @ self.along, from_place @ self.out], axis=-1)


def part_plane(mesh: SurfaceMesh, place: np.ndarray, normal: np.ndarray) -> SectionPlane:
    """Return the plane square to a part's long direction that holds a face's normal.

    mesh: of the part; place: (3,) m; normal: (3,) unit vector out of the face
    """
    out = np.asarray(normal, dtype=float) / np.linalg.norm(normal)
    for direction in long_directions(mesh):
        across = direction - (direction @ out) * out
        if np.linalg.norm(across) > PARALLEL:
            break
    across = across / np.linalg.norm(across)
    along = np.cross(out, across)
    return SectionPlane(np.asarray(place, dtype=float), _pointing(along), out)


def _pointing(along: np.ndarray) -> np.ndarray:
    """Return a direction or its opposite, so that its largest component is positive."""
    return along * (np.sign(along[np.abs(along).argmax()]) or 1.0)


def turning_plane(place: np.ndarray, point: np.ndarray, axis: np.ndarray) -> SectionPlane:
    """Return the plane square to an axis through a place; out points to the axis, the part moves against `along`.

    place: (3,) m; point: (3,) m of the axis; axis: (3,), the rotation about it is right-handed
    """
    axis = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    radial = np.asarray(place, dtype=float) - np.asarray(point, dtype=float)
    radial = radial - (radial @ axis) * axis
    radial /= np.linalg.norm(radial)
    return SectionPlane(np.asarray(place, dtype=float), -np.cross(axis, radial), -radial)


def long_directions(mesh: SurfaceMesh) -> np.ndarray:
    """Return the unit directions (3, 3) in which a surface extends, the longest first, by the moments of its area."""
    area, corners = areas(mesh.points, mesh.triangles), mesh.points[mesh.triangles]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))  # of edges: exact for second moments
    from_centre = (middles - area @ corners.mean(axis=1) / area.sum()).reshape(-1, 3)
    _, vectors = np.linalg.eigh((np.repeat(area, 3)[:, None] * from_centre).T @ from_centre)
    return vectors.T[::-1]


def cut(mesh: SurfaceMesh, plane: SectionPlane) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return where a plane cuts a surface.

    lines: (k, 2, 2) m, both ends of the line in each face, along and out of the body; faces: (k,) their numbers
    shares: (k, 2, 3) of a face's corners at each end: its values are shares times those of its nodes
    """
    height = (mesh.points - plane.place) @ plane.across
    size = np.ptp(mesh.points, axis=0).max()
    height = np.where(np.abs(height) < ON_PLANE * size, ON_PLANE * size, height)[mesh.triangles]
    faces = np.flatnonzero((height > 0.0).any(axis=1) & (height < 0.0).any(axis=1))
    height = height[faces]
    above = height > 0.0
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (~above).argmax(axis=1))
    shares = np.zeros((len(faces), 2, 3))
    rows = np.arange(len(faces))
    for end in (0, 1):
        other = (alone + 1 + end) % 3
        share = height[rows, other] / (height[rows, other] - height[rows, alone])
        shares[rows, end, alone], shares[rows, end, other] = share, 1.0 - share
    points = np.einsum("kec,kcx->kex", shares, mesh.points[mesh.triangles[faces]])
    return plane.places(points), faces, shares


def values_on(mesh: SurfaceMesh, values: np.ndarray, faces: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """Return values (n,) of nodes at the ends (k, 2) of the lines of a cut."""
    return np.einsum("kec,kc->ke", shares, np.asarray(values)[mesh.triangles[faces]])
