"""Solids of PLY files, ASCII and binary, with whatever properties their vertices and faces have."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

from bulkwear.meshes.own.solids import PART_DATA, Solids, distinct

TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"float": "f4", "double": "f8", "float32": "f4", "float64": "f8"},
}
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
LARGEST_COORDINATE = 1e9  # of a vertex, in any unit of length
INDICES = ("vertex_indices", "vertex_index")


@dataclass
class Element:
    """A kind of row in the file: its name, how many, and its properties as (name, type, type of a list's length)."""

    name: str
    count: int
    properties: list[tuple[str, str, str]] = field(default_factory=list)


def read_ply_solids(path: Path) -> Solids:
    """Solids of a PLY; an integer face property (`PART_DATA`) tells parts; polygons are cut into fans.

    Raises ValueError with the file's name when it is no PLY or cut short.
    """
    content = path.read_bytes()
    head, found, body = content.partition(b"end_header")
    try:
        if not found:
            raise ValueError("the header has no end")
        order, elements = _header(head.decode("latin-1"))
        body = body[body.index(b"\n") + 1 :]
        rows = dict(_text_rows(body, elements) if not order else _binary_rows(body, elements, order))
        return _solids(rows, path.stem)
    except (ValueError, KeyError, IndexError, TypeError, OverflowError) as error:
        raise ValueError(f"{path}: not a readable .ply file ({error})") from error


def _header(text: str) -> tuple[str, list[Element]]:
    """Byte order, empty for text, and the elements in order."""
    order, elements = None, []
    for word, *rest in filter(None, map(str.split, text.splitlines())):
        if word == "format":
            order = ORDERS[rest[0]]
        elif word == "element":
            elements.append(Element(rest[0], int(rest[1])))
        elif word == "property":
            length = TYPES[rest[1]] if rest[0] == "list" else ""
            elements[-1].properties.append((rest[-1], TYPES[rest[-2]], length))
    if order is None:
        raise ValueError("the header has no format")
    if bare := next((element.name for element in elements if element.count and not element.properties), None):
        raise ValueError(f"element {bare} has no property")
    return order, elements


def _text_rows(body: bytes, elements: list[Element]) -> Iterator[tuple[str, list[dict]]]:
    """Name and rows of each element of an ASCII file; a row is {property: value or list}."""
    lines = iter(body.decode("latin-1").splitlines())
    for element in elements:
        rows = []
        for _ in range(element.count):
            words = iter(next(lines, "").split())
            row = {}
            for name, _, length in element.properties:
                taken = int(next(words, "nothing")) if length else 1
                values = [float(next(words, "nothing")) for _ in range(taken)]
                row[name] = values if length else values[0]
            rows.append(row)
        yield element.name, rows


def _binary_rows(body: bytes, elements: list[Element], order: str) -> Iterator[tuple[str, list[dict] | np.ndarray]]:
    """Name and rows of each element of a binary file: an array where all rows are of one length."""
    start = 0
    for element in elements:
        kind = _row_type(element, body, start, order)
        end = start + kind.itemsize * element.count
        rows = np.frombuffer(body[start:end], kind) if end <= len(body) else None
        lengths = [name for name in kind.names or () if name.endswith(" length")]
        if rows is not None and all((rows[name] == rows[name][:1]).all() for name in lengths):
            start = end
        else:
            rows, start = _uneven_rows(element, body, start, order)
        yield element.name, rows
    if left := body[start:].strip():
        raise ValueError(f"{len(left)} bytes are left behind its last face; a binary file may have been copied as text")


def _row_type(element: Element, body: bytes, start: int, order: str) -> np.dtype:
    """Type of the rows of an element if all have lists as long as those of the first row, which begins at `start`."""
    fields: list[tuple] = []
    for name, kind, length in element.properties:
        if length:
            place = start + np.dtype(fields).itemsize
            count = int(np.frombuffer(body, order + length, 1, place)[0]) if element.count else 0
            fields += [(f"{name} length", order + length), (name, order + kind, (count,))]
        else:
            fields.append((name, order + kind))
    return np.dtype(fields)


def _uneven_rows(element: Element, body: bytes, start: int, order: str) -> tuple[list[dict], int]:
    """Rows of an element whose lists have different lengths, one after the other, and where they end."""
    rows = []
    for _ in range(element.count):
        kind = _row_type(Element(element.name, 1, element.properties), body, start, order)
        values = np.frombuffer(body, kind, 1, start)[0]
        rows.append({name: values[name] for name, _, _ in element.properties})
        start += kind.itemsize
    return rows, start


def _solids(rows: dict, stem: str) -> Solids:
    """Solids of the rows of `vertex` and `face`."""
    vertices, faces = rows["vertex"], rows["face"]
    even = isinstance(faces, np.ndarray)
    names = faces.dtype.names if even else list(faces[0]) if faces else ()
    indices = next((name for name in INDICES if name in names), INDICES[0])
    label = next((name for name in PART_DATA if name in names), None)
    column = [np.array([row[axis] for row in vertices], dtype=np.float64) for axis in "xyz"]
    if not all((np.abs(values) <= LARGEST_COORDINATE).all() for values in column):
        raise ValueError(
            f"coordinates beyond {LARGEST_COORDINATE:g}: the numbers are not those of the header, as in a binary file"
            " that was copied as text, which changes its line ends"
        )
    if even:
        polygons = faces[indices].astype(np.int64)
        triangles = np.stack([polygons[:, [0, a, b]] for a, b in pairwise(range(1, polygons.shape[1]))], axis=1)
        each = np.full(len(polygons), polygons.shape[1] - 2)
        triangles = triangles.reshape(-1, 3)
    else:
        polygons = [[int(node) for node in row[indices]] for row in faces]
        triangles = np.array([(p[0], a, b) for p in polygons for a, b in pairwise(p[1:])], dtype=np.int64).reshape(
            -1, 3
        )
        each = np.array([len(p) - 2 for p in polygons], dtype=np.int64)
    labels = np.zeros(len(each)) if label is None else np.array([row[label] for row in faces])
    values, part = np.unique(np.repeat(labels, each), return_inverse=True)
    named = [stem] if label is None else [f"{label}_{value:g}" for value in values]
    return Solids(np.column_stack(column), triangles, part, distinct(named))
