"""Which side of a surface the particles touch: wear goes into the body, whatever way the facets of a file look.

A surface falls into pieces, faces connected over edges. The body of a piece lies behind the side on which particles
press. That is known once they have: a piece whose normals look away from them is turned then, once. So a plate of which
the file has one face wears from the touched side, a closed body from outside, and a closed vessel from inside. A piece
that is pressed from both sides needs a back of its own: a single face can recede into one of its sides only.
"""

from __future__ import annotations

from dataclasses import dataclass

import igl
import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, boundary_edges

SIDE = "side"  # cell data: KNOWN, the normal looks out of the body; UNKNOWN; TURNED, known, and the file's looked in
KNOWN, UNKNOWN, TURNED = 1, 0, -1
PIECE = "piece"  # cell data: number of the connected piece
# Of the normal impulse, -. Open pieces: what grazes a rim from behind stays below, a touched back does not. Closed
# ones: at the lip of a wedge a soft sphere overlaps the face on the other side too, with some per cent of its impulse.
LARGEST_BACK_SHARE, LARGEST_BACK_SHARE_OF_CLOSED = 0.02, 0.3
METRES_TO_MM = 1e3


class TouchedSideError(ValueError):
    """A piece is touched from where its body should be; the message names piece, part, place and impulses."""


@dataclass(frozen=True)
class TurnedPiece:
    """A piece that was turned: its number, the labels of its parts, its faces, the share of its impulse behind."""

    piece: int
    parts: tuple[int, ...]
    faces: int
    share: float


def connected_pieces(triangles: np.ndarray) -> np.ndarray:
    """Number (m,) of the piece that each face belongs to: faces that are connected over edges."""
    return np.asarray(igl.facet_components(np.ascontiguousarray(triangles, dtype=np.int64))[1], dtype=np.int64)


def with_sides(mesh: SurfaceMesh) -> SurfaceMesh:
    """The mesh with cell data `piece` and `side`, which updates and remeshing hand on; those that it has stay."""
    if {SIDE, PIECE} <= mesh.cell_data.keys():
        return mesh
    unknown = np.full(len(mesh.triangles), UNKNOWN, dtype=np.int64)
    added = {PIECE: connected_pieces(mesh.triangles), SIDE: mesh.cell_data.get(SIDE, unknown)}
    return SurfaceMesh(mesh.points, mesh.triangles, mesh.cell_data | added, mesh.point_data)


def turned_to_flow(
    mesh: SurfaceMesh, front: np.ndarray, back: np.ndarray, worn: np.ndarray | None = None
) -> tuple[SurfaceMesh, list[TurnedPiece]]:
    """The mesh with the pieces turned whose normals looked away from the particles, and what was turned.

    Parameters
    ----------
    mesh : a surface; `piece` and `side` are added where it has none, see `with_sides`
    front, back : (m,) N s, >= 0, what particles pressed along the normals on the front (whither the normal looks) and
        on the back of each face, as from `postproc.wear.ledger.pressed_sides`
    worn : (m,) bool, faces that count; None: all

    Returns
    -------
    mesh : same points and order of faces; pieces that nothing has pressed on stay as they are
    told : one entry per piece that was turned

    Raises
    ------
    TouchedSideError : a piece is pressed from both sides, each by more than `LARGEST_BACK_SHARE` of its normal
        impulse (`LARGEST_BACK_SHARE_OF_CLOSED` of a closed one), or from the other side than before.
    """
    mesh = with_sides(mesh)
    piece, side = mesh.cell_data[PIECE], np.array(mesh.cell_data[SIDE])
    counted = np.ones(len(piece)) if worn is None else np.asarray(worn, dtype=np.float64)
    ahead, behind = (np.bincount(piece, counted * values) for values in (front, back))
    share = np.divide(behind, ahead + behind, out=np.zeros_like(ahead), where=ahead + behind > 0.0)
    limit = np.where(_closed(mesh.triangles, piece), LARGEST_BACK_SHARE_OF_CLOSED, LARGEST_BACK_SHARE)
    triangles, told = np.array(mesh.triangles), []
    for number in np.flatnonzero(ahead + behind > 0.0):
        faces = piece == number
        if share[number] <= limit[number]:
            side[faces & (side == UNKNOWN)] = KNOWN
            continue
        if share[number] < 1.0 - limit[number] or (side[faces] != UNKNOWN).any():
            raise TouchedSideError(_fault(mesh, faces, ahead[number], behind[number], back * counted))
        triangles[faces] = triangles[faces][:, [0, 2, 1]]
        side[faces] = TURNED
        told.append(TurnedPiece(int(number), _parts(mesh, faces), int(faces.sum()), float(share[number])))
    if np.array_equal(side, mesh.cell_data[SIDE]):
        return mesh, told
    return SurfaceMesh(mesh.points, triangles, mesh.cell_data | {SIDE: side}, mesh.point_data), told


def _closed(triangles: np.ndarray, piece: np.ndarray) -> np.ndarray:
    """Whether each piece (k,) has no boundary; piece: (m,) as from `connected_pieces`."""
    at_boundary = np.zeros(int(triangles.max()) + 1, dtype=bool)
    at_boundary[boundary_edges(triangles)] = True
    closed = np.ones(int(piece.max()) + 1, dtype=bool)
    closed[piece[at_boundary[triangles].any(axis=1)]] = False
    return closed


def turned_as(pristine: SurfaceMesh, present: SurfaceMesh) -> SurfaceMesh:
    """The pristine surface, as its file has it, with the pieces turned that are turned in the present one."""
    if SIDE not in present.cell_data:
        return pristine
    turned = np.unique(present.cell_data[PIECE][present.cell_data[SIDE] == TURNED])
    if not len(turned):
        return pristine
    faces = np.isin(with_sides(pristine).cell_data[PIECE], turned)
    triangles = np.where(faces[:, None], pristine.triangles[:, [0, 2, 1]], pristine.triangles)
    return SurfaceMesh(pristine.points, triangles, pristine.cell_data, pristine.point_data)


def _fault(mesh: SurfaceMesh, faces: np.ndarray, ahead: float, behind: float, back: np.ndarray) -> str:
    """One sentence on a piece that is pressed on its back; the place is the face that is pressed most there."""
    at = int(np.argmax(np.where(faces, back, -1.0)))
    x, y, z = METRES_TO_MM * mesh.points[mesh.triangles[at]].mean(axis=0)
    parts, known = _parts(mesh, faces), (mesh.cell_data[SIDE][faces] != UNKNOWN).any()
    labels = f"part{'' if len(parts) == 1 else 's'} {', '.join(map(str, parts))}"
    how, allowed = (
        ("on the other side than before", "the side that was touched first; look for particles behind it")
        if known
        else ("from both sides", "one side; give a plate that is touched from both a back, as a closed body")
    )
    return (
        f"piece {int(mesh.cell_data[PIECE][at])} ({labels}, {int(faces.sum())} faces) is pressed {how}: {ahead:.4g} "
        f"N s on the front of its faces, {behind:.4g} N s on their back, most at ({x:.4g}, {y:.4g}, {z:.4g}) mm, "
        f"allowed is {allowed}"
    )


def _parts(mesh: SurfaceMesh, faces: np.ndarray) -> tuple[int, ...]:
    """Labels of the parts among some faces (m,) bool; 0 where the mesh has no parts."""
    return tuple(int(part) for part in np.unique(mesh.cell_data.get("part", np.zeros(len(faces), int))[faces]))
