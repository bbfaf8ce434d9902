"""The worn surface of one run cycle by cycle, for a film: which run, which cycles, a section through the pattern."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import PLAIN, SurfaceMesh, node_area_vectors, node_areas, read_surface, worn_faces
from bulkwear.postproc.tables.depths import area_quantile
from bulkwear.postproc.tables.display import in_display_units
from bulkwear.postproc.tables.summary import rows_to_show, runs_of_rows
from bulkwear.postproc.wear.fields import REMOVED_THICKNESS
from bulkwear.postproc.wear.pattern_left import pattern_volume

MOST_FRAMES = 60  # of a film: more would make its file large, and not easier to see
SEEN_SHARE = 0.99  # -, of the area
DRAWN_DEPTH = 0.1  # -, of a pattern's height: wear so deep is seen
DEEPEST_DRAWN = 0.4  # -, of that height: single spots are many times deeper than the rest, and would go through
PLAIN_HEIGHT = 0.05  # -, of a plain sample's length, what stands for the height of a pattern
ON_PLANE = 1e-9  # -, of the mesh's size: a node so near to the plane of a section counts as beside it


def film_run(summary: pd.DataFrame) -> str:
    """Return the run that is filmed: of the row shown in detail the one with a pattern, else its first."""
    runs = runs_of_rows(summary, rows_to_show(summary))
    surfaces = summary.set_index("run")["surface"]
    return next((run for run in runs if surfaces[run] != PLAIN), runs[0])


def film_frames(wear: pd.DataFrame, most: int = MOST_FRAMES) -> pd.DataFrame:
    """Return the frames of a film, from the unworn surface on: cycle, travel_m, applied_volume_m3 (in all so far).

    wear: wear.csv of the run. Of more cycles than frames, evenly spaced ones, the last one among them.
    """
    start = pd.DataFrame({"cycle": [0], "travel_m": [0.0], "total_applied_volume_m3": [0.0]})
    table = pd.concat([start, wear[list(start)]], ignore_index=True)
    shown = np.unique(np.linspace(0, len(table) - 1, min(len(table), most)).round().astype(int))
    return table.iloc[shown].rename(columns={"total_applied_volume_m3": "applied_volume_m3"}).reset_index(drop=True)


def film_surfaces(run_folder: str | Path, frames: pd.DataFrame) -> list[SurfaceMesh]:
    """Return the surface of each frame without skirt; cycle 0 is the pristine one, which has lost nothing.

    Raises FileNotFoundError when the surface of a cycle is missing.
    """
    folder = Path(run_folder)
    files = [folder / (f"cycle_{cycle:03d}" if cycle else "") / "surface.vtu" for cycle in frames["cycle"]]
    if missing := [path for path in files if not path.is_file()]:
        raise FileNotFoundError(f"{missing[0]}: not found, the film needs the surface of every cycle in wear.csv.")
    pristine, *worn = (without_skirt(read_surface(path)) for path in files)
    unworn = {REMOVED_THICKNESS: np.zeros(len(pristine.points))}
    return [replace(pristine, point_data={**pristine.point_data, **unworn}), *worn]


def without_skirt(mesh: SurfaceMesh) -> SurfaceMesh:
    """Return the faces of a surface that wear, with their nodes and data alone: a film's sample is then larger."""
    worn = worn_faces(mesh)
    nodes, triangles = np.unique(mesh.triangles[worn], return_inverse=True)
    cells = {name: values[worn] for name, values in mesh.cell_data.items()}
    data = {name: values[nodes] for name, values in mesh.point_data.items()}
    return SurfaceMesh(mesh.points[nodes], triangles.reshape(-1, 3), cells, data)


def exaggeration(unworn: SurfaceMesh, last: SurfaceMesh) -> float:
    """Return how many times deeper than it is wear must be drawn to be seen: 1, 2 or 5 times a power of ten, or 1.

    The depth that SEEN_SHARE of the area does not exceed in the end then is no more than DRAWN_DEPTH of the pattern's
    height, or of PLAIN_HEIGHT of a plain sample's length.
    """
    depth = area_quantile(last.point_data[REMOVED_THICKNESS], node_areas(last), SEEN_SHARE)
    wanted = DRAWN_DEPTH * drawn_height(unworn) / depth if depth > 0.0 else 1.0
    power = 10.0 ** math.floor(math.log10(max(wanted, 1.0)))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= max(wanted, 1.0))


def drawn_height(unworn: SurfaceMesh) -> float:
    """Return the height (m) of a pattern, or what stands for it on a plain sample."""
    width, length, height = np.ptp(unworn.points, axis=0)
    return float(max(height, PLAIN_HEIGHT * max(width, length)))


def exaggerated(mesh: SurfaceMesh, factor: float, most: float) -> SurfaceMesh:
    """Return a surface with wear drawn `factor` times as deep as it is, along its normals, but no more than `most` (m)
    deeper.
    """
    vectors = node_area_vectors(mesh.points, mesh.triangles)
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    normals = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0.0)
    deeper = np.minimum((factor - 1.0) * mesh.point_data[REMOVED_THICKNESS], most)
    return replace(mesh, points=mesh.points - deeper[:, None] * normals)


def frame_table(frames: pd.DataFrame, surfaces: list[SurfaceMesh]) -> pd.DataFrame:
    """Return the frames in display units with what is seen on them: largest removed thickness, highest point, and how
    much of the pattern is left (percent of its volume; NaN without one).
    """
    deepest = [mesh.point_data[REMOVED_THICKNESS].max() for mesh in surfaces]
    highest = [mesh.points[:, 2].max() for mesh in surfaces]
    volume = np.array([pattern_volume(mesh) for mesh in surfaces])
    left = np.divide(100.0 * volume, volume[0], out=np.full(len(volume), np.nan), where=volume[0] != 0.0)
    shown = frames.assign(largest_depth_m=deepest, highest_point_m=highest, bumps_left_percent=left)
    return in_display_units(shown)


def section_place(pristine: SurfaceMesh, last: SurfaceMesh) -> float:
    """Return x (m) of the section that a film shows: through what of a pattern has lost most, else the middle."""
    points, part = last.points[last.triangles], last.cell_data["part"]
    thickness = last.point_data[REMOVED_THICKNESS][last.triangles].mean(axis=1)
    area = np.linalg.norm(np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]), axis=1)
    lost = np.bincount(np.maximum(part, 0), thickness * area * (part > 0))
    most = pristine.cell_data["part"] == lost.argmax()
    if not lost.any() or not most.any():
        return float(pristine.points[:, 0].mean())
    x = pristine.points[np.unique(pristine.triangles[most]), 0]
    return float((x.min() + x.max()) / 2.0)


def section(mesh: SurfaceMesh, x: float) -> np.ndarray:
    """Return the lines (k, 2, 2) in which the plane at x (m) cuts the triangles of a surface: y and z (m) of ends."""
    beside = mesh.points[:, 0] - x
    least = ON_PLANE * float(np.ptp(mesh.points[:, 0]))
    beside = np.where(np.abs(beside) < least, least, beside)
    first, second = mesh.triangles, np.roll(mesh.triangles, -1, axis=1)
    crossed = beside[first] * beside[second] < 0.0
    cut = crossed.any(axis=1)  # then two of its three edges are crossed
    ends = np.stack([first[cut][crossed[cut]], second[cut][crossed[cut]]])
    share = beside[ends[0]] / (beside[ends[0]] - beside[ends[1]])
    place = mesh.points[ends[0]] + share[:, None] * (mesh.points[ends[1]] - mesh.points[ends[0]])
    return place[:, 1:].reshape(-1, 2, 2)
