"""Surfaces of several runs at several cycles with what is shown on them, as one small packed block for a page.

Values are per node, so that a page can tell them under the pointer: what a triangle summed is spread over its nodes by
area. Places are kept to 1/65535 of the box round all surfaces, values to 1/65534 of their largest.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, node_areas, read_surface, sum_over_nodes
from bulkwear.postproc.tables.depths import WORN_VOLUME, area_quantile, depth_quantity, node_depth
from bulkwear.postproc.tables.display import MICROMETRES, MILLIMETRES
from bulkwear.postproc.tables.film import without_skirt
from bulkwear.postproc.wear.fields import CARRIED_VOLUME, REMOVED_THICKNESS
from bulkwear.postproc.wear.thickness import LOCAL_THICKNESS

MOST_NODES = 300_000  # of all surfaces together: the page then has some three megabytes of numbers
MOST_CYCLES = 10  # of a run
TOP_SHARE = 0.99  # -, of the area of the surface with the largest values: the colours end there
KILOPASCAL = 1e-3  # kPa per Pa
CORNERS = 3.0  # of a triangle
LEVELS = 65535  # of a 16-bit number
UNKNOWN = LEVELS  # a node without a value
SURFACE, UNWORN = "surface.vtu", "unworn"
ALIGNED, HARDEST = 4, 9  # bytes of the longest number; level of the compression

Values = np.ndarray


@dataclass(frozen=True)
class Shown:
    """What wears of a run's surface: its name, cycle, simulated time (s), what a page calls the cycle, and the mesh."""

    run: str
    cycle: int
    time_s: float
    said: str
    mesh: SurfaceMesh


@dataclass(frozen=True)
class Quantity:
    """What may be shown on surfaces: title, unit, and values (n,) at the nodes of one; None where it has none."""

    title: str
    unit: str
    values: Callable[[Shown], Values | None]


def shown_surfaces(runs: Mapping[str, Path], wear: Mapping[str, pd.DataFrame]) -> list[Shown]:
    """Return the unworn surface of each run and those of some of its cycles, evenly spaced, the last one among them.

    runs: {run: its folder}; wear: {run: its wear.csv}. Each run has MOST_CYCLES cycles, or as many as keep all surfaces
    below MOST_NODES; of more runs than that allows with one cycle each, the first ones are returned.
    Raises FileNotFoundError for a cycle without a surface.
    """
    unworn = {run: without_skirt(read_surface(folder / SURFACE)) for run, folder in runs.items()}
    nodes = sum(len(mesh.points) for mesh in unworn.values())
    most = max(min(MOST_CYCLES, MOST_NODES // max(nodes, 1) - 1), 1)
    found, count = [], 0
    for run, mesh in unworn.items():
        count += (1 + most) * len(mesh.points)
        if found and count > MOST_NODES:
            break
        found += _of_run(run, runs[run], mesh, wear[run], most)
    return found


def _of_run(run: str, folder: Path, unworn: SurfaceMesh, wear: pd.DataFrame, most: int) -> list[Shown]:
    chosen = np.unique(np.linspace(len(wear) - 1, 0, min(len(wear), most)).round().astype(int))
    rows = wear.iloc[chosen]
    meshes = [without_skirt(read_surface(folder / f"cycle_{cycle:03d}" / SURFACE)) for cycle in rows["cycle"]]
    worn = [
        Shown(run, int(row["cycle"]), float(row["time_s"]), _called(row), mesh)
        for (_, row), mesh in zip(rows.iterrows(), meshes, strict=True)
    ]
    return [Shown(run, 0, 0.0, UNWORN, unworn), *worn]


def _called(row: pd.Series) -> str:
    """Return what a page calls a cycle: its number, and how far it has come."""
    if "operation_h" in row:
        return f"{row['operation_h'] + row['stands_for_h']:,.0f} h (block {row['cycle']:.0f})"
    return f"cycle {row['cycle']:.0f}, {row['travel_m']:.3g} m"


def quantities(deformed: bool) -> dict[str, Quantity]:
    """Return what may be shown on worn surfaces. deformed: whether wear was applied to their shape"""
    found = {"depth": Quantity(depth_quantity(deformed), "µm", lambda shown: _depth(shown.mesh, deformed))}
    if deformed:
        found["removed"] = Quantity("Thickness removed", "µm", lambda shown: _removed(shown.mesh))
        found["carried"] = Quantity("Carried, not yet removed", "µm", lambda shown: _held(shown.mesh))
        found["remaining"] = Quantity("Remaining thickness", "mm", lambda shown: _remaining(shown.mesh))
    return found | {
        "pressure": Quantity("Mean normal traction", "kPa", _rate("normal_impulse_N_s", KILOPASCAL)),
        "sliding": Quantity("Sliding power", "W/m²", _rate("sliding_work_J")),
        "impact": Quantity("Impact power", "W/m²", _rate("impact_energy_J")),
    }


def _depth(mesh: SurfaceMesh, deformed: bool) -> Values:
    unworn = REMOVED_THICKNESS not in mesh.point_data if deformed else WORN_VOLUME not in mesh.cell_data
    return np.zeros(len(mesh.points)) if unworn else node_depth(mesh, deformed) * MICROMETRES


def _removed(mesh: SurfaceMesh) -> Values:
    return mesh.point_data.get(REMOVED_THICKNESS, np.zeros(len(mesh.points))) * MICROMETRES


def _held(mesh: SurfaceMesh) -> Values | None:
    return _depth(mesh, True) - _removed(mesh) if CARRIED_VOLUME in mesh.point_data else None


def _remaining(mesh: SurfaceMesh) -> Values | None:
    if LOCAL_THICKNESS not in mesh.point_data:
        return None
    return (mesh.point_data[LOCAL_THICKNESS] - _removed(mesh) / MICROMETRES) * MILLIMETRES


def _rate(name: str, scale: float = 1.0) -> Callable[[Shown], Values | None]:
    """Return what gives a sum of the ledger over area and simulated time, at nodes."""

    def values(shown: Shown) -> Values | None:
        mesh = shown.mesh
        if name not in mesh.cell_data or not shown.time_s > 0.0:
            return None
        area, count = node_areas(mesh), len(mesh.points)
        total = sum_over_nodes(mesh.triangles, mesh.cell_data[name], count) / CORNERS
        mean = np.divide(total, area, out=np.full(count, np.nan), where=area > 0.0)
        return mean * scale / shown.time_s

    return values


def top_of(shown: Shown, values: Values) -> float:
    """Return the value that TOP_SHARE of a surface's area does not exceed."""
    area = node_areas(shown.mesh)
    known = np.isfinite(values) & (area > 0.0)
    return area_quantile(values[known], area[known], TOP_SHARE) if known.any() else 0.0


def packed(surfaces: Sequence[Shown], deformed: bool) -> tuple[dict[str, Any], bytes]:
    """Return what a page is told of surfaces, JSON-able, and the compressed (zlib) block of numbers that it points to.

    Told: `box` (low and high corner, mm), `quantities` (key, title, unit, top of the colours, largest value), and
    `surfaces` (run, cycle, said, numbers of nodes and faces, and where its points (n, 3) uint16, triangles (m, 3)
    uint32, label of the part at each node (n,) int16 and values (n,) uint16 by key begin in the block, in bytes).
    Arrays that are alike are kept once. What no surface has is left out.
    """
    block = _Block()
    corners = np.array([[each.mesh.points.min(axis=0), each.mesh.points.max(axis=0)] for each in surfaces])
    low, high = corners[:, 0].min(axis=0) * MILLIMETRES, corners[:, 1].max(axis=0) * MILLIMETRES
    size = float(max((high - low).max(), np.finfo(float).tiny))
    told = [
        {
            "run": each.run,
            "cycle": each.cycle,
            "said": each.said,
            "nodes": len(each.mesh.points),
            "faces": len(each.mesh.triangles),
            "points": block.add(np.round((each.mesh.points * MILLIMETRES - low) / size * LEVELS).astype("<u2")),
            "triangles": block.add(each.mesh.triangles.astype("<u4")),
            "parts": block.add(node_parts(each.mesh).astype("<i2")),
            "values": {},
        }
        for each in surfaces
    ]
    shown = {}
    for key, quantity in quantities(deformed).items():
        values = [quantity.values(each) for each in surfaces]
        known = [(each, found) for each, found in zip(surfaces, values, strict=True) if found is not None]
        if not known or not np.isfinite(np.concatenate([found for _, found in known])).any():
            continue
        largest = max(float(np.nanmax(found)) for _, found in known if np.isfinite(found).any())
        top = max(top_of(*pair) for pair in known)
        if not largest > 0.0:
            continue
        scale, unit = _readable(largest, quantity.unit)
        ends = {"top": scale * (top if top > 0.0 else largest), "largest": scale * largest}
        shown[key] = {"title": quantity.title, "unit": unit, **ends}
        for entry, found in zip(told, values, strict=True):
            if found is not None:
                entry["values"][key] = block.add(_levels(found, largest))
    return {"box": [low.tolist(), (low + size).tolist()], "quantities": shown, "surfaces": told}, block.compressed()


def _readable(largest: float, unit: str) -> tuple[float, str]:
    """Return by what values are multiplied, and their unit then: micrometres by the thousand are millimetres."""
    return (MILLIMETRES / MICROMETRES, "mm") if unit == "µm" and largest > MICROMETRES / MILLIMETRES else (1.0, unit)


def node_parts(mesh: SurfaceMesh) -> np.ndarray:
    """Return the label (n,) of the part at each node: the highest of its triangles'."""
    labels = mesh.cell_data.get("part", np.zeros(len(mesh.triangles), dtype=int))
    found = np.full(len(mesh.points), labels.min(initial=0))
    np.maximum.at(found, mesh.triangles.ravel(), np.repeat(labels, 3))
    return found


def _levels(values: Values, largest: float) -> np.ndarray:
    share = np.clip(np.where(np.isfinite(values), values, 0.0) / largest, 0.0, 1.0)
    return np.where(np.isfinite(values), np.round(share * (LEVELS - 1)), UNKNOWN).astype("<u2")


class _Block:
    """Arrays one after another, each beginning at a multiple of four bytes, alike ones once."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self.length = 0
        self.places: dict[bytes, int] = {}

    def add(self, array: np.ndarray) -> int:
        """Return where (bytes) an array begins."""
        content = np.ascontiguousarray(array).tobytes()
        if content not in self.places:
            self.places[content] = self.length
            padded = content + bytes(-len(content) % ALIGNED)
            self.parts.append(padded)
            self.length += len(padded)
        return self.places[content]

    def compressed(self) -> bytes:
        """Return all arrays, compressed."""
        return zlib.compress(b"".join(self.parts), HARDEST)
