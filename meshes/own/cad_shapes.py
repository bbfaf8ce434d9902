"""Shapes of a CAD file, by gmsh's OpenCASCADE: their parts, areas and triangles, asked for and answered by pickles.

A program of its own, which `cad` starts: `python -m bulkwear.meshes.own.cad_shapes`.
"""

from __future__ import annotations

import math
import os
import pickle
import resource
import sys
import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bulkwear.meshes.gmsh_model import gmsh_model
from bulkwear.meshes.own.refine import check_count, triangle_counts
from bulkwear.meshes.own.solids import OTHERS, Solids, distinct, number_of, target_edges

SEWING_OF_SIZE = 1e-6  # -, of the largest extent: edges of faces that are closer are one
READING_S, READING_S_PER_MB = (
    20.0,
    30.0,
)  # of processor time; a whole file of 30 kB takes 2 in all
MESHING_S, MESHING_S_PER_TRIANGLE = 60.0, 5e-3  # of processor time on top; a triangle takes some 5e-5
PER_CIRCLE = 12  # edges round a full circle, however coarse the target: 3.4 % of the radius within its chords
SHORTEST_OVER_TARGET = 0.2  # -, edges that curvature asks for go no further down
NAMED_BY_PROGRAM = "Open CASCADE"  # how labels begin that nobody gave
NO_NAMES = ("COMPOUND", "SOLID", "SHELL", "FACE")  # labels that nobody gave


def _allow(seconds: float) -> None:
    """Let this process use seconds of processor time more than it has used; then the system ends it."""
    _, most = resource.getrlimit(resource.RLIMIT_CPU)  # that a shell or a batch system has set, and that stays
    wanted = math.ceil(time.process_time() + seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (wanted if most == resource.RLIM_INFINITY else min(wanted, most), most))


def _answer() -> None:
    """Read what is asked from stdin and write the solids, the areas or a ValueError to stdout.

    What OpenCASCADE prints goes to stderr.
    """
    out = os.dup(1)
    os.dup2(2, 1)
    path, what, scale, *choices = pickle.load(sys.stdin.buffer)
    _allow(READING_S + READING_S_PER_MB * path.stat().st_size / 1e6)
    try:
        found = _solids(path, scale, *choices) if what == "solids" else _areas_of_parts(path, scale)
    except ValueError as error:
        found = error
    with os.fdopen(out, "wb") as file:
        pickle.dump(found, file)


def _solids(path: Path, scale: float, edges: Mapping[str, float] | float, solid: str | None) -> Solids:
    with gmsh_model() as gmsh:
        names, faces = _imported(gmsh, path)
        if solid is not None:
            faces = [faces[number_of(str(path), solid, names)]]
            names = (solid,)
            _keep(gmsh, faces[0])
        areas = scale**2 * _areas(gmsh, faces)
        targets = _targets(path, names, areas, edges)
        _allow(MESHING_S + MESHING_S_PER_TRIANGLE * float(triangle_counts(areas, targets).sum()))
        _set_sizes(gmsh, faces, targets / scale)
        try:
            gmsh.model.mesh.generate(2)
        except Exception as error:
            raise ValueError(f"{path}: a face cannot be meshed with that target edge ({error})") from error
        return _meshed(gmsh, names, faces)


def _areas_of_parts(path: Path, scale: float) -> dict[str, float]:
    with gmsh_model() as gmsh:
        names, faces = _imported(gmsh, path)
        return dict(zip(names, (scale**2 * _areas(gmsh, faces)).tolist(), strict=True))


def _imported(gmsh, path: Path) -> tuple[tuple[str, ...], list[list[int]]]:
    """Names of the parts of a file, and the tags of the faces of each. Raises ValueError where it has none."""
    try:
        gmsh.model.occ.importShapes(str(path), highestDimOnly=False)
        gmsh.model.occ.synchronize()
        _sew_faces(gmsh)
    except Exception as error:  # gmsh has no kind of its own
        raise ValueError(f"{path}: not a readable {path.suffix} file ({error})") from error
    bodies = _bodies(gmsh, path.stem)
    if not bodies:
        raise ValueError(f"{path}: no body and no face found, allowed are one or more")
    return distinct([name for name, _ in bodies]), [faces for _, faces in bodies]


def _areas(gmsh, faces: list[list[int]]) -> np.ndarray:
    """Area of the faces of each part, (parts,) in the square of its unit."""
    return np.array([sum(gmsh.model.occ.getMass(2, tag) for tag in tags) for tags in faces])


def _keep(gmsh, faces: list[int]) -> None:
    """Forget all but some faces: nothing else is meshed."""
    gmsh.model.occ.remove(gmsh.model.getEntities(3))
    others = [(2, tag) for _, tag in gmsh.model.getEntities(2) if tag not in set(faces)]
    gmsh.model.occ.remove(others, recursive=True)
    gmsh.model.occ.synchronize()


def _sew_faces(gmsh) -> None:
    """Make bodies of faces where there is no body, as in IGES files that know faces only."""
    if gmsh.model.getEntities(2) and not gmsh.model.getEntities(3):
        low, high = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
        gmsh.model.occ.healShapes(tolerance=SEWING_OF_SIZE * float(np.linalg.norm(high - low)))
        gmsh.model.occ.synchronize()


def _bodies(gmsh, stem: str) -> list[tuple[str, list[int]]]:
    """Name and faces of each body, then of each group of free faces that hang together by edges."""
    result, owned = [], set()
    for number, (_, tag) in enumerate(gmsh.model.getEntities(3), start=1):
        faces = [abs(face) for _, face in gmsh.model.getBoundary([(3, tag)], oriented=False)]
        owned |= set(faces)
        result.append((_entity_name(gmsh, 3, tag) or f"{stem}_body_{number}", faces))
    free = {tag for _, tag in gmsh.model.getEntities(2)} - owned
    groups: list[set[int]] = []
    curves: list[set[int]] = []
    for face in sorted(free):
        group, its = {face}, {abs(tag) for _, tag in gmsh.model.getBoundary([(2, face)], oriented=False)}
        touching = [k for k, other in enumerate(curves) if other & its]
        for k in reversed(touching):
            group |= groups.pop(k)
            its |= curves.pop(k)
        groups.append(group)
        curves.append(its)
    for number, group in enumerate(sorted(groups, key=min), start=1):
        result.append((_entity_name(gmsh, 2, min(group)) or f"{stem}_shell_{number}", sorted(group)))
    return result


def _entity_name(gmsh, dimension: int, tag: int) -> str:
    """Last word of an entity's label in the file, empty without one or where a program gave it."""
    name = gmsh.model.getEntityName(dimension, tag).rpartition("/")[2].strip()
    return "" if name in NO_NAMES or name.startswith(NAMED_BY_PROGRAM) else name


def _targets(path: Path, names: tuple[str, ...], area: np.ndarray, edges) -> np.ndarray:
    """Target edge of each part, (parts,) m; area: (parts,) m2; edges: may name parts of other files, too.

    Raises ValueError where there is none, or one for too many triangles.
    """
    its = {*names, OTHERS}
    targets = target_edges(
        names, {name: edge for name, edge in edges.items() if name in its} if isinstance(edges, Mapping) else edges
    )
    if not np.isfinite(targets).all():
        name = names[int(np.argmax(~np.isfinite(targets)))]
        allowed = f"one for each of {', '.join(names)}, or for '{OTHERS}'"
        raise ValueError(f"{path}: part '{name}' of a CAD file has no target edge, allowed is {allowed}")
    check_count(str(path), names, area, targets)
    return targets


def _set_sizes(gmsh, faces: list[list[int]], targets: np.ndarray) -> None:
    """Let gmsh mesh the faces of each part with its own edge (in its unit); on a face of two the smaller one counts."""
    field = gmsh.model.mesh.field
    constants = []
    for target, tags in zip(targets, faces, strict=True):
        constants.append(field.add("Constant"))
        field.setNumber(constants[-1], "VIn", target)
        field.setNumbers(constants[-1], "SurfacesList", tags)
        field.setNumber(constants[-1], "IncludeBoundary", 1)
    smallest = field.add("Min")
    field.setNumbers(smallest, "FieldsList", constants)
    field.setAsBackgroundMesh(smallest)
    for option, value in (
        ("MeshSizeExtendFromBoundary", 0),
        ("MeshSizeFromPoints", 0),
        ("MeshSizeFromCurvature", PER_CIRCLE),
        ("MeshSizeMin", SHORTEST_OVER_TARGET * targets.min()),
    ):
        gmsh.option.setNumber(f"Mesh.{option}", value)


def _meshed(gmsh, names: tuple[str, ...], faces: list[list[int]]) -> Solids:
    """The triangles of each part, those of a face with two parts twice."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    place = np.zeros(int(tags.max(initial=0)) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    found = [
        [gmsh.model.mesh.getElementsByType(2, face)[1].astype(np.int64).reshape(-1, 3) for face in each]
        for each in faces
    ]
    triangles = [place[np.concatenate([np.empty((0, 3), dtype=np.int64), *each])] for each in found]
    part = np.repeat(np.arange(len(names)), [len(each) for each in triangles])
    return Solids(coordinates.reshape(-1, 3), np.concatenate(triangles), part, names)


if __name__ == "__main__":
    _answer()
