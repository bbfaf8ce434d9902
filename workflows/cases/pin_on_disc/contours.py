"""Radial contours of a worn disc: how deep and how wide the track is at every degree, and sections of it.

The disc's pristine surface is the plane z = 0 about the z axis; a contour is its section with the half-plane at an
angle, anticlockwise from +x. Depth is the largest vertical displacement in a contour, width is taken two ways: the
opening, as Y. Yan (TU Delft 2022, section 5.4.2) has it, and the width that holds a share of the section's area.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, boundary_edges, directed_edges, read_surface
from bulkwear.postproc.tables.display import MICROMETRES, MILLIMETRES
from bulkwear.workflows.cases.pin_on_disc.runs import SCHEMES, common_revolution, whole_revolutions

CONTOURS = 360  # 1 degree apart (Yan 2022, section 5.4.2; the 0.5 degrees of the text would make 720)
OPENING_LEVEL = 0.1  # -, of a contour's depth: right at the rim the groove fades out over one edge of the mesh
AREA_SHARE = 0.95  # -, of the section's area: the width that holds it does not hang on where the rim fades out
RADIAL_SPACING = 5e-6  # m, of the places along a contour; a fiftieth of a 0.25 mm contact
WIDEST_SIDE = 3.0e-3  # m, of the window either side of the track
SECTION_SPACING = 10e-6  # m, of the places of a section that is drawn
RIM_SHARE = 0.98  # -, of the way to the edge of the disc that the window may reach: the edge is a polygon
EXAMPLE_ANGLES = tuple(range(20, 380, 45))  # degrees, of the eight sections that are shown
MESH_ANGLE = 90  # degrees, of the section that is shown of every mesh
LAST_REVOLUTIONS = 3  # shown on top of each other
MAP_SPACING = 20e-6  # m, of the places across the unrolled track
MAP_SIDE = 1.2e-3  # m, shown either side of the track


def track_radii(mesh: SurfaceMesh, track_radius: float, spacing: float = RADIAL_SPACING) -> np.ndarray:
    """Places (k,) m along a contour, evenly about the track, as far as the disc reaches on both sides.

    Raises ValueError when the track (m) is not on the disc.
    """
    edge = np.linalg.norm(mesh.points[boundary_edges(mesh.triangles)[:, 0], :2], axis=1)
    inside, outside = edge[edge < track_radius], edge[edge >= track_radius]
    if not outside.size:
        raise ValueError(f"the disc ends at {edge.max():.4g} m, allowed is one beyond the track at {track_radius:g} m")
    side = RIM_SHARE * min(outside.min() - track_radius, track_radius - inside.max(initial=0.0))
    count = int(min(side, WIDEST_SIDE) / spacing)
    return track_radius + spacing * np.arange(-count, count + 1)


def radial_crossings(mesh: SurfaceMesh, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where the edges of a surface cross `count` half-planes about the z axis, the first at +x, evenly spaced.

    Returns contour (c,), radius (c,) m and height (c,) m, sorted by contour and radius. Edges next to the axis, of
    which the sense of rotation is not clear, are left out: those that turn by a quarter or more.
    """
    edges = np.sort(directed_edges(mesh.triangles), axis=1)
    edges = edges[np.unique(edges[:, 0] * len(mesh.points) + edges[:, 1], return_index=True)[1]]
    turn = 2.0 * np.pi / count
    sector = np.floor(np.arctan2(mesh.points[:, 1], mesh.points[:, 0]) / turn).astype(np.int64)
    crossed = (sector[edges[:, 1]] - sector[edges[:, 0]] + count // 2) % count - count // 2
    edges = np.where((crossed < 0)[:, None], edges[:, ::-1], edges)  # all anticlockwise
    crossed = np.where(4 * np.abs(crossed) < count, np.abs(crossed), 0)
    edge = np.repeat(np.arange(len(edges)), crossed)
    nth = np.arange(len(edge)) - np.repeat(np.cumsum(crossed) - crossed, crossed) + 1
    contour = (sector[edges[edge, 0]] + nth) % count
    start, end = mesh.points[edges[edge, 0]], mesh.points[edges[edge, 1]]
    cosine, sine = np.cos(turn * contour), np.sin(turn * contour)
    before, after = (point[:, 1] * cosine - point[:, 0] * sine for point in (start, end))
    apart = before - after  # 0 where an edge lies in the half-plane: any of its points will do
    share = np.clip(np.divide(before, apart, out=np.zeros_like(apart), where=apart != 0.0), 0.0, 1.0)[:, None]
    place = (1.0 - share) * start + share * end
    radius = place[:, 0] * cosine + place[:, 1] * sine
    order = np.lexsort((radius, contour))
    return contour[order], radius[order], place[order, 2]


def depth_map(mesh: SurfaceMesh, radii: np.ndarray, count: int = CONTOURS) -> np.ndarray:
    """Depth (count, k) m below z = 0 on radial contours, at the places `radii` (k,) m, increasing.

    Exact between the edges of the mesh, whose triangles are plane. For discs without overhang.
    Raises ValueError when the surface does not reach over all places of a contour.
    """
    return _interpolated(*radial_crossings(mesh, count), radii, count)


def _interpolated(
    contour: np.ndarray, radius: np.ndarray, height: np.ndarray, radii: np.ndarray, count: int
) -> np.ndarray:
    """Depth (count, k) m at the places `radii` between crossings, as from `radial_crossings`; raises as `depth_map`."""
    stride = 2.0 * max(radius.max(initial=0.0), radii[-1])  # contours one behind the other on one axis
    nearest, farthest = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(nearest, contour, radius)
    np.maximum.at(farthest, contour, radius)
    short = (nearest > radii[0]) | (farthest < radii[-1])
    if short.any():
        raise ValueError(
            f"the surface does not reach from {radii[0]:.4g} to {radii[-1]:.4g} m in {np.count_nonzero(short)} "
            f"contours, first at {360.0 * np.argmax(short) / count:g} degrees; allowed are places on the disc"
        )
    places = stride * np.arange(count)[:, None] + radii
    return -np.interp(places.ravel(), stride * contour + radius, height).reshape(places.shape)


def opening_width(depth: np.ndarray, radii: np.ndarray, level: float = OPENING_LEVEL) -> np.ndarray:
    """Width (n,) m of the opening of contours: between the outermost places deeper than a share of the depth.

    depth : (n, k) m at radii (k,) m; level : share of each contour's largest depth. 0 for a contour that is not worn.
    """
    excess = depth - level * depth.max(axis=1, keepdims=True)
    deep = excess > 0.0
    worn = deep.any(axis=1)
    first = np.argmax(deep, axis=1)
    last = len(radii) - 1 - np.argmax(deep[:, ::-1], axis=1)
    ends = [_crossing(excess, radii, first, first - 1), _crossing(excess, radii, last, last + 1)]
    return np.where(worn, ends[1] - ends[0], 0.0)


def _crossing(excess: np.ndarray, radii: np.ndarray, within: np.ndarray, beyond: np.ndarray) -> np.ndarray:
    """Radius (n,) m where the excess of each row vanishes between neighbouring columns, or where the row ends."""
    rows, beyond = np.arange(len(excess)), np.clip(beyond, 0, len(radii) - 1)
    inner, outer = excess[rows, within], excess[rows, beyond]
    share = np.divide(inner, inner - outer, out=np.zeros_like(inner), where=inner != outer)
    return radii[within] + share * (radii[beyond] - radii[within])


def width_of_area(depth: np.ndarray, radii: np.ndarray, share: float = AREA_SHARE) -> np.ndarray:
    """Width (n,) m that holds a share of each contour's area, the rest lying half on either side.

    depth : (n, k) m at radii (k,) m; 0 for a contour that is not worn.
    """
    pieces = 0.5 * (depth[:, 1:] + depth[:, :-1]) * np.diff(radii)
    area = np.concatenate([np.zeros((len(depth), 1)), np.cumsum(np.maximum(pieces, 0.0), axis=1)], axis=1)
    ends = []
    for part in (0.5 * (1.0 - share), 0.5 * (1.0 + share)):
        excess = area - part * area[:, -1:]
        ends.append(_crossing(excess, radii, np.argmax(excess > 0.0, axis=1), np.argmax(excess > 0.0, axis=1) - 1))
    return np.where(area[:, -1] > 0.0, ends[1] - ends[0], 0.0)


def contour_table(mesh: SurfaceMesh, track_radius: float, count: int = CONTOURS) -> pd.DataFrame:
    """One row per radial contour: `angle_deg`, `depth_m`, `opening_width_m`, `area_width_m`, `area_m2`.

    mesh : worn disc in z = 0; track_radius : m. Raises ValueError as `track_radii` and `depth_map`.
    """
    radii = track_radii(mesh, track_radius)
    contour, radius, height = radial_crossings(mesh, count)
    depth = _interpolated(contour, radius, height, radii, count)
    on_track = (radius >= radii[0]) & (radius <= radii[-1])
    deepest = np.zeros(count)
    np.maximum.at(deepest, contour[on_track], -height[on_track])  # at an edge: a section is straight in between
    return pd.DataFrame(
        {
            "angle_deg": 360.0 / count * np.arange(count),
            "depth_m": deepest,
            "opening_width_m": opening_width(depth, radii),
            "area_width_m": width_of_area(depth, radii),
            "area_m2": np.trapezoid(depth, radii, axis=1),
        }
    )


def section_table(mesh: SurfaceMesh, track_radius: float, angles: Sequence[int]) -> pd.DataFrame:
    """Sections of a worn disc at whole degrees: `angle_deg`, `across_mm` (from the track, outwards), `depth_um`.

    Raises ValueError as `contour_table`.
    """
    radii = track_radii(mesh, track_radius, SECTION_SPACING)
    depth = depth_map(mesh, radii)[np.asarray(angles) % CONTOURS]
    return pd.DataFrame(
        {
            "angle_deg": np.repeat(angles, len(radii)),
            "across_mm": np.tile(MILLIMETRES * (radii - track_radius), len(angles)),
            "depth_um": MICROMETRES * depth.ravel(),
        }
    )


def track_map(mesh: SurfaceMesh, track_radius: float) -> pd.DataFrame:
    """Depth (um) of the unrolled track: one row per radius (index `radius_mm`), one column per whole degree."""
    radii = track_radii(mesh, track_radius, MAP_SPACING)
    radii = radii[np.abs(radii - track_radius) <= MAP_SIDE]
    index = pd.Index(MILLIMETRES * radii, name="radius_mm")
    return pd.DataFrame(MICROMETRES * depth_map(mesh, radii).T, index=index, columns=range(CONTOURS))


def track_table(maps: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """One table of the maps of each scheme, as from `track_map`: `radius_mm`, a column per degree, `scheme`."""
    return pd.concat([shown.reset_index().assign(scheme=scheme) for scheme, shown in maps.items()])


def _sections(folder: Path, run: pd.Series, revolution: int, angles: Sequence[int]) -> pd.DataFrame:
    """Sections of a run after a whole revolution."""
    ends = whole_revolutions(pd.read_csv(folder / run["run"] / "wear.csv")).set_index("revolution")["cycle"]
    surface = read_surface(folder / run["run"] / f"cycle_{ends[revolution]:03d}" / "surface.vtu")
    return section_table(surface, run["track_radius_m"], angles).assign(
        run=run["run"], scheme=run["scheme"], revolution=revolution, element_size_mm=run["element_size_mm"]
    )


def example_sections(folder: str | Path, runs: pd.DataFrame, contours: pd.DataFrame) -> pd.DataFrame:
    """Sections at eight angles after the last revolutions that all `runs` have, as from `section_table`."""
    of_these = contours[contours["run"].isin(runs["run"])]
    last = common_revolution(of_these, of_these["revolution"].max())
    return pd.concat(
        [
            _sections(Path(folder), run, revolution, EXAMPLE_ANGLES)
            for _, run in runs.iterrows()
            for revolution in range(max(last - LAST_REVOLUTIONS + 1, 1), last + 1)
        ],
        ignore_index=True,
    )


def mesh_sections(folder: str | Path, runs: pd.DataFrame, series: pd.DataFrame) -> pd.DataFrame:
    """One section of every mesh of the series after the first revolution (Yan 2022, Fig 5.8)."""
    chosen = runs[runs["run"].isin(series["run"])].sort_values("element_size_mm")
    parts = [_sections(Path(folder), run, 1, [MESH_ANGLE]) for _, run in chosen.iterrows()]
    order = {scheme: place for place, scheme in enumerate(SCHEMES)}
    return pd.concat(parts, ignore_index=True).sort_values("scheme", key=lambda names: names.map(order), kind="stable")
