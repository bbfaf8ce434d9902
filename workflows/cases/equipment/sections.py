"""Sections through the worst places of a study's parts: outlines as built and after some updates, as drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bulkwear.postproc.mesh import SurfaceMesh, areas, centroids, read_surface, unit_normals
from bulkwear.postproc.tables.display import MILLIMETRES
from bulkwear.postproc.wear.side import turned_as
from bulkwear.workflows.cases.equipment.pictures import SURFACE, first_runs, labels_of, part_mesh, turns_about
from bulkwear.workflows.cases.equipment.plane_cuts import SectionPlane, cut, part_plane, turning_plane, values_on

MOST_SHAPES = 6  # of a section, that as built and the last one among them
WINDOW_THICKNESSES = 2.5  # half the width that is shown over the part's thickness there
WINDOW_PATCHES = 2.0  # the same over the length of a patch, where no thickness is known, or of a part that turns
LOOKS_OUT = 0.5  # -, cosine of a face to the plane's way out from which what it lost is told along the section
COLUMNS = ("along_1_mm", "out_1_mm", "along_2_mm", "out_2_mm", "depth_1_mm", "depth_2_mm")


def worst_sections(
    runs: Sequence[Mapping[str, Any]], folder: Path, worst: pd.DataFrame
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the lines of the sections through the worst place of every part and setting, and a row per section.

    worst: as from `life_tables.worst_places`; of each setting the first packing is cut
    lines: section, setting, part, operation_h, COLUMNS, faces_out
    sections: section, setting, part, x_mm .. z_mm of the origin, name, half_width_mm, turns; part by part
    """
    lines, sections = [], []
    for run in first_runs(runs):
        shapes = shown_shapes(folder / run["run"])
        for place in worst[(worst["setting"] == run["setting"]) & (worst["rank"] == 1)].itertuples():
            number = len(sections) + 1
            label, motion = labels_of(run)[place.part], run["parts"][place.part]["motion"]
            plane = _plane(shapes[0][1], label, motion, place, run["patch_m"])
            turns, thick = turns_about(motion) is not None, WINDOW_THICKNESSES * place.thickness_mm
            wide = MILLIMETRES * WINDOW_PATCHES * run["patch_m"]
            half = np.fmax(thick, wide) if turns else thick if np.isfinite(thick) else wide
            row = {"section": number, "setting": run["setting"], "part": place.part}
            row |= {f"{axis}_mm": MILLIMETRES * plane.place[k] for k, axis in enumerate("xyz")}
            sections.append(row | {"half_width_mm": half, "turns": turns})
            tables = [_lines(surface, label, plane).assign(operation_h=hours) for hours, surface in shapes]
            lines.append(pd.concat(tables).assign(section=number, setting=run["setting"], part=place.part))
    order = list(dict.fromkeys(row["part"] for row in sections))
    table = pd.DataFrame(sections).sort_values("part", key=lambda names: names.map(order.index), kind="stable")
    return pd.concat(lines, ignore_index=True), table.assign(name=_names(table)).reset_index(drop=True)


def _names(sections: pd.DataFrame) -> list[str]:
    several = sections["setting"].nunique() > 1
    names = [row.part.replace("_", " ") for row in sections.itertuples()]
    return [
        f"{name}\n{row.setting}" if several else name for name, row in zip(names, sections.itertuples(), strict=True)
    ]


def shown_shapes(folder: Path, most: float = MOST_SHAPES) -> list[tuple[float, SurfaceMesh]]:
    """Return (hours of operation, surface) of a run as built and after its updates, of more than `most` in all some,
    evenly in their number; faces look out of the body in all of them.
    """
    wear = pd.read_csv(folder / "wear.csv")
    wear = wear[wear["stands_for_h"] > 0.0]
    hours = (wear["operation_h"] + wear["stands_for_h"]).to_numpy()
    shown = np.unique(np.linspace(0, len(wear), min(len(wear) + 1, most)).round().astype(int))[1:] - 1
    files = [folder / f"cycle_{cycle:03d}" / SURFACE for cycle in wear["cycle"].to_numpy()[shown]]
    worn = [(float(hours[k]), read_surface(file)) for k, file in zip(shown, files, strict=True)]
    built = read_surface(folder / SURFACE)
    return [(0.0, turned_as(built, worn[-1][1]) if worn else built), *worn]


def _plane(
    surface: SurfaceMesh, label: int, motion: Mapping[str, Any] | None, place: tuple, patch_m: float
) -> SectionPlane:
    """Return the plane of a section through the face nearest to a place of a table, the middle of an area patch.

    Out of the body is the mean normal of the faces round it, as far as the length of a patch (m), that look its way:
    the slope of a bump does not turn the section of its plate.
    """
    mesh, _ = part_mesh(surface, label)
    middle = centroids(mesh.points, mesh.triangles)
    point = np.array([place.x_mm, place.y_mm, place.z_mm]) / MILLIMETRES
    nearest = int(np.linalg.norm(middle - point, axis=1).argmin())
    if (turning := turns_about(motion)) is not None:
        return turning_plane(middle[nearest], *turning)
    normals = unit_normals(mesh.points, mesh.triangles)
    near = np.linalg.norm(middle - middle[nearest], axis=1) <= patch_m
    near &= normals @ normals[nearest] > 0.0
    return part_plane(mesh, middle[nearest], areas(mesh.points, mesh.triangles)[near] @ normals[near])


def _lines(surface: SurfaceMesh, label: int, plane: SectionPlane) -> pd.DataFrame:
    mesh, _ = part_mesh(surface, label)
    ends, faces, shares = cut(mesh, plane)
    removed = mesh.point_data.get("removed_thickness_m", np.zeros(len(mesh.points)))
    depth = values_on(mesh, removed, faces, shares)
    table = pd.DataFrame(MILLIMETRES * np.hstack([ends.reshape(-1, 4), depth]), columns=list(COLUMNS))
    return table.assign(faces_out=unit_normals(mesh.points, mesh.triangles)[faces] @ plane.out > LOOKS_OUT)
