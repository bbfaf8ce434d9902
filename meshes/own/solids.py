"""What a file of solids holds once it is read, the units it may be in, and how a surface is refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bulkwear.postproc.mesh import SurfaceMesh

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "ft": 0.3048}  # m
PART_DATA = ("part", "gmsh:physical", "region", "solid", "group", "material")  # cell data that tell parts, best first
OTHERS = "*"  # name that stands for all parts which are not named
LARGEST_PART, SMALLEST_PART = 1e3, 1e-6  # m, diagonal of a part: beyond them its unit is wrong
MOST_TRIANGLES = 4_000_000  # of a surface: more than a solver takes in days


@dataclass(frozen=True, eq=False)
class Solids:
    """Triangles of one or more parts.

    points: (n, 3) in any unit; triangles: (m, 3) node indices; part: (m,) index of the name; names: of the parts;
    source: the files, for messages
    """

    points: np.ndarray
    triangles: np.ndarray
    part: np.ndarray
    names: tuple[str, ...]
    source: str = ""


class RefusedMeshError(ValueError):
    """A surface that cannot be used, with what a picture of its fault needs.

    surface: in m; faces: (k,) those at fault; place: (3,) m, of the first of them
    """

    def __init__(self, message: str, surface: SurfaceMesh, faces: np.ndarray, place: np.ndarray) -> None:
        super().__init__(message)
        self.surface, self.faces, self.place = surface, np.asarray(faces), np.asarray(place)


class NoSuchPartError(ValueError):
    """A part by a name that no part of a file has; names: those of its parts."""

    def __init__(self, source: str, name: str, names: Sequence[str]) -> None:
        super().__init__(source, name, names)
        self.names = names

    def __str__(self) -> str:
        source, name, names = self.args
        return f"{source}: there is no part '{name}', allowed is one of {', '.join(names)}"


def metres_per(unit: str) -> float:
    """Length of a unit, m. Raises ValueError for a unit that is not in `UNITS`."""
    if unit not in UNITS:
        raise ValueError(f"the unit of lengths is {unit!r}, allowed is one of {', '.join(UNITS)}")
    return UNITS[unit]


def place_text(place: np.ndarray, unit: str) -> str:
    """A place (3,) m as words, in m and, where that is another one, in the unit of its file."""

    def numbers(scale: float) -> str:
        return ", ".join(f"{value / scale + 0.0:.6g}" for value in place)

    metres = f"({numbers(1.0)}) m"
    return metres if unit == "m" else f"{metres}, ({numbers(UNITS[unit])}) {unit} in the file"


def joined(files: Sequence[Solids]) -> Solids:
    """The solids of several files together, in order; names that occur again get a number."""
    nodes = np.cumsum([0, *(len(each.points) for each in files)])
    parts = np.cumsum([0, *(len(each.names) for each in files)])
    return Solids(
        np.concatenate([each.points for each in files]),
        np.concatenate([each.triangles + first for each, first in zip(files, nodes, strict=False)]),
        np.concatenate([each.part + first for each, first in zip(files, parts, strict=False)]),
        distinct([name for each in files for name in each.names]),
        ", ".join(each.source for each in files),
    )


def number_of(source: str, name: str, names: Sequence[str]) -> int:
    """Return which of the names is that one. Raises NoSuchPartError where none is."""
    if name not in names:
        raise NoSuchPartError(source, name, names)
    return names.index(name)


def alone(solids: Solids, name: str, source: str) -> Solids:
    """The part of that name, its nodes those of all parts. Raises NoSuchPartError for a name that none has."""
    triangles = solids.triangles[solids.part == number_of(source, name, solids.names)]
    return replace(solids, triangles=triangles, part=np.zeros(len(triangles), dtype=np.int64), names=(name,))


def distinct(names: Sequence[str]) -> tuple[str, ...]:
    """The names in order; one that occurs again is numbered from 2 on."""
    result: list[str] = []
    for name in names:
        free, number = name, 2
        while free in result:
            free, number = f"{name}_{number}", number + 1
        result.append(free)
    return tuple(result)


def target_edges(names: Sequence[str], edges: Mapping[str, float] | float | None) -> np.ndarray:
    """Target edge of each part, (parts,) m, infinite where none is wanted.

    edges: m, of all parts, or by name with `OTHERS` for those that are not named. Raises ValueError for a name that no
    part has.
    """
    given = edges if isinstance(edges, Mapping) else {OTHERS: np.inf if edges is None else edges}
    for name in given:
        if name != OTHERS and name not in names:
            raise ValueError(f"edges name the part '{name}', allowed are {', '.join(names)} and '{OTHERS}'")
    return np.array([given.get(name, given.get(OTHERS, np.inf)) for name in names], dtype=np.float64)


def check_sizes(solids: Solids, unit: str) -> None:
    """Raise ValueError where a part, its points in m, is larger or smaller than any that its unit can mean."""
    for number, name in enumerate(solids.names):
        points = solids.points[solids.triangles[solids.part == number]].reshape(-1, 3)
        size = float(np.linalg.norm(np.ptp(points, axis=0)))
        if not SMALLEST_PART <= size <= LARGEST_PART:
            raise ValueError(
                f"{solids.source}: part '{name}' is {size:.3g} m large if its unit is {unit}, allowed are "
                f"{SMALLEST_PART:g} to {LARGEST_PART:g} m; say the unit that it was drawn in ({', '.join(UNITS)})"
            )
