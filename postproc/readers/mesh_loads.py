"""LIGGGHTS' own loads per triangle, from ``dump ID all mesh/vtk N loads_*.vtk stress wear id <mesh id>``.

The stresses are those of the one step that is dumped, force on the triangle over its area; average several
dumps, or use the ledger's normal impulse, for a mean over time. `wear` (only with ``mesh/surface/stress ...
wear finnie`` and ``property/global k_finnie``) accumulates from the definition of the mesh: sum of 2 k
f(angle) |v| |F| dt / area while the particle approaches, v at its centre, its spin ignored (Finnie 1960;
LIGGGHTS 3.8.0 finnie-wear.pdf, Eq 4.23, and mesh_module_stress.cpp). With k in s2/m2, as there, it is
eroded mass over area, kg/m2; with k in 1/Pa it is a depth, m. A mesh whose id is new after a restart starts
at zero.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

LONGEST_COUNT = 12  # digits
_IDENTITY = "meshid"
_NAMES = {
    "normal_stress_average": "normal_stress_Pa",
    "shear_stress_average": "shear_stress_Pa",
    "wear": "finnie_wear",
}


class MeshLoadsError(ValueError):
    """A mesh/vtk dump that cannot be used; the message names the file and what is allowed."""


def _cell_fields(text: str, path: Path) -> dict[str, np.ndarray]:
    """Scalar fields of the CELL_DATA section of a legacy ASCII VTK file, by name."""
    words = text.partition("CELL_DATA")[2].split()
    if len(words) < 4 or words[1] != "FIELD":
        raise MeshLoadsError(f"{path}: no cell data, allowed is a text file of `dump mesh/vtk ... id`.")
    fields, place, cells = {}, 4, _count(words[0], path)
    for _ in range(_count(words[3], path)):
        if len(words) < place + 4:
            raise MeshLoadsError(f"{path}: the cell data ends early, allowed are {words[3]} whole fields.")
        name, components, tuples = words[place], *(_count(words[place + k], path) for k in (1, 2))
        values = words[place + 4 : place + 4 + components * tuples]
        if tuples != cells or len(values) != components * tuples:
            found = f"{len(values)} values of field '{name}'"
            raise MeshLoadsError(f"{path}: found {found}, allowed are {components} for each of {cells} triangles.")
        place += 4 + components * tuples
        if components == 1:
            fields[name] = _finite(values, name, path)
    return fields


def _count(word: str, path: Path) -> int:
    if not (word.isascii() and word.isdigit() and len(word) <= LONGEST_COUNT):
        raise MeshLoadsError(f"{path}: found '{word[:LONGEST_COUNT]}' as a count, allowed is a whole number.")
    return int(word)


def _finite(words: list[str], name: str, path: Path) -> np.ndarray:
    try:
        values = np.array(words, dtype=np.float64)
    except ValueError:
        values = np.array([np.nan])
    if not np.isfinite(values).all():
        raise MeshLoadsError(f"{path}: field '{name}' holds something else than finite numbers.")
    return values


def read_mesh_loads(path: Path | str, n_triangles: int | None = None) -> dict[str, np.ndarray]:
    """Loads per triangle of one mesh at one step, ordered by triangle id (= facet of the STL file).

    path: file of `dump mesh/vtk ... stress wear id`, one mesh per file
    n_triangles: checked when given
    Returns triangle (int64) and normal_stress_Pa, shear_stress_Pa, finnie_wear (m for k_finnie in 1/Pa), each
    (n,) float64, NaN where the dump lacks the field. Under MPI the file's own order is that of the ranks.
    Raises MeshLoadsError when the file is cut off, lacks the ids, or does not hold each triangle once.
    """
    path = Path(path)
    try:
        fields = _cell_fields(path.read_text("ascii", "replace"), path)
    except OSError as fault:
        raise MeshLoadsError(f"{path}: the dump cannot be read ({fault.strerror}).") from fault
    if _IDENTITY not in fields:
        raise MeshLoadsError(f"{path}: no field '{_IDENTITY}', allowed is a dump with the keyword `id`.")
    if np.abs(fields[_IDENTITY]).max(initial=0.0) > fields[_IDENTITY].size:
        raise MeshLoadsError(f"{path}: found ids beyond its {fields[_IDENTITY].size} triangles, allowed is each once.")
    triangle = fields[_IDENTITY].astype(np.int64)
    order = np.argsort(triangle)
    expected = np.arange(triangle.size if n_triangles is None else n_triangles)
    if not np.array_equal(triangle[order], expected):
        raise MeshLoadsError(
            f"{path}: found {triangle.size} triangles, allowed is each of 0 ... {expected.size - 1} once."
        )
    absent = np.full(triangle.size, np.nan)
    return {"triangle": expected, **{new: fields.get(old, absent)[order] for old, new in _NAMES.items()}}
