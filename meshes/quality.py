"""How good a sample's mesh is, in numbers."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh, edge_lengths_per_triangle, smallest_angles

PARTS = ("base", "bump", "skirt")


def quality(mesh: SurfaceMesh) -> dict[str, float]:
    """Triangles, bumps, shortest edge (m), and per part smallest angle and its 1st percentile (degrees)."""
    part, angle = mesh.cell_data["part"], smallest_angles(mesh.points, mesh.triangles)
    shortest = edge_lengths_per_triangle(mesh.points, mesh.triangles).min()
    result = {"triangles": len(part), "bumps": int(part.max()), "on_bumps": int((part > 0).sum())}
    result["shortest_edge_m"] = float(shortest)
    for name, where in zip(PARTS, (part == 0, part > 0, part < 0), strict=True):
        found = angle[where] if where.any() else np.array([np.nan])
        result[f"{name}_smallest_deg"] = float(found.min())
        result[f"{name}_percentile_1_deg"] = float(np.percentile(found, 1))
    return result


def quality_table(meshes: Iterable[tuple[str, SurfaceMesh]]) -> str:
    """A Markdown table with one row per named mesh: angles as smallest / 1st percentile, in degrees."""
    lines = [
        "| geometry | bumps | triangles | on bumps | base | bumps | skirt |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, mesh in meshes:
        numbers = quality(mesh)
        angles = [f"{numbers[f'{p}_smallest_deg']:.0f} / {numbers[f'{p}_percentile_1_deg']:.0f}" for p in PARTS]
        counts = [numbers["bumps"], numbers["triangles"], numbers["on_bumps"]]
        lines.append("| " + " | ".join([name, *map(str, counts), *angles]) + " |")
    return "\n".join(lines)
