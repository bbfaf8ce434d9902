"""One wear update of a surface mesh, called after every cycle, and its depths."""

from __future__ import annotations

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, areas, boundary_nodes, smallest_angles, unit_normals, worn_faces
from bulkwear.postproc.wear.balance import check_growth, with_swept_rim
from bulkwear.postproc.wear.built_shape import PRISTINE_RISE, face_labels, with_turned_shape
from bulkwear.postproc.wear.depth import add_removed_thickness, height_loss, ray_and_normal_depth
from bulkwear.postproc.wear.directions import SliceEnds, inward_directions, rim_directions, slice_directions
from bulkwear.postproc.wear.displacement import Displacement, volume_at_corners
from bulkwear.postproc.wear.fields import (
    CARRIED_VOLUME,
    FREE_RIM,
    HEIGHT_LOSS,
    NORMAL_DEPTH,
    RAY_DEPTH,
    REMOVED_THICKNESS,
)
from bulkwear.postproc.wear.patch import ContactPatch, spread
from bulkwear.postproc.wear.schemes import scheme_of
from bulkwear.postproc.wear.side import PIECE, turned_to_flow
from bulkwear.postproc.wear.thickness import (
    LOCAL_THICKNESS,
    REMAINING_THICKNESS,
    remaining_thickness,
    room_to_back,
    with_lost_thickness,
    with_turned_thickness,
    worn_through,
)

UPRIGHT = 0.2  # -, sine: coarse faces at the foot of a half ellipsoid lean over by 6 degrees; they count as upright
LEAST_PLAN = 0.5  # -, area in plan over area: a surface is steeper than 60 degrees on average below
BACKS = ("go_on", "cap")  # what a node does whose local thickness is worn away


def free_rim(mesh: SurfaceMesh) -> np.ndarray:
    """Mask (n,) of the nodes on an open edge of the worn faces: there a plate ends and its edge wears."""
    mask, worn = np.zeros(len(mesh.points), dtype=bool), np.zeros(len(mesh.points), dtype=bool)
    mask[boundary_nodes(mesh.triangles)] = True
    worn[mesh.triangles[worn_faces(mesh)]] = True
    return mask & worn


def wear_update(
    mesh: SurfaceMesh,
    worn_volume: np.ndarray,
    step_limit: np.ndarray | None = None,
    wall: tuple[float, float, float] | None = None,
    patch: ContactPatch | None = None,
    scheme: str = "conserving",
    pressed: tuple[np.ndarray, np.ndarray] | None = None,
    back: str = "go_on",
    slice_ends: SliceEnds | None = None,
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
    pressed : (m,) N s each, on front and back of the faces (`postproc.wear.ledger.pressed_sides`), by which pieces are
        turned first whose normals look away from the particles (`postproc.wear.side`); None: the normals are trusted
    back : "cap" stops nodes at the back where the thickness is known (`postproc.wear.thickness`), "go_on" does not
    slice_ends : of a periodic slice, in whose planes the nodes there stay; None: there is none

    Returns
    -------
    mesh : new points; point data `removed_thickness_m`, `carried_volume_m3`
    record : worn_volume_m3 (this cycle, worn faces only), applied_volume_m3 (this cycle), carried_volume_m3
        (now), beyond_back_volume_m3 (this cycle, the law's at nodes stopped at the back), excess_volume_m3 (applied
        this cycle beyond what was due and is not carried: rounding for `conserving`, several times the wear for
        `per_triangle`), largest_step_m, smallest_angle_deg (worn faces), largest_depth_m and rim_recession_m (of the
        removed thickness, off and on the free rim), turned_faces, through_nodes

    Raises ValueError and StepTooLargeError as `displace`, `spread` and `scheme_of`, TouchedSideError as
    `turned_to_flow`, and GrowthError where a touched face would leave the body.
    """
    _check_back(back)
    worn, turned = worn_faces(mesh), []
    if pressed is not None:
        mesh, turned = turned_to_flow(mesh, *pressed, worn)
        round_about = np.isin(mesh.cell_data[PIECE], [piece.piece for piece in turned])
        mesh = with_turned_thickness(with_turned_shape(mesh, round_about), round_about)
    if back == "cap" and LOCAL_THICKNESS in mesh.point_data:
        step_limit = _limit_at_back(mesh, worn & (np.asarray(worn_volume) > 0.0), step_limit)
    rim = _rim(mesh, wall, slice_ends)
    moved = _moved(mesh, worn_volume, step_limit, rim, patch, scheme)
    thickness = add_removed_thickness(_point_data(mesh, REMOVED_THICKNESS), moved.step)
    fields = {REMOVED_THICKNESS: thickness, CARRIED_VOLUME: moved.carried_volume}
    moved_mesh = SurfaceMesh(moved.points, mesh.triangles, mesh.cell_data, mesh.point_data | fields)
    result = with_lost_thickness(mesh, moved_mesh)
    through = worn_through(result)
    gone = through & (back == "cap")
    beyond = float(moved.carried_volume[gone].sum())
    result.point_data[CARRIED_VOLUME] = np.where(gone, 0.0, moved.carried_volume)
    record = _record(mesh, result, moved, float(np.sum(worn_volume, where=worn)), beyond)
    counts = {"turned_faces": sum(piece.faces for piece in turned), "through_nodes": int(through.sum())}
    return with_swept_rim(mesh, result), record | counts


def _check_back(back: str) -> None:
    if back not in BACKS:
        raise ValueError(f"back is '{back}', allowed are: {', '.join(BACKS)}")


def _limit_at_back(mesh: SurfaceMesh, worn: np.ndarray, step_limit: np.ndarray | None) -> np.ndarray:
    """The limits (n,) m of the nodes' steps, none of which goes beyond the back."""
    room = room_to_back(mesh, worn)
    return room if step_limit is None else np.fmin(step_limit, room)


def _rim(mesh: SurfaceMesh, wall: tuple[float, float, float] | None, ends: SliceEnds | None) -> np.ndarray | None:
    """Directions (n, 3) that nodes at the rim are given, NaN elsewhere; None where none are."""
    worn = worn_faces(mesh)
    if wall is not None:
        return rim_directions(mesh.points, mesh.triangles, worn, wall)
    return None if ends is None else slice_directions(mesh.points, mesh.triangles, ends, worn)


def _moved(mesh, worn_volume, step_limit, rim, patch, scheme) -> Displacement:
    """Nodes moved by the scheme, every touched face into the body; rim: directions at nodes that are given one, the
    other arguments as in `wear_update`.
    """
    worn = worn_faces(mesh)
    volume = worn_volume if patch is None else spread(mesh.points, mesh.triangles, worn_volume, patch, worn)
    carried, label = _point_data(mesh, CARRIED_VOLUME), face_labels(mesh)
    rise = mesh.point_data.get(PRISTINE_RISE)
    moved = scheme_of(scheme)(mesh.points, mesh.triangles, volume, carried, step_limit, rim, worn, label, rise)
    touched = worn & (volume_at_corners(volume) > 0.0).any(axis=1)
    check_growth(mesh.points, moved.points - mesh.points, mesh.triangles, touched)
    return moved


def _record(mesh: SurfaceMesh, result: SurfaceMesh, moved: Displacement, law: float, beyond: float) -> dict[str, float]:
    """Volumes (m3) and lengths (m) of an update; law: of the wear law, beyond: what it took where no part is left."""
    applied, kept = float(moved.applied_volume.sum()), float(result.point_data[CARRIED_VOLUME].sum())
    before = float(_point_data(mesh, CARRIED_VOLUME).sum())
    thickness, at_rim = result.point_data[REMOVED_THICKNESS], free_rim(result)
    angles = smallest_angles(result.points, result.triangles[worn_faces(result)])
    return {
        "worn_volume_m3": law,
        "applied_volume_m3": applied,
        "carried_volume_m3": kept,
        "beyond_back_volume_m3": beyond,
        "excess_volume_m3": applied + kept + beyond - before - law,
        "largest_step_m": float(moved.step.max(initial=0.0)),
        "smallest_angle_deg": float(angles.min(initial=60.0)),
        "largest_depth_m": float(thickness.max(initial=0.0, where=~at_rim)),
        "rim_recession_m": float(thickness.max(initial=0.0, where=at_rim)),
    }


def with_depths(worn: SurfaceMesh, pristine: SurfaceMesh) -> SurfaceMesh:
    """The worn surface with its depth fields as point data, see `postproc.wear.depth`.

    `ray_depth_m`, `normal_depth_m`, `free_rim`; `height_loss_m` where the vertical makes sense (`stands_over_plan`);
    `remaining_thickness_m` where the surface has its local thickness. Depths are sought where the removed thickness is
    above 0, and are 0 elsewhere. `pristine` is the surface before any wear, in the same frame, m; its triangulation may
    differ (after remeshing).
    """
    thickness = _point_data(worn, REMOVED_THICKNESS)
    touched = np.flatnonzero(thickness > 0.0)
    outward = -inward_directions(worn.points, worn.triangles, worn_faces(worn))
    at, old = worn.points[touched], (pristine.points, pristine.triangles)
    along_normals = ray_and_normal_depth(at, outward[touched], thickness[touched], *old)
    found = dict(zip((RAY_DEPTH, NORMAL_DEPTH), along_normals, strict=True))
    if stands_over_plan(worn, pristine):
        found[HEIGHT_LOSS] = height_loss(at, *old)
    fields = {name: np.zeros(len(thickness)) for name in found}
    for name, values in found.items():
        fields[name][touched] = values
    if LOCAL_THICKNESS in worn.point_data:
        fields[REMAINING_THICKNESS] = remaining_thickness(worn)
    fields[FREE_RIM] = free_rim(worn).astype(np.int64)
    return SurfaceMesh(worn.points, worn.triangles, worn.cell_data, worn.point_data | fields)


def stands_over_plan(worn: SurfaceMesh, pristine: SurfaceMesh) -> bool:
    """Whether height losses make sense: the worn faces of the pristine surface look up, and its plan is still the same.

    None of them may look down, and half of their area is to be seen from above. The rim of the worn faces must lie over
    that of before: then every place of either surface is above or below one of the other.
    """
    faces = pristine.triangles[worn_faces(pristine)]
    upward, size = unit_normals(pristine.points, faces)[:, 2], areas(pristine.points, faces)
    if (upward < -UPRIGHT).any() or upward @ size < LEAST_PLAN * size.sum():
        return False
    rims = [
        np.unique(mesh.points[boundary_nodes(mesh.triangles[worn_faces(mesh)])][:, :2], axis=0)
        for mesh in (pristine, worn)
    ]
    return np.array_equal(*rims)


def _point_data(mesh: SurfaceMesh, name: str) -> np.ndarray:
    return np.asarray(mesh.point_data.get(name, np.zeros(len(mesh.points))), dtype=np.float64)
