"""Solids of STEP, IGES and BREP files, meshed on their true surfaces by gmsh's OpenCASCADE."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bulkwear.meshes.gmsh_model import gmsh_model
from bulkwear.meshes.own.refine import check_count
from bulkwear.meshes.own.solids import Solids, distinct, metres_per, target_edges

CAD_FORMATS = (".step", ".stp", ".iges", ".igs", ".brep")
WITH_UNIT = CAD_FORMATS[:4]  # formats that tell their unit: OpenCASCADE hands over mm, whatever it is
SEWING_OF_SIZE = 1e-6  # -, of the largest extent: edges of faces that are closer are one
PER_CIRCLE = 12  # edges round a full circle, however coarse the target: 3.4 % of the radius within its chords
SHORTEST_OVER_TARGET = 0.2  # -, edges that curvature asks for go no further down
STEP_UNIT = re.compile(
    r"LENGTH_UNIT\s*\(\s*\)[^;]*?(?:SI_UNIT\s*\(\s*([^,\s]+)\s*,\s*\.METRE\.|CONVERSION_BASED_UNIT\s*\(\s*'([^']+)')"
)
CONVERSION_FIRST = re.compile(r"CONVERSION_BASED_UNIT\s*\(\s*'([^']+)'[^;]*LENGTH_UNIT")
NAMED_BY_PROGRAM = "Open CASCADE"  # how labels begin that nobody gave
NO_NAMES = ("COMPOUND", "SOLID", "SHELL", "FACE")  # labels that nobody gave
SI_PREFIX = {"$": "m", ".CENTI.": "cm", ".MILLI.": "mm", ".MICRO.": "um"}
CONVERSIONS = {"INCH": "in", "FOOT": "ft"}
IGES_UNITS = {1: "in", 2: "mm", 4: "ft", 6: "m", 9: "um", 10: "cm"}  # flag 14 of the global section


def read_cad_solids(path: Path, unit: str, edges: Mapping[str, float] | float | None) -> tuple[Solids, float]:
    """Solids of a CAD file, meshed, and the m of its numbers; bodies are parts, and so are connected free faces.

    edges: m, target edge of all parts or by name of a part. Raises ValueError where no edge is given, where the file
    says another unit, or where it cannot be read or meshed.
    """
    if edges is None:
        raise ValueError(f"{path}: a CAD file has no triangles, allowed is a target edge that they are made with")
    scale = _metres_of_file(path, unit)
    with gmsh_model() as gmsh:
        names, faces = _imported(gmsh, path)
        targets = _targets(path, names, scale**2 * _areas(gmsh, faces), edges)
        _set_sizes(gmsh, faces, targets / scale)
        try:
            gmsh.model.mesh.generate(2)
        except Exception as error:
            raise ValueError(f"{path}: a face cannot be meshed with that target edge ({error})") from error
        return _meshed(gmsh, names, faces), scale


def cad_areas(path: Path, unit: str) -> dict[str, float]:
    """Area (m2) of the true surface of each part of a CAD file; nothing is meshed. Raises as `read_cad_solids`."""
    scale = _metres_of_file(path, unit)
    with gmsh_model() as gmsh:
        names, faces = _imported(gmsh, path)
        return dict(zip(names, (scale**2 * _areas(gmsh, faces)).tolist(), strict=True))


def _metres_of_file(path: Path, unit: str) -> float:
    """Metres of the numbers that OpenCASCADE hands over. Raises ValueError where the file says another unit."""
    _check_unit(path, unit)
    return 1e-3 if path.suffix.lower() in WITH_UNIT else metres_per(unit)


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


def _check_unit(path: Path, unit: str) -> None:
    """Raise ValueError where the file says a unit and it is not this one."""
    metres_per(unit)
    said = said_unit(path)
    if said is not None and said != unit:
        raise ValueError(f"{path}: the file says that its lengths are in {said}, found unit {unit}; allowed is {said}")


def said_unit(path: Path) -> str | None:
    """Unit of lengths that a STEP or IGES file says itself, None where it says none that is known."""
    suffix = path.suffix.lower()
    text = path.read_text(encoding="latin-1") if suffix in WITH_UNIT else ""
    if suffix in (".step", ".stp"):
        found = STEP_UNIT.search(text)
        if found and found[1]:
            return SI_PREFIX.get(found[1])
        word = found[2] if found else next(iter(CONVERSION_FIRST.findall(text)), "")
        return CONVERSIONS.get(word.upper())
    flags = "".join(line[:72] for line in text.splitlines() if line[72:73] == "G")
    fields = re.sub(r"\d+H[^,;]*", "", flags).split(",")
    return IGES_UNITS.get(int(fields[13])) if len(fields) > 13 and fields[13].strip().isdigit() else None


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
    """Target edge of each part, (parts,) m; area: (parts,) m2.

    Raises ValueError where there is none, or one for too many triangles.
    """
    targets = target_edges(names, edges)
    if not np.isfinite(targets).all():
        name = names[int(np.argmax(~np.isfinite(targets)))]
        raise ValueError(f"part '{name}' of a CAD file has no target edge, allowed is one for each part")
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
