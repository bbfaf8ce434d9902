"""Solids of STL files, ASCII and binary."""

from __future__ import annotations

import codecs
import re
from pathlib import Path

import numpy as np

from bulkwear.meshes.own.solids import Solids, distinct

HEADER, COUNT, FACET = 80, 4, 50  # bytes of a binary STL: title, number of facets, one facet
FACET_TYPE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
SOLID = re.compile(rb"^[ \t]*solid\b[ \t]*([^\r\n]*)", re.MULTILINE | re.IGNORECASE)
END = re.compile(rb"^[ \t]*endsolid\b", re.MULTILINE | re.IGNORECASE)
VERTEX = re.compile(rb"\bvertex\b", re.IGNORECASE)
END_OF_FACET = re.compile(rb"\bendfacet\b", re.IGNORECASE)
OTHER_LINE = re.compile(rb"^[ \t]*(?!vertex\b)[^\s][^\n]*$", re.MULTILINE | re.IGNORECASE)


def read_stl_solids(path: Path) -> Solids:
    """Solids of an STL; each `solid NAME` block of an ASCII one is a part. A binary one is known by its size.

    Raises ValueError with the file's name when it is cut short or has something that is no number.
    """
    content = path.read_bytes().removeprefix(codecs.BOM_UTF8)
    facets = int.from_bytes(content[HEADER : HEADER + COUNT], "little") if len(content) >= HEADER + COUNT else -1
    if len(content) == HEADER + COUNT + FACET * facets:
        corners = np.frombuffer(content, FACET_TYPE, facets, HEADER + COUNT)["corners"]
        return _solids([corners.astype(np.float64)], [path.stem])
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise ValueError(f"{path}: found text as UTF-16, allowed is an ASCII STL as UTF-8")
    if b"\0" in content or not SOLID.match(content.lstrip()):  # a text has no zero bytes
        raise ValueError(
            f"{path}: found {len(content)} bytes, allowed is an ASCII STL, which begins with 'solid', or a binary one, "
            f"which has {HEADER + COUNT} bytes and {FACET} for each of its facets; it says {max(facets, 0)}"
        )
    return _ascii_solids(path, content)


def _ascii_solids(path: Path, content: bytes) -> Solids:
    """The blocks of an ASCII STL."""
    starts = list(SOLID.finditer(content))
    ends = [len(END.findall(content[a.end() : b])) for a, b in _blocks(starts, len(content))]
    if 0 in ends:
        name = _name(starts[ends.index(0)], path.stem, ends.index(0), len(starts))
        raise ValueError(f"{path}: solid '{name}' is cut short, allowed are solids that end with 'endsolid'")
    names = [_name(start, path.stem, number, len(starts)) for number, start in enumerate(starts)]
    corners = [
        _corners(path, name, content, start.end(), end)
        for name, (start, end) in zip(names, _blocks(starts, len(content)), strict=True)
    ]
    return _solids(corners, names)


def _blocks(starts: list[re.Match], length: int) -> list[tuple[re.Match, int]]:
    """Each match with the place where the next one begins."""
    return list(zip(starts, [*(start.start() for start in starts[1:]), length], strict=True))


def _name(start: re.Match, stem: str, number: int, count: int) -> str:
    """Name of a solid: the file's, or the file's name where it has none."""
    said = start[1].decode("utf-8", "replace").strip()
    return said or (stem if count == 1 else f"{stem}_{number + 1}")


def _corners(path: Path, name: str, content: bytes, start: int, end: int) -> np.ndarray:
    """Corners (m, 3, 3) of the facets of a solid, which lies between two places of the file."""
    block = content[start:end]
    facets = len(END_OF_FACET.findall(block))
    numbers = VERTEX.sub(b"", OTHER_LINE.sub(b"", block)).split()
    if len(numbers) != 9 * facets:
        raise ValueError(
            f"{path}: {facets} facets of solid '{name}' need {9 * facets} coordinates, found {len(numbers)}"
        )
    try:
        return np.array(numbers, dtype="S").astype(np.float64).reshape(facets, 3, 3)
    except ValueError as error:
        line, word = _first_no_number(content, start, end)
        raise ValueError(
            f"{path}, line {line}: found '{word}' as a coordinate of solid '{name}', allowed is a number "
            "with a decimal point"
        ) from error


def _first_no_number(content: bytes, start: int, end: int) -> tuple[int, str]:
    """The line of the first vertex of a solid whose coordinates are no numbers, from 1, and the word at fault."""
    first = content.count(b"\n", 0, start) + 1
    for line, text in enumerate(content[start:end].split(b"\n"), start=first):
        for word in VERTEX.sub(b"", text).split() if VERTEX.search(text) else ():
            try:
                float(word)
            except ValueError:
                return line, word.decode("utf-8", "replace")
    return first, ""


def _solids(corners: list[np.ndarray], names: list[str]) -> Solids:
    """Solids of facets (m, 3, 3) by name, three nodes for each facet; solids without facets are left out."""
    filled = [(each, name) for each, name in zip(corners, names, strict=True) if len(each)]
    points = np.concatenate([np.empty((0, 3)), *(each.reshape(-1, 3) for each, _ in filled)])
    part = np.repeat(np.arange(len(filled)), [len(each) for each, _ in filled])
    return Solids(points, np.arange(len(points)).reshape(-1, 3), part, distinct([name for _, name in filled]))
