"""Volume lost by a surface of any shape and attitude, measured on the geometry alone, and the balance of volumes.

The volume between two surfaces is the difference of the cones from one origin over them, less the cone over what their
rims swept. With x the position and A the area vector, C = 1/3 integral x . dA, and while the surface moves with the
velocity v,

    dC/dt = integral v . dA + 1/3 contour integral (x cross v) . dl

(transport theorem and Stokes). Over one update nodes move straight, so that the last term is quadratic in time along
every edge of the rim and Simpson's rule is exact. It is summed over the updates; a rim that rests adds nothing. Faces
that are still where they were cancel and are left out, which keeps rounding that of the worn place alone.
"""

from __future__ import annotations

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, area_vectors, boundary_edges, worn_faces
from bulkwear.postproc.wear.displacement import swept_volume
from bulkwear.postproc.wear.face_kernels import corner_words, rows_among
from bulkwear.postproc.wear.remesh_patch import six_volumes
from bulkwear.postproc.wear.side import turned_as

BALANCE_TOLERANCE = 1e-9  # -, of alpha * work: rounding in sums over 1e6 triangles stays far below, a loss not
RIM_VOLUME, RIM_AREA = "rim_volume_m3", "rim_area_m2"  # point data, see `with_swept_rim`
GEOMETRY_ROUNDING = 1e-13  # -, of the cones over the changed faces: their sum over 1e5 triangles is good to 1e-14
GROWTH_TOLERANCE = 1e-6  # -, of area times step: rounding; faces that lead out of the body do so by 0.1 and more
METRES_TO_MM = 1e3


class BalanceError(RuntimeError):
    """Worn volume was lost or invented: applied + carried differs from the volume of the wear law."""


class GrowthError(RuntimeError):
    """A touched face would leave the body: the surface would grow towards the particles."""


def with_swept_rim(before: SurfaceMesh, after: SurfaceMesh) -> SurfaceMesh:
    """The mesh `after` one update with what its rim has swept added to point data, which `lost_volume` needs.

    `rim_volume_m3` (n,): cone from the origin over the strip that the rim of the worn faces has swept since it was
    pristine; `rim_area_m2` (n, 3): area vector of that strip, with which the cone is known from any other point. Each
    edge of the rim gives half to either end. Meshes whose rim rests come back as they are.
    """
    faces, motion = before.triangles[worn_faces(before)], after.points - before.points
    edges = boundary_edges(faces)
    edges = edges[motion[edges].any(axis=(1, 2))]
    if not edges.size:
        return after
    volume = np.array(after.point_data.get(RIM_VOLUME, np.zeros(len(after.points))), dtype=np.float64)
    area = np.array(after.point_data.get(RIM_AREA, np.zeros((len(after.points), 3))), dtype=np.float64)
    start, move = before.points[edges], motion[edges]
    mean = move.mean(axis=1)
    for time, weight in ((0.0, 1.0), (0.5, 4.0), (1.0, 1.0)):
        ends = start + time * move
        along = ends[:, 1] - ends[:, 0]
        cone = weight / 18.0 * np.einsum("ij,ij->i", np.cross(ends[:, 0], mean), along)
        strip = weight / 6.0 * np.cross(mean, along)
        for end in (0, 1):
            np.add.at(volume, edges[:, end], 0.5 * cone)
            np.add.at(area, edges[:, end], 0.5 * strip)
    fields = {RIM_VOLUME: volume, RIM_AREA: area}
    return SurfaceMesh(after.points, after.triangles, after.cell_data, after.point_data | fields)


def lost_volume(pristine: SurfaceMesh, present: SurfaceMesh) -> tuple[float, float]:
    """Volume (m3) swept by the worn faces since they were pristine, and its rounding error (m3).

    pristine, present: in one frame; the present one as updates left it, remeshed or not. Exact for closed bodies and
    open plates at any attitude, of any number of pieces, whether their rims rest or recede.
    """
    origin = pristine.points.mean(axis=0)
    before, after = _changed_cones(turned_as(pristine, present), present, origin)
    rim = np.unique(boundary_edges(present.triangles[worn_faces(present)]))
    swept = 0.0
    if RIM_VOLUME in present.point_data:
        volume, area = present.point_data[RIM_VOLUME][rim], present.point_data[RIM_AREA][rim]
        swept = float(volume.sum() - area.sum(axis=0) @ origin / 3.0)
    lost = float(before.sum() - after.sum()) / 6.0 + swept
    return lost, GEOMETRY_ROUNDING * float(np.abs(before).sum() + np.abs(after).sum()) / 6.0


def _changed_cones(before: SurfaceMesh, after: SurfaceMesh, origin: np.ndarray) -> list[np.ndarray]:
    """Six times the cones over the worn faces of either surface that the other one has not, bit for bit."""
    faces = [mesh.triangles[worn_faces(mesh)] for mesh in (before, after)]
    words = [corner_words(mesh.points, each) for mesh, each in zip((before, after), faces, strict=True)]
    return [
        six_volumes(mesh.points, each[~rows_among(own, other)], origin)
        for mesh, each, own, other in zip((before, after), faces, words, words[::-1], strict=True)
    ]


def volume_balance(applied_total: float, carried: float, law_total: float, rounding: float = 0.0) -> float:
    """Relative error |applied + carried - law| / law of the volumes (m3), law = alpha * work over all cycles.

    `rounding` (m3) is what the applied volume may be off because of the way it was measured.

    Raises
    ------
    BalanceError : the error is above `BALANCE_TOLERANCE`, or is not a number.
    """
    error = abs(applied_total + carried - law_total)
    relative = error / abs(law_total) if law_total else (np.inf if error else 0.0)
    if not error <= BALANCE_TOLERANCE * abs(law_total) + rounding:
        raise BalanceError(
            f"applied {applied_total:.12g} m3 + carried {carried:.12g} m3 differ from the worn volume "
            f"{law_total:.12g} m3 by {relative:.3g} of it, allowed is {BALANCE_TOLERANCE}"
        )
    return float(relative)


def check_growth(points: np.ndarray, motion: np.ndarray, triangles: np.ndarray, touched: np.ndarray) -> None:
    """Raise GrowthError if a touched face sweeps volume out of the body.

    points (n, 3) m before; motion (n, 3) m; triangles (m, 3), normals out of the body; touched (m,) bool, faces that
    lose volume by the wear law
    """
    faces = triangles[touched]
    swept = swept_volume(points, motion, faces)
    size = np.linalg.norm(area_vectors(points, faces), axis=1)
    step = np.linalg.norm(motion, axis=1)[faces].max(axis=1, initial=0.0)
    grown = np.flatnonzero(swept < -GROWTH_TOLERANCE * size * step)
    if grown.size:
        at = grown[np.argmin(swept[grown])]
        x, y, z = METRES_TO_MM * points[faces[at]].mean(axis=0)
        raise GrowthError(
            f"{grown.size} touched faces would leave the body, most at ({x:.4g}, {y:.4g}, {z:.4g}) mm, by "
            f"{-swept[at] / size[at]:.3g} m; allowed is wear into the body: smaller updates, or a finer mesh there"
        )
