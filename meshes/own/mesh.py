"""A plant's own surface, from CAD and mesh files to what the solver takes: read, weld, turn, check, refine."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bulkwear.meshes.own.check import check_cuts, check_for_solver, check_gaps, check_manifold, sharp_faces
from bulkwear.meshes.own.choices import check_choices, check_long_faces, checked_tolerance
from bulkwear.meshes.own.orient import oriented
from bulkwear.meshes.own.read import check_file, read_solids
from bulkwear.meshes.own.refine import WANTED_ANGLE, Region, across_edges, refined, turned
from bulkwear.meshes.own.repairs import Repair, Repairs, repairs_text, table
from bulkwear.meshes.own.solids import Solids, check_sizes, joined, target_edges
from bulkwear.meshes.own.together import one_mesh
from bulkwear.meshes.own.weld import compacted, stitched, welded
from bulkwear.postproc.mesh import (
    SurfaceMesh,
    areas,
    edge_lengths_per_triangle,
    enclosed_volume,
    obtuse_last,
    smallest_angles,
)


@dataclass(frozen=True)
class Part:
    """What a part of a surface is.

    triangles: how many; closed: whether it has no open edge; area_m2; volume_m3: nan where open; low_m, high_m: corners
    of its bounding box; shortest_edge_m, longest_edge_m; smallest_angle_deg, percentile_1_deg: of smallest angles
    """

    name: str
    triangles: int
    closed: bool
    area_m2: float
    volume_m3: float
    low_m: tuple[float, float, float]
    high_m: tuple[float, float, float]
    shortest_edge_m: float
    longest_edge_m: float
    smallest_angle_deg: float
    percentile_1_deg: float


@dataclass(frozen=True, eq=False)
class OwnMesh:
    """A surface of files, ready for the solver.

    surface: m, with cell data `part` (number in `parts`); parts: in order; repairs: rows of what was mended and of
    warnings; weld_m: tolerance that was used; one_mesh: whether LIGGGHTS takes all parts as one mesh,
    else each part has to be a mesh of its own
    """

    surface: SurfaceMesh
    parts: tuple[Part, ...]
    repairs: tuple[Repair, ...]
    weld_m: float
    one_mesh: bool

    def text(self) -> str:
        """Parts and repairs as two tables of text."""
        welds = f"points within {1e3 * self.weld_m:.3g} mm are one"
        return f"{parts_text(self.parts)}\n\n{repairs_text(self.repairs)}\n{welds}"


def own_mesh(
    files: str | os.PathLike | Sequence[str | os.PathLike],
    unit: str,
    edges: Mapping[str, float] | float | None = None,
    fine: Sequence[Region] = (),
    weld_m: float | None = None,
    smallest_angle_deg: float = WANTED_ANGLE,
    solid: str | None = None,
) -> OwnMesh:
    """Read one or more files of solids and make one surface of them that LIGGGHTS takes as it is.

    Parameters
    ----------
    files : STL (ASCII, binary), STEP, IGES, BREP, OBJ, PLY, VTK, VTU or MSH
    unit : of the files' lengths: m, cm, mm, um, in, ft
    edges : m, target edge of all triangles, or by name of a part, `*` for those that are not named; None: as they are
    fine : regions with smaller targets (`meshes.own.refine`: Ball, Box, NearPlaces, or a function of centroids)
    weld_m : m, points closer than that are one, up to 1 % of the largest extent and a tenth of the smallest edge;
        None: 1e-6 of the largest extent or coordinate
    smallest_angle_deg : degrees, 0 to 45, wanted where edges are given; facets between two creases may keep less
    solid : name of the only part of each file that is taken, whatever the others are; None: all

    The surface stays on the facets: it moves by no more than the weld tolerance. Raises FileNotFoundError, ValueError
    where a file cannot be read, its unit or a choice makes no sense, and `RefusedMeshError` with place and faces where
    the surface has a fault that cannot be mended.
    """
    paths = [Path(files)] if isinstance(files, (str, os.PathLike)) else [Path(each) for each in files]
    if not paths:
        raise ValueError("no file is named, allowed are one or more")
    check_choices(edges, fine, weld_m, smallest_angle_deg)
    for path in paths:
        check_file(path)
    found = [read_solids(path, unit, edges, solid) for path in paths]
    solids = compacted(joined([replace(each, points=each.points * scale) for each, scale in found]))
    check_sizes(solids, unit)
    targets = target_edges(solids.names, edges)
    tolerance = checked_tolerance(solids, targets, fine, weld_m)
    check_long_faces(solids, targets)
    repairs = Repairs(solids.names)
    solids = _mended(solids, tolerance, unit, repairs)
    if np.isfinite(targets).any() or fine:
        solids = refined(solids, targets, fine, tolerance, smallest_angle_deg, repairs)
    elif len(sharp := sharp_faces(solids)):
        solids = turned(solids, np.isin(np.arange(len(targets)), solids.part[sharp]), tolerance, repairs)
    check_for_solver(solids, tolerance, unit)
    together = one_mesh(solids, tolerance, repairs)
    order = np.argsort(solids.part, kind="stable")
    triangles = obtuse_last(solids.points, solids.triangles[order])
    surface = SurfaceMesh(solids.points, triangles, {"part": solids.part[order]})
    parts = tuple(_part(surface, number, name) for number, name in enumerate(solids.names))
    return OwnMesh(surface, parts, tuple(repairs.rows), tolerance, together)


def _mended(solids: Solids, tolerance: float, unit: str, repairs: Repairs) -> Solids:
    """Solids that are welded, joined, wound and sound."""
    solids = welded(solids, tolerance, repairs)
    for number, name in enumerate(solids.names):
        if not (solids.part == number).any():
            raise ValueError(
                f"{solids.source}: part '{name}' has no triangle wider than {tolerance:g} m, allowed is one or more"
            )
    check_gaps(solids, tolerance, unit)
    solids = stitched(solids, tolerance, repairs)
    check_manifold(solids, unit)
    solids = oriented(solids, repairs)
    check_cuts(solids, tolerance, unit, repairs)
    return solids


def _part(surface: SurfaceMesh, number: int, name: str) -> Part:
    """The facts of a part of a surface."""
    points, triangles = surface.points, surface.triangles[surface.cell_data["part"] == number]
    closed = bool((across_edges(triangles) >= 0).all())
    corners = points[triangles].reshape(-1, 3)
    lengths, angles = edge_lengths_per_triangle(points, triangles), smallest_angles(points, triangles)
    return Part(
        name,
        len(triangles),
        closed,
        float(areas(points, triangles).sum()),
        enclosed_volume(points, triangles) if closed else float("nan"),
        tuple(corners.min(axis=0).tolist()),
        tuple(corners.max(axis=0).tolist()),
        float(lengths.min()),
        float(lengths.max()),
        float(angles.min()),
        float(np.percentile(angles, 1)),
    )


def parts_text(parts: Sequence[Part]) -> str:
    """The table of parts as text: counts, bounding box in m, edges in mm, angles in degrees."""
    head = ["part", "triangles", "closed", "area (m2)", "volume (m3)", "from (m)", "to (m)", "edges (mm)"]
    rows = [
        [
            *(part.name, str(part.triangles), "yes" if part.closed else "no", f"{part.area_m2:.6g}"),
            f"{part.volume_m3:.6g}" if part.closed else "",
            *(", ".join(f"{value:.6g}" for value in corner) for corner in (part.low_m, part.high_m)),
            f"{1e3 * part.shortest_edge_m:.3g} to {1e3 * part.longest_edge_m:.3g}",
            f"{part.smallest_angle_deg:.3g} / {part.percentile_1_deg:.3g}",
        ]
        for part in parts
    ]
    return table([*head, "smallest angle / 1 % (degrees)"], rows)
