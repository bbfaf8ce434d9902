"""Solids of Wavefront OBJ files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bulkwear.meshes.own.solids import Solids, distinct


def read_obj_solids(path: Path) -> Solids:
    """Solids of an OBJ: each group (`g`) is a part, else each object (`o`); polygons are cut into fans.

    Raises ValueError with the line of the file that is no vertex or no face.
    """
    points: list[list[float]] = []
    triangles: list[tuple[int, int, int]] = []
    part: list[int] = []
    names: dict[str, int] = {}
    name = path.stem
    with path.open(encoding="utf-8", errors="replace") as file:
        for number, line in enumerate(file, start=1):
            word, *rest = line.split() or [""]
            try:
                if word == "v":
                    points.append([float(value) for value in rest[:3]])
                elif word in ("g", "o"):
                    name = " ".join(rest) or path.stem
                elif word == "f":
                    fan = _fan([_node(each, len(points)) for each in rest])
                    triangles += fan
                    part += [names.setdefault(name, len(names))] * len(fan)
            except (ValueError, IndexError) as error:
                raise ValueError(f"{path}, line {number}: '{line.strip()}' is not OBJ ({error})") from error
    if any(len(point) != 3 for point in points):
        raise ValueError(f"{path}: a vertex has fewer than three coordinates, allowed are three")
    return Solids(
        np.array(points).reshape(-1, 3),
        np.array(triangles, dtype=np.int64).reshape(-1, 3),
        np.array(part, dtype=np.int64),
        distinct(list(names)),
    )


def _node(word: str, count: int) -> int:
    """Index of a node from `7`, `7/2/1` or, counted from the latest one, `-1`."""
    number = int(word.partition("/")[0])
    index = number - 1 if number > 0 else count + number
    if not 0 <= index < count:
        raise ValueError(f"it names vertex {number} of {count}")
    return index


def _fan(nodes: list[int]) -> list[tuple[int, int, int]]:
    """Triangles of a polygon, all from its first node."""
    if len(nodes) < 3:
        raise ValueError(f"a face has {len(nodes)} vertices, allowed are 3 or more")
    return [(nodes[0], nodes[k], nodes[k + 1]) for k in range(1, len(nodes) - 1)]
