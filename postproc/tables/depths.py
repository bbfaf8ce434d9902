"""Wear depth on a worn surface, for samples that deform and for rigid ones, and its distribution over the
area.

A sample that deforms has lost `removed_thickness_m` at its nodes; what the law has worn there besides, and caps on a
step have held back, is carried, a volume that over the node's area is a depth as well. A rigid sample keeps its shape:
its depth is equivalent, the worn volume of a triangle over the triangle's area, and was never applied."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, areas, centroids, read_surface, sum_over_nodes, worn_faces
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES, MICROMETRES, MILLIMETRES, SQUARE_MILLIMETRES
from bulkwear.postproc.wear.fields import CARRIED_VOLUME, REMOVED_THICKNESS

WORN_VOLUME = "worn_volume_m3"
HELD_BACK_SHARE = 0.1  # -, of a face's depth: less that is not in the shape yet cannot be seen in it
ROUNDED_SHARE = 1e-9  # -, of the worn volume: less is rounding of the displacement, which balances to that
CORNERS = 3.0  # of a triangle
DISTRIBUTION_LEVELS = 200  # points of a distribution's curve
DISTRIBUTION_DECADES = 3.0  # that a distribution's depths span
DISTRIBUTION_SHARE = 0.999  # -, of the area that a distribution's depths reach


def equivalent_face_depth(mesh: SurfaceMesh) -> np.ndarray:
    """Return worn volume over area of each triangle, (m,) m; NaN on the holder, whose wear does not count."""
    area = areas(mesh.points, mesh.triangles)
    return np.where(worn_faces(mesh), mesh.cell_data[WORN_VOLUME] / area, np.nan)


def face_depth(mesh: SurfaceMesh, deformed: bool) -> np.ndarray:
    """Return the wear depth of each triangle, (m,) m; NaN on the holder.

    deformed: True, mean of its nodes; False, the equivalent depth.
    """
    if not deformed:
        return equivalent_face_depth(mesh)
    return np.where(worn_faces(mesh), node_depth(mesh, True)[mesh.triangles].mean(axis=1), np.nan)


def node_depth(mesh: SurfaceMesh, deformed: bool) -> np.ndarray:
    """Return the wear depth at each node, (n,) m; NaN at nodes of the holder alone.

    deformed: True, removed thickness, and carried volume over area; False, worn volume over area. Area: a third of
        that of the worn triangles round the node; the worn volume is that of those triangles.
    """
    worn = worn_faces(mesh)
    triangles, count = mesh.triangles[worn], len(mesh.points)
    area = sum_over_nodes(triangles, areas(mesh.points, triangles), count)
    if deformed:
        carried = mesh.point_data.get(CARRIED_VOLUME, np.zeros(count))  # a pristine surface has none
        held = np.divide(carried, area / CORNERS, out=np.full(count, np.nan), where=area > 0.0)
        return mesh.point_data[REMOVED_THICKNESS] + held
    volume = sum_over_nodes(triangles, mesh.cell_data[WORN_VOLUME][worn], count)
    return np.divide(volume, area, out=np.full(count, np.nan), where=area > 0.0)


def depth_quantity(deformed: bool) -> str:
    """Return what `face_depth` is called on axes."""
    return "Wear depth, carried included" if deformed else "Equivalent depth, not applied"


def carried_share(mesh: SurfaceMesh) -> float:
    """Return the share of the worn volume that the surface has not lost yet, -; 0 where nothing is worn."""
    total = float(np.sum(mesh.cell_data[WORN_VOLUME], where=worn_faces(mesh)))
    return float(mesh.point_data[CARRIED_VOLUME].sum()) / total if total else 0.0


def held_back_faces(mesh: SurfaceMesh) -> np.ndarray:
    """Return the mask (m,) of worn faces of whose depth caps on a step hold back `HELD_BACK_SHARE` or more."""
    depth = face_depth(mesh, True)
    applied = mesh.point_data[REMOVED_THICKNESS][mesh.triangles].mean(axis=1)
    return worn_faces(mesh) & (depth > 0.0) & (depth - applied >= HELD_BACK_SHARE * depth)


def carried_remark(meshes: Mapping[str, SurfaceMesh], deformed: bool, hatched: bool = True) -> str:
    """Return what a map of depth must say about the volume that is not in the shape; hatched: whether it is hatched."""
    if not deformed:
        return "rigid sample: depth is worn volume over area, not applied"
    share = max(carried_share(mesh) for mesh in meshes.values())
    if abs(share) < ROUNDED_SHARE:
        return "all worn volume is applied, nothing is carried"
    held = f"caps on a step hold back up to {100.0 * share:.3g} % of a run's wear: in the colours, not yet in the shape"
    if hatched and any(held_back_faces(mesh).any() for mesh in meshes.values()):
        return f"{held} (hatched: {100.0 * HELD_BACK_SHARE:.0f} % or more of the depth there)"
    return held


def read_worn_surfaces(runs: Sequence[str], paths: Sequence[str]) -> dict[str, SurfaceMesh]:
    """Return the worn surfaces of runs by name."""
    return {run: read_surface(path) for run, path in zip(runs, paths, strict=True)}


def depth_table(meshes: Mapping[str, SurfaceMesh], deformed: bool) -> pd.DataFrame:
    """Return the worn triangles of all runs: run, triangle, centroid (mm), part, area_mm2, depth_um,
    worn_volume_mm3.
    """
    return pd.concat([_depth_rows(run, mesh, deformed) for run, mesh in meshes.items()], ignore_index=True)


def _depth_rows(run: str, mesh: SurfaceMesh, deformed: bool) -> pd.DataFrame:
    worn = np.flatnonzero(worn_faces(mesh))
    centre = centroids(mesh.points, mesh.triangles[worn]) * MILLIMETRES
    return pd.DataFrame(
        {
            "run": run,
            "triangle": worn,
            **{f"{axis}_mm": centre[:, k] for k, axis in enumerate("xyz")},
            "part": mesh.cell_data["part"][worn],
            "area_mm2": areas(mesh.points, mesh.triangles[worn]) * SQUARE_MILLIMETRES,
            "depth_um": face_depth(mesh, deformed)[worn] * MICROMETRES,
            "worn_volume_mm3": mesh.cell_data[WORN_VOLUME][worn] * CUBIC_MILLIMETRES,
        }
    )


def area_share_above(depth: np.ndarray, area: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """Return the share (k,) of an area that is worn deeper than each of the levels (k,); depth and area (m,)."""
    order = np.argsort(depth)
    within = np.concatenate([[0.0], np.cumsum(area[order])])
    return 1.0 - within[np.searchsorted(depth[order], levels, side="right")] / within[-1]


def depth_distribution(depths: pd.DataFrame) -> pd.DataFrame:
    """Return run, depth_um, area_share_percent: the share of each sample's area that is worn deeper than a
    depth.

    depths: run, depth_um and area_mm2 as from `depth_table`. The runs share one set of depths, which ends
    where `DISTRIBUTION_SHARE` of the area of every run is worn less deep: single triangles can be far deeper.
    """
    tops = [
        area_quantile(faces["depth_um"].to_numpy(), faces["area_mm2"].to_numpy(), DISTRIBUTION_SHARE)
        for _, faces in depths.groupby("run", sort=False)
    ]
    top = max(*tops, np.finfo(float).tiny * 10.0**DISTRIBUTION_DECADES)
    levels = top * np.logspace(-DISTRIBUTION_DECADES, 0.0, DISTRIBUTION_LEVELS)
    curves = [
        pd.DataFrame(
            {
                "run": run,
                "depth_um": levels,
                "area_share_percent": 100.0
                * area_share_above(faces["depth_um"].to_numpy(), faces["area_mm2"].to_numpy(), levels),
            }
        )
        for run, faces in depths.groupby("run", sort=False)
    ]
    return pd.concat(curves, ignore_index=True)


def depth_summary(depths: pd.DataFrame) -> pd.DataFrame:
    """Return per run: area_mm2, mean, 95th and 99th percentile of area and largest depth (um), touched share
    (%).
    """

    def row(faces: pd.DataFrame) -> dict[str, float]:
        depth, area = faces["depth_um"].to_numpy(), faces["area_mm2"].to_numpy()
        return {
            "area_mm2": area.sum(),
            "mean_depth_um": depth @ area / area.sum(),
            "depth_of_95_percent_um": area_quantile(depth, area, 0.95),
            "depth_of_99_percent_um": area_quantile(depth, area, 0.99),
            "largest_depth_um": depth.max(),
            "touched_area_percent": 100.0 * area[depth > 0.0].sum() / area.sum(),
        }

    return pd.DataFrame([{"run": run, **row(faces)} for run, faces in depths.groupby("run", sort=False)])


def area_quantile(depth: np.ndarray, area: np.ndarray, share: float) -> float:
    """Return the smallest depth that at least this share of the area does not exceed; depth and area (m,)."""
    order = np.argsort(depth)
    reached = np.cumsum(area[order]) / area.sum()
    return float(depth[order][min(np.searchsorted(reached, share - 1e-12), len(depth) - 1)])
