"""One wear update of a surface mesh, called after every cycle, and the checks that go with it."""

from __future__ import annotations

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, smallest_angles, volume_above_plane
from bulkwear.postproc.wear.depth import add_removed_thickness, height_loss, ray_depth
from bulkwear.postproc.wear.directions import inward_directions, rim_directions
from bulkwear.postproc.wear.patch import ContactPatch, spread
from bulkwear.postproc.wear.schemes import scheme_of

BALANCE_TOLERANCE = 1e-9  # -, of alpha * work: rounding in sums over 1e6 triangles stays far below, a loss not
GEOMETRY_ROUNDING = 1e-13  # -, of the volume under a sample: its sum over 1e5 triangles is good to about 1e-14
HOLDER_PART = -1  # label of the faces that do not wear

REMOVED_THICKNESS = "removed_thickness_m"
HEIGHT_LOSS = "height_loss_m"
RAY_DEPTH = "ray_depth_m"
CARRIED_VOLUME = "carried_volume_m3"


class BalanceError(RuntimeError):
    """Worn volume was lost or invented: applied + carried differs from the volume of the wear law."""


def worn_faces(mesh: SurfaceMesh) -> np.ndarray:
    """Mask (m,) of the faces that wear: `part` >= 0; all faces where the mesh has no `part`."""
    part = mesh.cell_data.get("part", np.zeros(len(mesh.triangles), dtype=np.int64))
    return np.asarray(part) > HOLDER_PART


def wear_update(
    mesh: SurfaceMesh,
    worn_volume: np.ndarray,
    step_limit: np.ndarray | None = None,
    wall: tuple[float, float, float] | None = (0.0, 0.0, -1.0),
    patch: ContactPatch | None = None,
    scheme: str = "conserving",
) -> tuple[SurfaceMesh, dict[str, float]]:
    """Wear the mesh by one cycle.

    Parameters
    ----------
    mesh : present surface, m; point data of earlier updates are taken up (zero where absent)
    worn_volume : (m,) m3 >= 0 of this cycle; ignored on the holder
    step_limit : (n,) m, see `postproc.wear.caps`; None: no caps, too large a step is refused
    wall : direction in which nodes at the rim of the worn faces slide; None: along their normal, like others
    patch : contact positions, in the frame of the mesh, and radii over which the wear is spread, see
        `postproc.wear.patch`; None: a third of each triangle's wear goes to each of its corners
    scheme : name in `postproc.wear.schemes.SCHEMES`

    Returns
    -------
    mesh : new points; point data `removed_thickness_m`, `carried_volume_m3`
    record : worn_volume_m3 (this cycle, worn faces only), applied_volume_m3 (this cycle), carried_volume_m3
        (now), excess_volume_m3 (applied this cycle beyond what was due and is not carried: rounding for
        `conserving`, several times the wear for `per_triangle`), largest_step_m, smallest_angle_deg (worn
        faces), largest_depth_m (of the removed thickness)

    Raises
    ------
    ValueError, StepTooLargeError : see `displace`, `spread` and `scheme_of`.
    """
    worn = worn_faces(mesh)
    carried = _point_data(mesh, CARRIED_VOLUME)
    rim = None if wall is None else rim_directions(mesh.points, mesh.triangles, worn, wall)
    volume = worn_volume if patch is None else spread(mesh.points, mesh.triangles, worn_volume, patch, worn)
    part = mesh.cell_data.get("part")
    moved = scheme_of(scheme)(mesh.points, mesh.triangles, volume, carried, step_limit, rim, worn, part)
    thickness = add_removed_thickness(_point_data(mesh, REMOVED_THICKNESS), moved.step)
    fields = {REMOVED_THICKNESS: thickness, CARRIED_VOLUME: moved.carried_volume}
    law, applied, left = (
        float(v) for v in (np.sum(worn_volume, where=worn), moved.applied_volume.sum(), moved.carried_volume.sum())
    )
    record = {
        "worn_volume_m3": law,
        "applied_volume_m3": applied,
        "carried_volume_m3": left,
        "excess_volume_m3": applied + left - float(carried.sum()) - law,
        "largest_step_m": float(moved.step.max(initial=0.0)),
        "smallest_angle_deg": float(smallest_angles(moved.points, mesh.triangles[worn]).min(initial=60.0)),
        "largest_depth_m": float(thickness.max(initial=0.0)),
    }
    return SurfaceMesh(moved.points, mesh.triangles, mesh.cell_data, mesh.point_data | fields), record


def with_depths(worn: SurfaceMesh, pristine: SurfaceMesh) -> SurfaceMesh:
    """The worn surface with `height_loss_m` and `ray_depth_m` as point data (see `postproc.wear.depth`).

    Both are sought where the surface's removed thickness is above 0, and are 0 elsewhere. `pristine` is the surface
    before any wear, in the same frame, m; its triangulation may differ (after remeshing).
    """
    thickness = _point_data(worn, REMOVED_THICKNESS)
    touched = np.flatnonzero(thickness > 0.0)
    outward = -inward_directions(worn.points, worn.triangles, worn_faces(worn))
    fields = {HEIGHT_LOSS: np.zeros(len(thickness)), RAY_DEPTH: np.zeros(len(thickness))}
    at, old = worn.points[touched], (pristine.points, pristine.triangles)
    fields[HEIGHT_LOSS][touched] = height_loss(at, *old)
    fields[RAY_DEPTH][touched] = ray_depth(at, outward[touched], thickness[touched], *old)
    return SurfaceMesh(worn.points, worn.triangles, worn.cell_data, worn.point_data | fields)


def lost_volume(pristine: SurfaceMesh, present: SurfaceMesh) -> tuple[float, float]:
    """Volume (m3) that the worn faces lost since they were pristine, and its rounding error (m3).

    Measured on the geometry alone: the volumes under both surfaces differ. Exact because the rim slides straight down,
    which keeps the footprint; the rounding is that of the volume between the sample and z = 0.
    """
    before, after = (volume_above_plane(mesh.points, mesh.triangles[worn_faces(mesh)]) for mesh in (pristine, present))
    return before - after, GEOMETRY_ROUNDING * abs(before)


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


def recession_fault(mesh: SurfaceMesh, floor_z: float = 0.0, clearance: float = 0.0) -> str | None:
    """Phrase if a node of the worn faces came down to the floor (z <= floor_z + clearance, m), else None."""
    nodes = np.unique(mesh.triangles[worn_faces(mesh)])
    lowest = nodes[np.argmin(mesh.points[nodes, 2])] if len(nodes) else None
    if lowest is None or mesh.points[lowest, 2] > floor_z + clearance:
        return None
    return (
        f"the sample is worn down to the floor: node {lowest} is at z = {mesh.points[lowest, 2]:.4g} m, "
        f"allowed is above {floor_z + clearance:.4g} m"
    )


def _point_data(mesh: SurfaceMesh, name: str) -> np.ndarray:
    return np.asarray(mesh.point_data.get(name, np.zeros(len(mesh.points))), dtype=np.float64)
