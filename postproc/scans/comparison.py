"""A scan that lies on its sample, against the pristine and the worn surfaces: depth, sections, volume.

The scan is thinned on a grid while it is read, so that one of any size takes the same memory. Depth is the distance
from the pristine surface, positive where material is gone; deviation is that from a worn surface, positive where the
scan stands out of it, that is where the simulation wore more. Heights are along z of the surface's own axes.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.spatial import cKDTree

from bulkwear.postproc.mesh import SurfaceMesh, area_vectors, centroids, unit_normals, volume_above_plane
from bulkwear.postproc.scans.start import RigidMotion
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES, MICROMETRES, MILLIMETRES
from bulkwear.postproc.wear.depth import height_loss
from bulkwear.postproc.wear.old_surface import ON_EDGE, OldSurface
from bulkwear.postproc.wear.remesh_patch import barycentric, neighbours

CELL = 0.5e-3  # m, side of the cells of the map
STEP = 0.25e-3  # m, along a section
POINTS_PER_CELL = 16  # that are kept: bounds the memory, and a median of 16 is known to 0.3 of their spread
HALF_SLAB = 0.25e-3  # m, to each side of a section, within which points count
FEWEST_IN_STEP = 3  # points in a step of a section: fewer are drawn as a gap
MARGIN = 2e-3  # m, of a section beyond the foot of its bump
STEEPEST = np.tan(np.radians(60.0))  # of the pristine section: steeper, a height loss only shows where it lies sideways
MEDIAN_TO_SPREAD = 1.4826  # -, of the median distance, for normal noise
OUTLYING = 4.0  # -, spreads of its cell from which on a point has no part in a volume
NEAR = 1e-3  # m, up to which a cell tells the depth of a triangle
BELOW = 1e-3  # m, under the lowest point: where vertical rays begin
LONG_NUMBER = 10  # of a row or a bump: two digits need a hyphen before or after them
VIEWS = {"side": 1, "front": 0}  # view of a bump -> axis along the section: side along the travel, front across


@dataclass(frozen=True)
class ThinnedScan:
    """What is kept of a scan: points (k, 3) m on the sample, in the surface's axes, and how many there were.

    total: in the scan; on_sample: within the crop distance of the pristine surface, not beyond its border
    """

    points: np.ndarray
    total: int
    on_sample: int


def thinned_scan(
    blocks: Iterable[np.ndarray],
    motion: RigidMotion,
    pristine: SurfaceMesh,
    crop: float,
    tell: Callable[[int], None] = lambda points: None,
) -> ThinnedScan:
    """Lay the blocks (k, 3) m of a scan on the surface, drop what is not the sample, and keep some points per cell.

    crop: m, distance from the pristine surface beyond which a point is none of the sample's; must exceed the deepest
    wear. tell: is told the points read so far. Raises ValueError when nothing is left.
    """
    surface, border = OldSurface(pristine.points, pristine.triangles), _border_sides(pristine.triangles)
    low, high = pristine.points.min(axis=0), pristine.points.max(axis=0)
    columns, rows = (int(np.ceil(side / CELL)) + 1 for side in (high - low)[:2])
    kept = np.full((columns * rows, POINTS_PER_CELL, 3), np.nan)
    filled = np.zeros(columns * rows, dtype=np.int64)
    total = 0
    for block in blocks:
        total += len(block)
        placed = motion(block)
        placed = placed[((placed >= low - crop) & (placed <= high + crop)).all(axis=1)]
        distance, face, nearest = surface.closest(placed)
        beyond = (border[face] & (barycentric(nearest, pristine.points[pristine.triangles[face]]) < ON_EDGE)).any(
            axis=1
        )
        good = (np.abs(distance) <= crop) & ~beyond
        placed, place = placed[good], np.floor((nearest[good, :2] - low[:2]) / CELL).astype(np.int64)
        _fill(kept, filled, placed, place[:, 0] * rows + place[:, 1])
        tell(total)
    if not filled.any():
        raise ValueError("no scanned point lies on the sample, allowed is one or more")
    return ThinnedScan(kept[np.isfinite(kept[:, :, 0])], total, int(filled.sum()))


def _border_sides(triangles: np.ndarray) -> np.ndarray:
    """Mask (m, 3): no other face lies across the edge opposite to that corner."""
    border = np.ones((len(triangles), 3), dtype=bool)
    pairs, sides = neighbours(triangles)
    border[pairs, sides] = False
    return border


def _fill(kept: np.ndarray, filled: np.ndarray, placed: np.ndarray, cell: np.ndarray) -> None:
    """Put points (k, 3) into the free places of their cells; `filled` counts all that came."""
    order = np.argsort(cell, kind="stable")
    cell, placed = cell[order], placed[order]
    first = np.flatnonzero(np.diff(cell, prepend=-1))
    rank = np.arange(len(cell)) - np.repeat(first, np.diff([*first, len(cell)]))
    place = filled[cell] + rank
    free = place < kept.shape[1]
    kept[cell[free], place[free]] = placed[free]
    np.add.at(filled, cell, 1)


def surface_heights(mesh: SurfaceMesh, places: np.ndarray) -> np.ndarray:
    """Height z (k,) m of a surface at places (k, 2) m, exact on its triangles; NaN beside it. No overhangs."""
    bottom = float(mesh.points[:, 2].min()) - BELOW
    start = np.column_stack([places, np.full(len(places), bottom)])
    return bottom + height_loss(start, mesh.points, mesh.triangles)


def depth_cells(scan: np.ndarray, pristine: SurfaceMesh, worn: Mapping[str, SurfaceMesh]) -> pd.DataFrame:
    """Return a row per cell and label of the pristine surface.

    scan: (k, 3) m in the surface's axes. Columns: x_mm, y_mm (middle of the cell), part, points; medians over its
    points z_mm, measured_depth_um and, per worn surface, <name>_deviation_um and <name>_depth_um (its depth at the same
    points); spread_um (robust, of the points); height_loss_um, the mean in plan without outliers, and plan_mm2, the
    row's share of the cell.
    """
    distance, face, _ = OldSurface(pristine.points, pristine.triangles).closest(scan)
    low = pristine.points.min(axis=0)[:2]
    place = np.floor((scan[:, :2] - low) / CELL).astype(np.int64)
    table = pd.DataFrame({"i": place[:, 0], "j": place[:, 1], "part": pristine.cell_data["part"][face]})
    table["z_mm"] = MILLIMETRES * scan[:, 2]
    table["measured_depth_um"] = -MICROMETRES * distance
    for name, mesh in worn.items():
        deviation = OldSurface(mesh.points, mesh.triangles).closest(scan)[0]
        table[f"{name}_deviation_um"] = MICROMETRES * deviation
        table[f"{name}_depth_um"] = MICROMETRES * (deviation - distance)
    grouped = table.groupby(["i", "j", "part"], sort=True)
    medians, row = grouped.median(), grouped.ngroup().to_numpy()
    away = np.abs(table["measured_depth_um"].to_numpy() - medians["measured_depth_um"].to_numpy()[row])
    spread = MEDIAN_TO_SPREAD * pd.Series(away).groupby(row).median().to_numpy()
    flatness = np.maximum(unit_normals(pristine.points, pristine.triangles)[face, 2], 0.0)
    loss = MICROMETRES * (surface_heights(pristine, scan[:, :2]) - scan[:, 2])
    weight = np.where((away <= OUTLYING * spread[row]) & np.isfinite(loss), flatness, 0.0)
    plan = np.bincount(row, weight, len(medians))
    total = np.bincount(row, weight * np.nan_to_num(loss), len(medians))
    cells = medians.reset_index().assign(points=grouped.size().to_numpy(), spread_um=spread)
    cells["height_loss_um"] = np.divide(total, plan, out=np.full_like(total, np.nan), where=plan > 0.0)
    share = pd.Series(plan) / pd.Series(plan).groupby([cells["i"], cells["j"]]).transform("sum")
    cells["plan_mm2"] = (MILLIMETRES * CELL) ** 2 * share.fillna(0.0)
    for axis, key, start in zip("xy", "ij", low, strict=True):
        cells[f"{axis}_mm"] = MILLIMETRES * (start + CELL * (cells[key] + 0.5))
    first = ["x_mm", "y_mm", "part", "points"]
    return cells[[*first, *cells.columns.drop([*first, "i", "j"])]]


def depth_of_faces(cells: pd.DataFrame, pristine: SurfaceMesh) -> np.ndarray:
    """Return the measured depth (m,) m at each triangle: that of the nearest cell, NaN where none is near."""
    tree = cKDTree(cells[["x_mm", "y_mm", "z_mm"]] / MILLIMETRES)
    away, nearest = tree.query(centroids(pristine.points, pristine.triangles), distance_upper_bound=NEAR)
    depth = cells["measured_depth_um"].to_numpy()[np.where(np.isfinite(away), nearest, 0)] / MICROMETRES
    return np.where(np.isfinite(away), depth, np.nan)


def bump_names(mesh: SurfaceMesh) -> pd.DataFrame:
    """Return the bumps of a sample as Figure 6.1 of Yan 2022 calls them: name, part, x_mm, y_mm (of their middle).

    C15 is the fifth bump, counted from least x, of the row (his column) that meets the bed first; from ten on a hyphen
    stands between both numbers, as in C1-11. Least x is the inner side of a tester whose bed turns anticlockwise, seen
    from above, and goes to +y over the sample.
    """
    part, row = mesh.cell_data["part"], mesh.cell_data["row"]
    rows = []
    for label in np.unique(part[part > 0]):
        corners = mesh.points[mesh.triangles[part == label]].reshape(-1, 3)
        middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0)) * MILLIMETRES
        rows.append({"part": label, "row": row[part == label][0], "x_mm": middle[0], "y_mm": middle[1]})
    table = pd.DataFrame(rows, columns=["part", "row", "x_mm", "y_mm"])
    number = table.groupby("row")["x_mm"].rank().astype(int)
    between = np.where((table["row"] < LONG_NUMBER) & (number < LONG_NUMBER), "", "-")
    table.insert(0, "bump", "C" + table["row"].astype(str) + between + number.astype(str))
    return table


def bump_sections(
    scan: np.ndarray,
    pristine: SurfaceMesh,
    worn: Mapping[str, SurfaceMesh],
    accuracy: float,
    bumps: Collection[str] | None = None,
) -> pd.DataFrame:
    """Return sections through the middle of bumps: along the travel ("side") and across ("front").

    scan: (k, 3) m in the surface's axes; accuracy: m, of the scanner; bumps: those that are wanted by name, by default
    all. Columns: bump, view, along_mm (from the middle), pristine_height_mm, measured_height_mm (NaN where too few
    points lie), points, band_mm (accuracy, as far as it reaches vertically), and per worn surface <name>_height_mm.
    """
    parts = []
    named = bump_names(pristine)
    for bump in (named if bumps is None else named[named["bump"].isin(list(bumps))]).itertuples():
        middle = np.array([bump.x_mm, bump.y_mm]) / MILLIMETRES
        corners = pristine.points[pristine.triangles[pristine.cell_data["part"] == bump.part]].reshape(-1, 3)
        for view, axis in VIEWS.items():
            half = 0.5 * np.ptp(corners[:, axis]) + MARGIN
            section = _section(scan, middle, axis, half, pristine, worn, accuracy)
            parts.append(section.assign(bump=bump.bump, view=view)[["bump", "view", *section.columns]])
    columns = ["bump", "view", "along_mm", "pristine_height_mm", "measured_height_mm", "points", "band_mm"]
    columns += [f"{name}_height_mm" for name in worn]
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=columns)


def _section(
    scan: np.ndarray,
    middle: np.ndarray,
    axis: int,
    half: float,
    pristine: SurfaceMesh,
    worn: Mapping[str, SurfaceMesh],
    accuracy: float,
) -> pd.DataFrame:
    steps = 2 * int(np.ceil(half / STEP)) + 1  # odd: one lies in the middle
    along = STEP * (np.arange(steps) - 0.5 * (steps - 1))
    places = np.tile(middle, (steps, 1))
    places[:, axis] += along
    near = scan[np.abs(scan[:, 1 - axis] - middle[1 - axis]) <= HALF_SLAB]
    step = np.floor((near[:, axis] - middle[axis]) / STEP + 0.5 * steps).astype(np.int64)
    near, step = near[(step >= 0) & (step < steps)], step[(step >= 0) & (step < steps)]
    loss = pd.Series(surface_heights(pristine, near[:, :2]) - near[:, 2]).groupby(step).agg(["median", "size"])
    loss = loss[loss["size"] >= FEWEST_IN_STEP].reindex(np.arange(steps))
    height = surface_heights(pristine, places)
    slope = np.gradient(height, STEP)
    table = {
        "along_mm": MILLIMETRES * along,
        "pristine_height_mm": MILLIMETRES * height,
        "measured_height_mm": MILLIMETRES * (height - loss["median"].to_numpy()),
        "points": loss["size"].fillna(0).astype(int).to_numpy(),
        "band_mm": MILLIMETRES * accuracy * np.sqrt(1.0 + slope**2),
    }
    heights = {f"{name}_height_mm": MILLIMETRES * surface_heights(mesh, places) for name, mesh in worn.items()}
    return pd.DataFrame(table | heights)


def largest_losses(sections: pd.DataFrame) -> pd.DataFrame:
    """Return the largest vertical loss of every bump over both sections, measured and of every worn surface, um.

    Only where the pristine section is no steeper than `STEEPEST`. Columns: bump, measured_um, <name>_um.
    """
    slope = sections.groupby(["bump", "view"])["pristine_height_mm"].transform(
        lambda height: np.abs(np.gradient(height, MILLIMETRES * STEP))
    )
    fair = sections[slope <= STEEPEST]
    names = [name for name in sections if name.endswith("_height_mm") and name != "pristine_height_mm"]
    losses = {
        name.replace("_height_mm", "_um"): MICROMETRES / MILLIMETRES * (fair["pristine_height_mm"] - fair[name])
        for name in names
    }
    return pd.DataFrame({"bump": fair["bump"], **losses}).groupby("bump", sort=False).max().reset_index()


def volume_table(
    cells: pd.DataFrame, pristine: SurfaceMesh, worn: Mapping[str, SurfaceMesh], accuracy: float
) -> pd.DataFrame:
    """Return the volume that base, bumps and sample have lost, by the scan and by the worn surfaces.

    cells: as from `depth_cells`; accuracy: m. Columns: of, part (-2 for the sample), area_mm2 (in plan),
    covered_percent, measured_volume_mm3 (cells without points count as the mean of the others), band_mm3 (if all of
    the accuracy were one shift of the whole part), and per worn surface <name>_volume_mm3.
    """
    names = {0: "base"} | dict(bump_names(pristine)[["part", "bump"]].itertuples(index=False))
    loss = cells["plan_mm2"] * cells["height_loss_um"] * MILLIMETRES / MICROMETRES
    of_part = pd.DataFrame({"area": cells["plan_mm2"], "loss": loss.fillna(0.0)}).groupby(cells["part"]).sum()
    rows = []
    for part, name in names.items():
        faces = pristine.triangles[pristine.cell_data["part"] == part]
        plan = float(area_vectors(pristine.points, faces)[:, 2].sum()) * MILLIMETRES**2
        covered, lost = of_part.loc[part] if part in of_part.index else (0.0, 0.0)
        row = {"of": name, "part": part, "area_mm2": plan, "covered_percent": min(100.0 * covered / plan, 100.0)}
        row |= {"measured_volume_mm3": lost * plan / covered if covered else np.nan}
        row |= {"band_mm3": plan * MILLIMETRES * accuracy}
        rows.append(row | {f"{other}_volume_mm3": _lost(pristine, mesh, part) for other, mesh in worn.items()})
    table = pd.DataFrame(rows)
    whole = table.drop(columns="of").sum(skipna=False)
    whole["part"] = -2
    whole["covered_percent"] = (table["covered_percent"] * table["area_mm2"]).sum() / table["area_mm2"].sum()
    whole = pd.DataFrame([whole]).astype(table.dtypes.drop("of")).assign(of="sample")
    return pd.concat([table, whole], ignore_index=True)


def _lost(pristine: SurfaceMesh, worn: SurfaceMesh, part: int) -> float:
    """Volume (mm3) that the faces of a label have lost."""
    volumes = [
        volume_above_plane(mesh.points, mesh.triangles[mesh.cell_data["part"] == part]) for mesh in (pristine, worn)
    ]
    return CUBIC_MILLIMETRES * (volumes[0] - volumes[1])
