"""Where a sample in the circular wear tester wears: by columns along the travel, shapes of a pattern and mesh.

A column is what Yan 2022 (Fig 6.1) calls one: a strip across the travel, column 1 where the bed arrives. The bumps of a
column are those of one `row` of labels; columns meet midway between rows. Plain samples have the strips of the
patterned one beside them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN, SurfaceMesh, centroids, read_surface, worn_faces
from bulkwear.postproc.readers.cycle_folders import cycle_folders
from bulkwear.postproc.statistics.intervals import Estimate, estimate
from bulkwear.postproc.tables.depths import WORN_VOLUME
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES, MICROMETRES, MILLIMETRES
from bulkwear.workflows.cases.circular_tester.packings import PACKING, over_packings
from bulkwear.workflows.cases.circular_tester.runs import MESH, SIZE, SURFACE, VOLUME, TesterRun
from bulkwear.workflows.cases.circular_tester.volume import PATTERNED, chosen, of_surface

NOTHING = np.empty((0, 3))  # no scan
SHOWN_BUMPS = ["C11", "C13", "C15"]  # of Fig 6.5 and 6.16
MESH_BUMP = "C15"  # of Fig 6.9
LEDGER = "ledger.parquet"
PLACE = ["surface", "column"]
CHOSEN_SURFACES = 4  # revolutions of which contours are drawn, evenly spaced up to the last one


def top_of(mesh: SurfaceMesh) -> SurfaceMesh:
    """The faces of a sample that wear, with all its nodes; the holder's bottom would be in the way of sections."""
    kept = worn_faces(mesh)
    return SurfaceMesh(
        mesh.points, mesh.triangles[kept], {name: data[kept] for name, data in mesh.cell_data.items()}, mesh.point_data
    )


def column_borders(pristine: SurfaceMesh) -> np.ndarray:
    """Places (columns - 1,) m along the travel where the columns of a patterned sample meet."""
    along, row = pristine.points[pristine.triangles, 1], pristine.cell_data["row"]
    ends = pd.DataFrame({"low": along.min(axis=1), "high": along.max(axis=1)})[row > 0].groupby(row[row > 0])
    middle = 0.5 * (ends["low"].min() + ends["high"].max()).to_numpy()
    return 0.5 * (middle[1:] + middle[:-1])


def borders_of(patterned: TesterRun) -> np.ndarray:
    """`column_borders` of a run with a pattern."""
    return column_borders(read_surface(patterned.folder / SURFACE))


def column_numbers(mesh: SurfaceMesh, borders: np.ndarray) -> np.ndarray:
    """Column (m,) of each triangle: that of its bump, else of the strip its centroid lies in; 0 on the holder.

    borders: as from `column_borders`
    """
    strip = np.searchsorted(borders, centroids(mesh.points, mesh.triangles)[:, 1], side="right")
    row = mesh.cell_data["row"]
    return np.where(worn_faces(mesh), np.where(row > 0, row, strip + 1), 0)


def _by_column(mesh: SurfaceMesh, quantity: np.ndarray, borders: np.ndarray) -> pd.DataFrame:
    """Sums of a quantity (m,) per column: column, base, bumps."""
    number, columns = column_numbers(mesh, borders), len(borders) + 1
    bump = mesh.cell_data["part"] > 0
    sums = [np.bincount(number[where], quantity[where], columns + 1)[1:] for where in (~bump, bump)]
    return pd.DataFrame({"column": np.arange(1, columns + 1), "base": sums[0], "bumps": sums[1]})


def wear_by_column(meshes: Mapping[str, SurfaceMesh], borders: np.ndarray) -> pd.DataFrame:
    """Worn volume (mm3) of base and bumps per column of every run (Fig 6.13): run, column, base_mm3, bumps_mm3.

    meshes: worn surfaces by run, with `worn_volume_m3`; borders: as from `column_borders`
    """
    parts = [
        _by_column(mesh, CUBIC_MILLIMETRES * mesh.cell_data[WORN_VOLUME], borders).assign(run=run)
        for run, mesh in meshes.items()
    ]
    table = pd.concat(parts, ignore_index=True)
    return table.rename(columns={"base": "base_mm3", "bumps": "bumps_mm3"})[["run", "column", "base_mm3", "bumps_mm3"]]


def of_runs(table: pd.DataFrame, runs: Sequence[TesterRun]) -> pd.DataFrame:
    """A table with a column run, with the surface and the packing of each run."""
    names = {run.name: run for run in runs}
    columns = {name: [getattr(names[run], name) for run in table["run"]] for name in ("surface", PACKING)}
    return table.assign(**columns)


def columns_over_packings(by_column: pd.DataFrame, unit: str) -> pd.DataFrame:
    """Means over packings by column of the sample: surface, column, base_<unit>, bumps_<unit>, total_<unit>, and those
    of `over_packings` of the total.

    by_column: as from `wear_by_column` or `mean_force_by_column`, with surface and packing
    """
    parts, total = [f"base_{unit}", f"bumps_{unit}"], f"total_{unit}"
    means = by_column.groupby(PLACE, sort=False)[parts].mean().reset_index()
    return means.merge(over_packings(by_column.assign(**{total: by_column[parts].sum(axis=1)}), PLACE, total))


def share_of_bumps(by_column: pd.DataFrame) -> Estimate:
    """Share (-) of the wear of patterned samples that their bumps bear, over packings."""
    sums = of_surface(by_column, PATTERNED).groupby(PACKING)[["base_mm3", "bumps_mm3"]].sum()
    return estimate(sums["bumps_mm3"] / sums.sum(axis=1))


def wear_by_bump(meshes: Mapping[int, SurfaceMesh]) -> pd.DataFrame:
    """Worn volume of every bump in every packing (Fig 6.14): bump (C11, C12, ...), part, row (the column of Fig 6.1),
    volume_mm3, packing.

    meshes: worn surfaces by packing, with `worn_volume_m3`.
    """
    from bulkwear.postproc.scans.comparison import bump_names  # slow to import

    parts = []
    for packing, mesh in meshes.items():
        volume = np.bincount(np.maximum(mesh.cell_data["part"], 0), CUBIC_MILLIMETRES * mesh.cell_data[WORN_VOLUME])
        names = bump_names(mesh)[["bump", "part", "row"]]
        lost = volume[names["part"].to_numpy(dtype=np.int64)]
        parts.append(names.assign(volume_mm3=lost, **{PACKING: packing}))
    return pd.concat(parts, ignore_index=True)


def force_by_column(mesh: SurfaceMesh, impulse: np.ndarray, duration: float, borders: np.ndarray) -> pd.DataFrame:
    """Mean normal force (N) on base and bumps per column (Fig 6.22): column, base_N, bumps_N.

    impulse: (m,) N s of each triangle within `duration` (s), from a load ledger; borders: as from `column_borders`
    """
    table = _by_column(mesh, np.asarray(impulse) / duration, borders)
    return table.rename(columns={"base": "base_N", "bumps": "bumps_N"})


def volumes_of_meshes(lost: pd.DataFrame) -> pd.DataFrame | None:
    """Volumes after equal revolutions of runs of one packing that differ in their elements, finest first; None without
    any.
    """
    of_meshes = chosen(lost, MESH)
    if of_meshes.empty:
        return None
    same = of_meshes.groupby("run")["revolution"].max().min()
    at = chosen(lost, MESH, VOLUME, SIZE)
    for name in ("shape", "particle_scale", PACKING):
        at = at[at[name].isin(of_meshes[name])]
    return at[np.isclose(at["revolution"], same)].sort_values("element_size_mm")


def mesh_size_effect(volumes: pd.DataFrame) -> pd.DataFrame:
    """Volume against mesh size, over that of the plain sample on the finest mesh in the same packing (Fig 6.8).

    volumes: as from `volumes_of_meshes`. Columns: surface, element_size_mm, relative_percent, and those of
    `over_packings`. Raises ValueError without a plain sample.
    """
    plain = volumes[volumes["surface"] == PLAIN].sort_values("element_size_mm")
    if plain.empty:
        raise ValueError("the effect of mesh size needs a plain sample, found none")
    finest = volumes[PACKING].map(plain.groupby(PACKING)["volume_m3"].first())
    table = volumes.assign(relative_percent=100.0 * volumes["volume_m3"] / finest)
    return over_packings(table, ["surface", "element_size_mm"], "relative_percent")


def on_finest_mesh(volumes: pd.DataFrame) -> pd.DataFrame:
    """Volume over that on the finest mesh of the same surface and packing: surface, packing, element_size_mm, ratio.

    volumes: as from `volumes_of_meshes`; the finest meshes themselves are left out.
    """
    ordered = volumes.sort_values("element_size_mm")
    finest = ordered.groupby(["surface", PACKING])[["volume_m3", "element_size_mm"]].transform("first")
    table = ordered[["surface", PACKING, "element_size_mm"]].assign(ratio=ordered["volume_m3"] / finest["volume_m3"])
    return table[ordered["element_size_mm"] > finest["element_size_mm"]]


def worn_contours(pristine: SurfaceMesh, worn: Mapping[str, SurfaceMesh], bumps: list[str]) -> pd.DataFrame:
    """Sections of bumps of several worn surfaces, such as several revolutions (Fig 6.16) or meshes (Fig 6.9).

    Columns: bump, view (side, front), along_mm, name (of the surface; "pristine" first), height_mm.
    """
    from bulkwear.postproc.scans.comparison import bump_sections  # slow to import

    sections = bump_sections(NOTHING, pristine, worn, 0.0)
    sections = sections[sections["bump"].isin(bumps)]
    names = {f"{name}_height_mm": name for name in ("pristine", *worn)}
    kept = sections[["bump", "view", "along_mm", *names]].rename(columns=names)
    return kept.melt(["bump", "view", "along_mm"], list(names.values()), "name", "height_mm")


def contours_by_mesh(runs: Sequence[TesterRun], revolution: float) -> pd.DataFrame:
    """Sections of MESH_BUMP (of the first bump where a sample is too small to have it) after a revolution on the meshes
    of runs with a pattern, finest first, as from `worn_contours`.
    """
    from bulkwear.postproc.scans.comparison import bump_names  # slow to import

    runs = sorted((run for run in runs if run.surface != PLAIN), key=lambda run: run.element_size_mm)
    worn = {f"{run.element_size_mm:g} mm": next(iter(cycle_surfaces(run, [revolution]).values())) for run in runs}
    pristine = top_of(read_surface(runs[0].folder / SURFACE))
    there = bump_names(pristine)["bump"].tolist()
    return worn_contours(pristine, worn, [MESH_BUMP if MESH_BUMP in there else there[0]])


def contour_losses(pristine: SurfaceMesh, worn: SurfaceMesh, bumps: list[str]) -> pd.Series:
    """Largest vertical loss (mm) in the sections of bumps, by bump; flanks too steep for it do not count (Fig 6.5)."""
    from bulkwear.postproc.scans.comparison import bump_sections, largest_losses  # slow to import

    losses = largest_losses(bump_sections(NOTHING, pristine, {"worn": worn}, 0.0, bumps)).set_index("bump")["worn_um"]
    return losses[[bump for bump in bumps if bump in losses.index]] * (MILLIMETRES / MICROMETRES)


def losses_at_volume(run: TesterRun, lost: float, bumps: list[str]) -> pd.Series:
    """Largest vertical loss (mm) of bumps, by bump, when a sample has lost a volume (mm3): between the wear cycles
    around it, in proportion to the volume. Empty where the run ends before.
    """
    wear = pd.read_csv(run.folder / "wear.csv", usecols=["cycle", "total_applied_volume_m3"])
    volume = CUBIC_MILLIMETRES * np.r_[0.0, wear["total_applied_volume_m3"]]
    after = int(np.searchsorted(volume, lost))
    if lost <= 0.0 or after == len(volume):
        return pd.Series(dtype=float)
    pristine = top_of(read_surface(run.folder / SURFACE))
    folders = [run.folder / f"cycle_{cycle:03d}" for cycle in wear["cycle"]]
    around = [
        pristine if number == 0 else top_of(read_surface(folders[number - 1] / SURFACE))
        for number in (after - 1, after)
    ]
    before, beyond = (contour_losses(pristine, worn, bumps) for worn in around)
    share = (lost - volume[after - 1]) / (volume[after] - volume[after - 1])
    return before + share * (beyond - before)


def cycle_surfaces(run: TesterRun, revolutions: Sequence[float] | None = None) -> dict[str, SurfaceMesh]:
    """Worn tops after about these revolutions of wear, by their number; evenly spaced ones without."""
    wear = pd.read_csv(run.folder / "wear.csv", usecols=["cycle", "revolution"])
    last = wear["revolution"].iloc[-1]
    wanted = revolutions if revolutions is not None else np.linspace(0.0, last, CHOSEN_SURFACES + 1)[1:]
    rows = [wear.loc[(wear["revolution"] - each).abs().idxmin()] for each in wanted]
    return {
        f"{row['revolution']:.3g}": top_of(read_surface(run.folder / f"cycle_{int(row['cycle']):03d}" / SURFACE))
        for row in rows
    }


def surfaces_alike(runs: Sequence[TesterRun]) -> tuple[float, dict[str, SurfaceMesh]]:
    """The revolution of wear that all runs have reached, and their worn tops after it, by run."""
    last = min(float(pd.read_csv(run.folder / "wear.csv", usecols=["revolution"]).iloc[-1, 0]) for run in runs)
    return last, {run.name: next(iter(cycle_surfaces(run, [last]).values())) for run in runs}


def mean_force_by_column(run: TesterRun, borders: np.ndarray) -> pd.DataFrame:
    """Normal force by column, mean over the wear cycles: run, column, base_N, bumps_N."""
    before, parts = run.folder / SURFACE, []
    durations = np.diff(pd.read_csv(run.folder / "wear.csv")["time_s"], prepend=0.0)
    for folder, duration in zip(cycle_folders(run.folder)[1:], durations, strict=True):
        impulse = pd.read_parquet(folder / LEDGER, columns=["normal_impulse_N_s"])["normal_impulse_N_s"]
        parts.append(force_by_column(read_surface(before), impulse, duration, borders))
        before = folder / SURFACE
    return pd.concat(parts).groupby("column")[["base_N", "bumps_N"]].mean().reset_index().assign(run=run.name)
