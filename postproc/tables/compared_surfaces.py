"""Which surfaces of which runs and cycles a page compares, and what may be shown on them.

Values are per node, so that a page can tell them under the pointer: what a triangle summed is spread over its nodes by
area. Where runs are many, cycles between the unworn surface and the last one have their depth alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, node_areas, read_surface, sum_over_nodes
from bulkwear.postproc.tables.depths import WORN_VOLUME, depth_quantity, node_depth
from bulkwear.postproc.tables.display import MICROMETRES, MILLIMETRES
from bulkwear.postproc.tables.film import without_skirt
from bulkwear.postproc.wear.fields import CARRIED_VOLUME, REMOVED_THICKNESS
from bulkwear.postproc.wear.thickness import LOCAL_THICKNESS

MOST_BYTES = 3_200_000  # of all surfaces together, before they are written as letters
# bytes of a node, compressed: an unworn surface (the demo's convex one, a plain one 2.1), all values of a worn one, and
# its depth alone, both of numbers by chance; places of worn surfaces are kept as what differs from the unworn one
UNWORN_NODE, WHOLE_NODE, DEPTH_NODE = 6.6, 8.3, 2.3
MOST_CYCLES, FEWEST_WHOLE = 10, 4  # of a run; shown with all values before their middle ones are cut to depths
KILOPASCAL = 1e-3  # kPa per Pa
CORNERS = 3.0  # of a triangle
SURFACE, UNWORN = "surface.vtu", "unworn"
DEPTH = "depth"  # key of what every surface has

Values = np.ndarray


@dataclass(frozen=True)
class Shown:
    """What wears of a run's surface: its name, cycle, simulated time (s), what a page calls the cycle, the mesh, and
    whether all values are shown on it or its depth alone.
    """

    run: str
    cycle: int
    time_s: float
    said: str
    mesh: SurfaceMesh
    whole: bool = True


@dataclass(frozen=True)
class Quantity:
    """What may be shown on surfaces: title, unit, and values (n,) at the nodes of one; None where it has none.

    less: two others whose difference it is, so that a page needs no values of its own
    """

    title: str
    unit: str
    values: Callable[[Shown], Values | None]
    less: tuple[str, str] | None = None


def shown_surfaces(runs: Mapping[str, Path], wear: Mapping[str, pd.DataFrame]) -> list[Shown]:
    """Return the unworn surface of each run and those of some of its cycles, evenly spaced, the last one among them.

    runs: {run: its folder}; wear: {run: its wear.csv}. Each run has MOST_CYCLES cycles, or as many as keep all surfaces
    below MOST_BYTES (`_shown_cycles`); of more runs than that allows with one cycle each, the first ones are returned.
    Raises FileNotFoundError for a cycle without a surface.
    """
    unworn = {run: without_skirt(read_surface(folder / SURFACE)) for run, folder in runs.items()}
    most, whole = _shown_cycles(sum(len(mesh.points) for mesh in unworn.values()))
    found, count = [], 0
    for run, mesh in unworn.items():
        count += len(mesh.points)
        if found and count * (UNWORN_NODE + WHOLE_NODE) > MOST_BYTES:
            break
        found += _of_run(run, runs[run], mesh, wear[run], most, whole)
    return found


def _shown_cycles(nodes: int) -> tuple[int, bool]:
    """Return how many cycles of each run are shown, and whether all of them with all values, or the last alone.

    nodes: of the unworn surfaces of all runs
    """
    left = MOST_BYTES / max(nodes, 1) - UNWORN_NODE
    whole = min(MOST_CYCLES, int(left / WHOLE_NODE))
    if whole >= FEWEST_WHOLE:
        return whole, True
    return max(min(MOST_CYCLES, 1 + int((left - WHOLE_NODE) / DEPTH_NODE)), 1), False


def _of_run(
    run: str, folder: Path, unworn: SurfaceMesh, wear: pd.DataFrame, most: int, every_whole: bool
) -> list[Shown]:
    chosen = np.unique(np.linspace(len(wear) - 1, 0, min(len(wear), most)).round().astype(int))
    rows = wear.iloc[chosen]
    meshes = [without_skirt(read_surface(folder / f"cycle_{cycle:03d}" / SURFACE)) for cycle in rows["cycle"]]
    whole = [every_whole or row == chosen[-1] for row in chosen]
    worn = [
        Shown(run, int(row["cycle"]), float(row["time_s"]), _called(row), mesh, is_whole)
        for (_, row), mesh, is_whole in zip(rows.iterrows(), meshes, whole, strict=True)
    ]
    return [Shown(run, 0, 0.0, UNWORN, unworn), *worn]


def _called(row: pd.Series) -> str:
    """Return what a page calls a cycle: its number, and how far it has come."""
    if "operation_h" in row:
        return f"{row['operation_h'] + row['stands_for_h']:,.0f} h (block {row['cycle']:.0f})"
    return f"cycle {row['cycle']:.0f}, {row['travel_m']:.3g} m"


def quantities(deformed: bool) -> dict[str, Quantity]:
    """Return what may be shown on worn surfaces. deformed: whether wear was applied to their shape"""
    found = {DEPTH: Quantity(depth_quantity(deformed), "µm", lambda shown: _depth(shown.mesh, deformed))}
    if deformed:
        found["removed"] = Quantity("Thickness removed", "µm", lambda shown: _removed(shown.mesh))
        found["carried"] = Quantity(
            "Carried, not yet removed", "µm", lambda shown: _held(shown.mesh), (DEPTH, "removed")
        )
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
