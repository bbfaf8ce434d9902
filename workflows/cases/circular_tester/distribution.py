"""Where a sample in the circular wear tester wears: by columns along the travel, by bumps, and by mesh.

A column is what Yan 2022 (Fig 6.1) calls one: a strip across the travel, column 1 where the bed arrives. The bumps of a
column are those of one `row` of labels; plain samples have the strips alone.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from postproc.mesh import SurfaceMesh, centroids
from postproc.scans.comparison import bump_names, bump_sections, largest_losses
from postproc.tables.depths import WORN_VOLUME
from postproc.tables.display import CUBIC_MILLIMETRES, MICROMETRES, MILLIMETRES
from postproc.wear.update import worn_faces

COLUMNS = 5  # of the sample of 100 x 100 mm (Fig 6.1)
NOTHING = np.empty((0, 3))  # no scan


def column_numbers(mesh: SurfaceMesh, columns: int = COLUMNS) -> np.ndarray:
    """Column (m,) of each triangle: that of its bump, else of the strip its centroid lies in; 0 on the holder."""
    worn = worn_faces(mesh)
    along = centroids(mesh.points, mesh.triangles)[:, 1]
    edge = mesh.points[np.unique(mesh.triangles[worn]), 1]
    strip = np.floor(columns * (along - edge.min()) / np.ptp(edge)).astype(np.int64)
    row = mesh.cell_data["row"]
    return np.where(worn, np.where(row > 0, row, np.clip(strip, 0, columns - 1) + 1), 0)


def _by_column(mesh: SurfaceMesh, quantity: np.ndarray, columns: int) -> pd.DataFrame:
    """Sums of a quantity (m,) per column: column, base, bumps."""
    number = column_numbers(mesh, columns)
    bump = mesh.cell_data["part"] > 0
    sums = [np.bincount(number[where], quantity[where], columns + 1)[1:] for where in (~bump, bump)]
    return pd.DataFrame({"column": np.arange(1, columns + 1), "base": sums[0], "bumps": sums[1]})


def wear_by_column(meshes: Mapping[str, SurfaceMesh], columns: int = COLUMNS) -> pd.DataFrame:
    """Worn volume (mm3) of base and bumps per column of every run (Fig 6.13): run, column, base_mm3, bumps_mm3.

    meshes: worn surfaces by run, with `worn_volume_m3`.
    """
    parts = [
        _by_column(mesh, CUBIC_MILLIMETRES * mesh.cell_data[WORN_VOLUME], columns).assign(run=run)
        for run, mesh in meshes.items()
    ]
    table = pd.concat(parts, ignore_index=True)
    return table.rename(columns={"base": "base_mm3", "bumps": "bumps_mm3"})[["run", "column", "base_mm3", "bumps_mm3"]]


def share_of_bumps(by_column: pd.DataFrame) -> pd.Series:
    """Share (-) of the wear of each run that its bumps bear."""
    sums = by_column.groupby("run", sort=False)[["base_mm3", "bumps_mm3"]].sum()
    return sums["bumps_mm3"] / sums.sum(axis=1)


def wear_by_bump(mesh: SurfaceMesh) -> pd.DataFrame:
    """Worn volume of every bump (Fig 6.14): bump (C11, C12, ...), part, row (the column of Fig 6.1), volume_mm3."""
    volume = np.bincount(np.maximum(mesh.cell_data["part"], 0), CUBIC_MILLIMETRES * mesh.cell_data[WORN_VOLUME])
    names = bump_names(mesh)[["bump", "part", "row"]]
    return names.assign(volume_mm3=volume[names["part"].to_numpy(dtype=np.int64)])


def force_by_column(mesh: SurfaceMesh, impulse: np.ndarray, duration: float, columns: int = COLUMNS) -> pd.DataFrame:
    """Mean normal force (N) on base and bumps per column (Fig 6.22): column, base_N, bumps_N.

    impulse: (m,) N s of each triangle within `duration` (s), from a load ledger.
    """
    table = _by_column(mesh, np.asarray(impulse) / duration, columns)
    return table.rename(columns={"base": "base_N", "bumps": "bumps_N"})


def mesh_size_effect(volumes: pd.DataFrame) -> pd.DataFrame:
    """Volume against mesh size, over that of the plain sample on the finest mesh (Fig 6.8).

    volumes: surface, element_size_mm, volume_m3 after the same revolutions. Columns: surface, element_size_mm,
    relative_percent; per surface also mean_percent and deviation_percent over the meshes. Raises ValueError without a
    plain sample.
    """
    plain = volumes[volumes["surface"] == "plain"]
    if plain.empty:
        raise ValueError("the effect of mesh size needs a plain sample, found none")
    finest = plain.loc[plain["element_size_mm"].idxmin(), "volume_m3"]
    table = volumes[["surface", "element_size_mm"]].assign(relative_percent=100.0 * volumes["volume_m3"] / finest)
    grouped = table.groupby("surface", sort=False)["relative_percent"]
    return table.assign(mean_percent=grouped.transform("mean"), deviation_percent=grouped.transform("std"))


def worn_contours(pristine: SurfaceMesh, worn: Mapping[str, SurfaceMesh], bumps: list[str]) -> pd.DataFrame:
    """Sections of bumps of several worn surfaces, such as several revolutions (Fig 6.16) or meshes (Fig 6.9).

    Columns: bump, view (side, front), along_mm, name (of the surface; "pristine" first), height_mm.
    """
    sections = bump_sections(NOTHING, pristine, worn, 0.0)
    sections = sections[sections["bump"].isin(bumps)]
    names = {f"{name}_height_mm": name for name in ("pristine", *worn)}
    kept = sections[["bump", "view", "along_mm", *names]].rename(columns=names)
    return kept.melt(["bump", "view", "along_mm"], list(names.values()), "name", "height_mm")


def contour_losses(pristine: SurfaceMesh, worn: SurfaceMesh, bumps: list[str]) -> pd.Series:
    """Largest vertical loss (mm) in the sections of bumps, by bump; flanks too steep for it do not count (Fig 6.5)."""
    losses = largest_losses(bump_sections(NOTHING, pristine, {"worn": worn}, 0.0)).set_index("bump")["worn_um"]
    return losses[[bump for bump in bumps if bump in losses.index]] * (MILLIMETRES / MICROMETRES)
