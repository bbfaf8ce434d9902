"""Read solids from any of the formats that CAD and mesh programs write."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bulkwear.meshes.own.cad import CAD_FORMATS, cad_areas, read_cad_solids
from bulkwear.meshes.own.obj import read_obj_solids
from bulkwear.meshes.own.ply import read_ply_solids
from bulkwear.meshes.own.solids import PART_DATA, NoSuchPartError, Solids, alone, distinct, metres_per
from bulkwear.meshes.own.stl import read_stl_solids
from bulkwear.postproc.mesh import areas

FLAT_CELLS = {"triangle": 3, "quad": 4}  # cells that are a surface, and their corners
LONGEST_SENTENCE = 600  # letters
SIGNATURES = {  # how a file begins: the formats that do
    b"ISO-10303-21": (".step", ".stp"),
    b"ply": (".ply",),
    b"# vtk": (".vtk",),
    b"$MeshFormat": (".msh",),
    b"<?xml": (".vtu",),
    b"<VTKFile": (".vtu",),
    b"DBRep_DrawableShape": (".brep",),
    b"CASCADE Topology": (".brep",),
}


def check_file(path: Path) -> None:
    """Raise FileNotFoundError or ValueError for what is no file of a format that is read, before it is read."""
    formats = ", ".join([*READERS, *CAD_FORMATS])
    if os.path.isdir(path):
        raise ValueError(f"{path}: is a folder, allowed is a file of {formats}")
    if not os.path.isfile(path):
        raise FileNotFoundError(f"{path}: no such file, allowed is a file of {formats}")
    suffix = path.suffix.lower()
    if suffix not in CAD_FORMATS and suffix not in READERS:
        raise ValueError(f"{path}: the format '{path.suffix}' is unknown, allowed are {formats}")
    if not path.stat().st_size:
        raise ValueError(f"{path}: the file is empty, allowed is a surface as {suffix}")
    _check_signature(path, suffix)


def read_solids(
    path: Path, unit: str, edges: Mapping[str, float] | float | None, solid: str | None = None
) -> tuple[Solids, float]:
    """Solids of a file that `check_file` lets pass, and the m of its numbers: its unit's, or what a CAD file says.

    edges: m, of CAD files: target edge of the triangles (`own_mesh`); solid: the only part that is wanted, None: all.
    Raises ValueError with the file, what was found and what is allowed, NoSuchPartError where no part is that solid.
    """
    suffix = path.suffix.lower()
    try:
        if suffix in CAD_FORMATS:
            solids, scale = read_cad_solids(path, unit, edges, solid)
        else:
            solids, scale = READERS[suffix](path), metres_per(unit)
            solids = solids if solid is None else alone(solids, solid, str(path))
        _check_numbers(path, solids)
    except NoSuchPartError:
        raise
    except ValueError as error:  # it may quote a part of a damaged file
        raise ValueError("".join(filter(str.isprintable, str(error)))[:LONGEST_SENTENCE]) from error
    return replace(solids, source=str(path)), scale


class PartSize(NamedTuple):
    """Area (m2) of a part of a file, and the triangles that it has there, 0 in a CAD file."""

    area_m2: float
    triangles: int


def part_sizes(path: Path, unit: str) -> dict[str, PartSize]:
    """Size of each part of a file that `check_file` lets pass, by name; nothing is meshed. Raises ValueError."""
    suffix = path.suffix.lower()
    if suffix in CAD_FORMATS:
        return {name: PartSize(area, 0) for name, area in cad_areas(path, unit).items()}
    solids = READERS[suffix](path)
    _check_numbers(path, solids)
    number = len(solids.names)
    of_part = metres_per(unit) ** 2 * np.bincount(solids.part, areas(solids.points, solids.triangles), number)
    counts = np.bincount(solids.part, minlength=number)
    return dict(zip(solids.names, map(PartSize, of_part.tolist(), counts.tolist()), strict=True))


def _check_signature(path: Path, suffix: str) -> None:
    """Raise ValueError where a file begins as one of another format."""
    with path.open("rb") as file:
        begins = file.read(64).lstrip()
    for signature, formats in SIGNATURES.items():
        if begins.startswith(signature) and suffix not in formats:
            raise ValueError(
                f"{path}: begins with '{signature.decode()}' as {formats[0]} does, allowed is what its name says, "
                f"{suffix}; rename it"
            )


def _check_numbers(path: Path, solids: Solids) -> None:
    """Raise ValueError where there is no triangle, a node that is not there, or a coordinate that is not finite."""
    if not len(solids.triangles):
        raise ValueError(f"{path}: no triangle found, allowed is a surface of one or more")
    low, high = solids.triangles.min(), solids.triangles.max()
    if low < 0 or high >= len(solids.points):
        raise ValueError(
            f"{path}: a face names node {low if low < 0 else high}, allowed are 0 to {len(solids.points) - 1}"
        )
    faulty = np.flatnonzero(~np.isfinite(solids.points[solids.triangles]).all(axis=(1, 2)))
    if faulty.size:
        name = solids.names[solids.part[faulty[0]]]
        raise ValueError(
            f"{path}: {faulty.size} triangles have a coordinate that is not finite, the first is number "
            f"{faulty[0] + 1}, in part '{name}'; allowed are finite numbers"
        )


def _read_meshio(path: Path) -> Solids:
    """Solids of a file that meshio knows: parts by a cell label (`PART_DATA`), names of physical groups."""
    import meshio  # slow to import, and its faults are many

    warnings = StringIO()
    try:
        with redirect_stdout(StringIO()), redirect_stderr(warnings):  # of formats that it tried it prints faults, too
            content = meshio.read(path)
    except SystemExit as error:  # meshio leaves by sys.exit on some broken files
        raise ValueError(f"{path}: not a readable {path.suffix} file (cut short, or of another format)") from error
    except Exception as error:
        reason = " ".join(str(error).split()) or "cut short"
        raise ValueError(f"{path}: not a readable {path.suffix} file ({reason})") from error
    sys.stderr.write(warnings.getvalue())
    wanted = [k for k, block in enumerate(content.cells) if block.type in FLAT_CELLS]
    if not wanted:
        found = ", ".join(sorted({block.type for block in content.cells})) or "none"
        raise ValueError(f"{path}: cells must be triangles or quadrilaterals, found {found}")
    label = next((name for name in PART_DATA if name in content.cell_data), None)
    triangles, labels = [], []
    for k in wanted:
        cells = np.asarray(content.cells[k].data, dtype=np.int64)
        fans = [cells[:, [0, j, j + 1]] for j in range(1, cells.shape[1] - 1)]
        triangles.append(np.stack(fans, axis=1).reshape(-1, 3))
        values = np.zeros(len(cells)) if label is None else np.asarray(content.cell_data[label][k]).reshape(-1)
        labels.append(np.repeat(values, len(fans)))
    values, part = np.unique(np.concatenate(labels), return_inverse=True)
    said = {int(data[0]): name for name, data in content.field_data.items() if len(data) == 2 and int(data[1]) == 2}
    names = (
        [path.stem]
        if label is None
        else [said.get(int(value), f"{label.split(':')[-1]}_{value:g}") for value in values]
    )
    points = np.asarray(content.points, dtype=np.float64)
    return Solids(_in_space(points), np.concatenate(triangles), part, distinct(names))


def _in_space(points: np.ndarray) -> np.ndarray:
    """Points (n, 2) or (n, 3) as (n, 3)."""
    return np.pad(points, [(0, 0), (0, 3 - points.shape[1])])


READERS: dict[str, Callable[[Path], Solids]] = {
    ".stl": read_stl_solids,
    ".obj": read_obj_solids,
    ".ply": read_ply_solids,
    **dict.fromkeys((".vtk", ".vtu", ".msh"), _read_meshio),
}
